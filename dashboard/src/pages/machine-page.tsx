// One machine: what it does now, and the views of it.
import type { ComponentChildren } from "preact";
import { useState } from "preact/hooks";
import type { Document, Job, MachineRevision, MachineState } from "../schemas/answers";
import { rpm } from "../words/format";
import { Guard } from "../components/error-boundary";
import { IdentifiedView } from "./parameters-tab";
import { ModelView } from "./model-tab";
import { openAlerts, Overview } from "./overview-tab";
import { Aging, Empty, Mode, Shown, Time } from "../components/parts";
import { foresee, useResource, type Answer } from "../data/resource";
import { ResponseView } from "./response-tab";
import { link } from "../browser/router";
import { SettingsView } from "./settings-tab";
import { ShapesView } from "./shapes-tab";
import { TABS } from "./tabs";
import { TrendsView } from "./trends-tab";

const STATE_MS = 1000;
const JOBS_MS = 2000;
const NEWEST_JOBS = 20;
/** The service answers with so many at most. */
const MOST_JOBS = 1000;

export function MachinePage({ id, tab }: { id: string; tab: string }) {
  useState(() => {
    // What is to be seen first is asked for together with the document, not behind it.
    if (tab === "overview") foresee(`/machines/${id}/drawing`, openAlerts(id));
  });
  const answer = useResource<MachineRevision>(`/machines/${id}`);
  return (
    <Shown answer={answer} lines={20}>
      {({ document, revision }) => (
        <>
          <Now machine={document} revision={revision} />
          <nav class="tabs" aria-label="Views of the machine">
            {TABS.map((one) => (
              <a key={one.id} href={link(["machines", id, one.id])} aria-current={one.id === tab ? "page" : undefined}>
                {one.name}
              </a>
            ))}
            <a class="end" href={link(["reports", id])}>
              Report
            </a>
          </nav>
          <Guard key={tab}>{view(tab, document)}</Guard>
        </>
      )}
    </Shown>
  );
}

function view(tab: string, machine: Document): ComponentChildren {
  switch (tab) {
    case "overview":
      return <Overview machine={machine} />;
    case "trends":
      return <TrendsView machine={machine} />;
    case "response":
      return <ResponseView machine={machine} />;
    case "shapes":
      return <ShapesView machine={machine} />;
    case "model":
      return <ModelView machine={machine} />;
    case "identified":
      return <IdentifiedView machine={machine} />;
    case "settings":
      return <SettingsView machine={machine} />;
    default:
      return <Empty>There is no such view.</Empty>;
  }
}

function Now({ machine, revision }: { machine: Document; revision: number }) {
  const state = useResource<MachineState>(`/machines/${machine.id}/state`, STATE_MS);
  const jobs = useJobs(machine.id);
  const now = state.data;
  return (
    <section class="now">
      <div>
        <h1>{machine.name}</h1>
        <p class="muted">
          {machine.plant} / {machine.id}, document revision {revision}
        </p>
      </div>
      <dl>
        <dt>State</dt>
        <dd>{now ? <Mode state={now.state} /> : "…"}</dd>
        <dt>Speed</dt>
        <dd class="figure">{rpm(now?.speed_rpm)}</dd>
        <dt>Since</dt>
        <dd>
          <Time at={now?.since} />
        </dd>
        <dt>Newest sample</dt>
        <dd>
          <Time at={now?.newest_sample_at} />
        </dd>
      </dl>
      <Progress state={now} jobs={jobs.data} />
      <Aging answer={state.asOf === undefined ? jobs : state} />
    </section>
  );
}

/** The newest jobs, and where all of these still wait the ones before them: the oldest is computed first. */
function useJobs(machine: string): Answer<Job[]> {
  const newest = useResource<Job[]>(`/machines/${machine}/jobs?limit=${NEWEST_JOBS}`, JOBS_MS);
  const last = newest.data?.[NEWEST_JOBS - 1];
  const more = useResource<Job[]>(last && isOpen(last) ? `/machines/${machine}/jobs?limit=${MOST_JOBS}` : null, JOBS_MS);
  return more.data ? more : newest;
}

function isOpen(job: Job): boolean {
  return job.state === "running" || job.state === "queued";
}

/** A bar while a run is collected or an identification computes; the place is kept when there is none. */
function Progress({ state, jobs }: { state: MachineState | undefined; jobs: Job[] | undefined }) {
  const run = state?.run;
  const running = jobs?.filter((job) => job.state === "running") ?? [];
  const queued = jobs?.filter((job) => job.state === "queued").length ?? 0;
  const isCut = jobs?.length === MOST_JOBS && isOpen(jobs.at(-1)!);
  const failed = jobs?.[0]?.state === "failed" ? jobs[0] : undefined;
  return (
    <div class="progress" aria-live="polite">
      {run ? (
        <label class="collecting">
          Collecting run {run.id}, {run.kind}: {Math.round(100 * run.progress)} %
          <progress max={1} value={run.progress} />
        </label>
      ) : (
        <span class="muted">No run is being collected.</span>
      )}
      {running.length + queued > 0 ? (
        <label class="computing">
          {running.length > 0 ? `Identifying run ${running.map((job) => job.runs.join(" + ")).join(", ")}` : "Identification waits"}
          {queued > 0 && `, ${queued}${isCut ? " or more" : ""} waiting`}
          <progress />
        </label>
      ) : failed ? (
        <span class="trouble">Identification of run {failed.runs.join(" + ")} failed: {failed.error}</span>
      ) : (
        <span class="muted">No identification is being computed.</span>
      )}
    </div>
  );
}
