// The last complete set of data, shown until the next one is complete.
import { useRef } from "preact/hooks";

/** of: what the data are of; data of something else are not kept. */
export function useLastComplete<T>(of: unknown, complete: T | undefined): T | undefined {
  const last = useRef<{ of: unknown; complete: T } | null>(null);
  if (complete !== undefined) last.current = { of, complete };
  return last.current?.of === of ? last.current?.complete : undefined;
}
