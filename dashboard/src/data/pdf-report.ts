// A machine's report as PDF: the service prints it when it is asked for, which may take a while.
import { joinedSignal } from "./abort-signals";
import { useEffect, useRef, useState } from "preact/hooks";
import { t } from "../messages/messages";
import { API_PREFIX } from "./http-client";
import { problemText } from "./problem";

/** The service gives up earlier. */
const TIMEOUT_MS = 150_000;
const TICK_MS = 1000;

export interface Printing {
  /** Seconds since it was asked for; null while nothing is printed. */
  seconds: number | null;
  failure: string | null;
  start: (path: string, onPrinted: (pdf: Blob) => void) => void;
}

export function usePrinting(): Printing {
  const [seconds, setSeconds] = useState<number | null>(null);
  const [failure, setFailure] = useState<string | null>(null);
  const asked = useRef<AbortController | null>(null);
  useEffect(() => () => asked.current?.abort(), []);
  const start = async (path: string, onPrinted: (pdf: Blob) => void) => {
    const own = new AbortController();
    asked.current = own;
    const began = Date.now();
    setFailure(null);
    setSeconds(0);
    const clock = window.setInterval(() => setSeconds(Math.round((Date.now() - began) / 1000)), TICK_MS);
    try {
      const response = await fetch(API_PREFIX + path, { signal: joinedSignal(own.signal, AbortSignal.timeout(TIMEOUT_MS)) });
      if (!response.ok) throw new Error(await problemText(response));
      onPrinted(await response.blob());
    } catch (error) {
      if (!own.signal.aborted) setFailure(failureText(error));
    } finally {
      window.clearInterval(clock);
      if (!own.signal.aborted) setSeconds(null);
    }
  };
  return { seconds, failure, start };
}

/** Why nothing was printed; a request without any answer fails with a TypeError, in the browser's words. */
function failureText(error: unknown): string {
  if (error instanceof TypeError) return t("theServiceDoesNotAnswer");
  return error instanceof Error && error.name !== "TimeoutError" ? error.message : t("notPrintedWithin", { seconds: TIMEOUT_MS / 1000 });
}
