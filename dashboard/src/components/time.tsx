// A time in the reader's zone.
import { utc, when } from "../format/times";

/** Local time, with UTC on hover. */
export function Time({ at }: { at: string | null | undefined }) {
  if (!at) return <>–</>;
  return (
    <time dateTime={at} title={utc(at)}>
      {when(at)}
    </time>
  );
}
