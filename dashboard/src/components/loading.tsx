// Data of the API in every state: loaded, stale, being loaded, failed.
import type { ComponentChildren } from "preact";
import { useEffect, useState } from "preact/hooks";
import { useStore } from "../browser/store";
import { connection } from "../data/connection";
import type { ApiError } from "../data/http-client";
import type { QueryResult } from "../data/resource";
import { clock } from "../format/times";
import { t } from "../messages/messages";

export function ErrorMessage({ failure }: { failure: ApiError }) {
  return (
    <p class="error" role="alert">
      {messageOf(failure)}
    </p>
  );
}

function messageOf({ message, pending }: ApiError): string {
  return pending ? t("retrying", { message }) : message;
}

/** Beside stale data: when they were received, and why there are no newer ones. */
export function StaleNotice({ result: { data, failure, asOf } }: { result: QueryResult<unknown> }) {
  const { state } = useStore(connection);
  if (data === undefined || asOf === undefined || !failure) return null;
  // A fault of the whole service is stated once, above everything.
  if (state === "degraded" && failure.status >= 500) return null;
  return (
    <p class="error stale-notice" role="status">
      {t("asOfNothingNewer", { time: clock(asOf), failure: messageOf(failure) })}
    </p>
  );
}

/** After so long a view says that it is being computed [ms]: what is there at once does not flicker. */
const SAYS_AFTER_MS = 700;
/** Time after which it says what takes so long [s]. */
const LONG_S = 20;

/** Whether something has been waited for so long that a view says so. */
export function useSaysThatItWaits(waits: boolean): boolean {
  const [says, setSays] = useState(false);
  useEffect(() => {
    const timer = waits ? window.setTimeout(() => setSays(true), SAYS_AFTER_MS) : undefined;
    return () => {
      window.clearTimeout(timer);
      setSays(false);
    };
  }, [waits]);
  return waits && says;
}

/** Keep the place of what is being loaded; what takes longer says so, and for how long. */
export function Loading({ height }: { height: string }) {
  const [seconds, setSeconds] = useState<number | null>(null);
  useEffect(() => {
    const begun = Date.now();
    const count = () => setSeconds(Math.round((Date.now() - begun) / 1000));
    const first = window.setTimeout(count, SAYS_AFTER_MS);
    const every = window.setInterval(count, 1000);
    return () => {
      window.clearTimeout(first);
      window.clearInterval(every);
    };
  }, []);
  return (
    <div class="loading" aria-busy="true" style={{ minHeight: height }}>
      {seconds === null ? (
        <span class="hidden">{t("loading")}</span>
      ) : (
        <label>
          {t(seconds < LONG_S ? "beingComputedS" : "beingComputedLong", { seconds })} <progress />
        </label>
      )}
    </div>
  );
}

/** The data of a result, with a notice if they are stale; else a placeholder of so many lines, or the error. */
export function Loaded<T>(props: { result: QueryResult<T>; lines?: number; children: (data: T) => ComponentChildren }) {
  const { data, failure } = props.result;
  if (data !== undefined) {
    return (
      <>
        <StaleNotice result={props.result} />
        {props.children(data)}
      </>
    );
  }
  // That the service does not answer is stated once, above everything; the request is repeated as soon as it does.
  if (failure?.isLocal) return <ErrorMessage failure={failure} />;
  return <Loading height={`${(props.lines ?? 3) * 1.6}em`} />;
}
