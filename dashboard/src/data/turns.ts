// Turns of requests for what the service computes before it answers: models of long trains and of oil films take up to a minute.

/** A browser has six connections to a host, one of them holds the events; the service computes one after another anyway. */
const AT_ONCE = 3;
const COMPUTED = /^\/identifications\/\d+\/(?:model\/|bode\b)|^\/machines\/[^/]+\/(?:alignment|stability)\b/;

/** Whether the service may have to compute the resource at a path first. */
export function isComputed(path: string): boolean {
  return COMPUTED.test(path);
}

let running = 0;
const waiting: (() => void)[] = [];

/** Do some work once fewer than so many others are under way. */
export async function inTurn<T>(work: () => Promise<T>): Promise<T> {
  if (running < AT_ONCE) running += 1;
  else await new Promise<void>((begin) => waiting.push(begin));
  try {
    return await work();
  } finally {
    const next = waiting.shift();
    if (next) next();
    else running -= 1;
  }
}
