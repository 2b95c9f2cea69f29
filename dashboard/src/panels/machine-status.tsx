// The present state of a machine: its operation, the run being collected, the identification being computed.
import { StaleNotice } from "../components/loading";
import { OperatingState } from "../components/operating-state";
import { Speed } from "../components/speed";
import { Time } from "../components/time";
import { isOpen, MAX_JOBS, useJobs } from "../data/jobs";
import { useResource } from "../data/resource";
import { stored, t, term } from "../messages/messages";
import type { Job } from "../schemas/identifications";
import type { Document, MachineState } from "../schemas/machines";
import { jobRemedy } from "../words/job-failures";
import { RefusedData } from "./refused-data";

const POLL_MS = 1000;

export function MachineStatus({ machine, revision }: { machine: Document; revision: number }) {
  const state = useResource<MachineState>(`/machines/${machine.id}/state`, POLL_MS);
  const jobs = useJobs(machine.id);
  const now = state.data;
  return (
    <section class="now">
      <div>
        <h1>{machine.name}</h1>
        <p class="muted">
          {t("machineOfPlant", { plant: machine.plant, id: machine.id, revision })}
        </p>
      </div>
      <dl>
        <dt>{t("state")}</dt>
        <dd>{now ? <OperatingState state={now.state} /> : "…"}</dd>
        <dt>{t("speed")}</dt>
        <dd class="figure"><Speed rpm={now?.speed_rpm} /></dd>
        <dt>{t("since")}</dt>
        <dd>
          <Time at={now?.since} />
        </dd>
        <dt>{t("newestSample")}</dt>
        <dd>
          <Time at={now?.newest_sample_at} />
        </dd>
      </dl>
      {/* The place is kept while there is neither run nor job. */}
      <div class="progress" aria-live="polite">
        <RunProgress state={now} />
        <JobProgress jobs={jobs.data} />
      </div>
      <Notices state={now} />
      <RefusedData machine={machine.id} />
      <StaleNotice result={state.asOf === undefined ? jobs : state} />
    </section>
  );
}

/** What somebody should know of the data, though nothing is wrong with the service. */
function Notices({ state }: { state: MachineState | undefined }) {
  const waiting = state?.late_samples_waiting ?? 0;
  return (
    <>
      {state?.outside_speed_range && <p class="refused">{t("noRunBecause", { reason: stored(state.outside_speed_range) })}</p>}
      {waiting > 0 && <p class="muted">{t("samplesCameLateAndAre", { waiting })}</p>}
    </>
  );
}

function RunProgress({ state }: { state: MachineState | undefined }) {
  const run = state?.run;
  if (!run) return <span class="muted">{t("noRunIsBeingCollected")}</span>;
  return (
    <label class="collecting">
      {t("collectingRun", { id: run.id, kind: term(run.kind), progress: Math.round(100 * run.progress) })}
      <progress max={1} value={run.progress} />
    </label>
  );
}

function JobProgress({ jobs }: { jobs: Job[] | undefined }) {
  const running = jobs?.filter((job) => job.state === "running") ?? [];
  const queued = jobs?.filter((job) => job.state === "queued").length ?? 0;
  const isTruncated = jobs?.length === MAX_JOBS && isOpen(jobs.at(-1)!);
  const failed = jobs?.[0]?.state === "failed" ? jobs[0] : undefined;
  if (running.length + queued > 0) {
    const waiting = queued > 0 ? t("queuedCount", { count: queued, more: isTruncated ? t("orMore") : "" }) : "";
    const computing = running.map((job) => t("computingRun", { what: job.scope === "calibration" ? t("calibratingBy") : t("identifying"), runs: job.runs.join(" + ") })).join(", ");
    return (
      <label class="computing">
        {computing ? [computing, waiting].filter(Boolean).join(", ") : t("identificationWaiting", { waiting })}
        <progress />
      </label>
    );
  }
  if (failed) {
    return (
      <span class="error">
        {t("jobFailed", { what: failed.scope === "calibration" ? t("calibrationBy") : t("identificationOf"), runs: failed.runs.join(" + "), error: failed.error, remedy: jobRemedy(failed.error) })}
      </span>
    );
  }
  return <span class="muted">{t("noIdentificationIsBeingComputed")}</span>;
}
