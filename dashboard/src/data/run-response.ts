// The response of a run: its phasors, those of a run overlaid, and the curve of its identification, once all are there.
import { t } from "../messages/messages";
import type { Bode } from "../schemas/model";
import type { Phasors, Run } from "../schemas/runs";
import { queryString, type ApiError } from "./http-client";
import { useLastComplete } from "./last-complete";
import { useResource, type QueryResult } from "./resource";
import { useRunIdentification } from "./run-identification";

const LIVE_POLL_MS = 1500;
/** Enough for the sharpest resonance of a train. */
const FITTED_POINTS = 600;
const NO_FIT = t("thisRunHasNoAccepted");
const NOT_LOADED = t("theCurveOfThisRun");
const UNKNOWN = t("whetherThisRunWasIdentified");
const AS_MEASURED = t("curveAndResidualAreShown");

export interface CompleteResponse {
  measured: Phasors;
  other: Phasors | undefined;
  /** The run that `other` is of. */
  overlaid: number | undefined;
  fit: Bode | undefined;
  noFit: string;
}

export interface RunResponseQuery {
  measured: QueryResult<Phasors>;
  /** The last response of the run of which every part was loaded. */
  complete: CompleteResponse | undefined;
  failures: (ApiError | undefined)[];
}

/** Without the slow roll that the identification subtracted, or as measured; the 2× comes along where sources send it. */
export function useRunResponse(machine: string, run: Run | undefined, reference: Run | undefined, asMeasured = false): RunResponseQuery {
  const { identified, slowRoll, failure } = useRunIdentification(machine, run);
  const subtracted = asMeasured ? slowRoll && "none" : slowRoll;
  const phasorsPath = (of: Run | undefined) => (of && subtracted ? `/runs/${of.id}/phasors${queryString({ slow_roll: subtracted, include: "2x" })}` : null);
  const measured = useResource<Phasors>(phasorsPath(run), run?.state === "open" ? LIVE_POLL_MS : 0);
  const other = useResource<Phasors>(phasorsPath(reference));
  // The curve is that of the phasors without the identification's own slow roll.
  const isCurved = identified && run && subtracted === slowRoll;
  const fit = useResource<Bode>(isCurved ? `/identifications/${identified.id}/bode?run=${run.id}&points=${FITTED_POINTS}` : null);
  const isComplete = (!isCurved || fit.data || fit.failure) && (!reference || other.data || other.failure);
  const noFit = identified ? (isCurved ? NOT_LOADED : AS_MEASURED) : failure ? UNKNOWN : NO_FIT;
  const now = measured.data && isComplete ? { measured: measured.data, other: other.data, overlaid: reference?.id, fit: fit.data, noFit } : undefined;
  return {
    measured,
    complete: useLastComplete<CompleteResponse>([run?.id, asMeasured].join(), now),
    failures: [failure, measured.data ? undefined : measured.failure, other.failure, fit.failure],
  };
}
