// What was all there last, shown until its next is.
import { useRef } from "preact/hooks";

/** of: what it is of; what was there of something else is not kept. */
export function useLastWhole<T>(of: unknown, whole: T | undefined): T | undefined {
  const last = useRef<{ of: unknown; whole: T } | null>(null);
  if (whole !== undefined) last.current = { of, whole };
  return last.current?.of === of ? last.current?.whole : undefined;
}
