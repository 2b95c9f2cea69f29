// The identification jobs of a machine.
import type { Job } from "../schemas/identifications";
import { useResource, type QueryResult } from "./resource";

const POLL_MS = 2000;
const NEWEST_JOBS = 20;
/** The API's limit for a page of jobs. */
export const MAX_JOBS = 1000;

/** The newest jobs; if all of these are open, older ones as well, since the oldest is computed first. */
export function useJobs(machine: string): QueryResult<Job[]> {
  const newest = useResource<Job[]>(`/machines/${machine}/jobs?limit=${NEWEST_JOBS}`, POLL_MS);
  const last = newest.data?.[NEWEST_JOBS - 1];
  const more = useResource<Job[]>(last && isOpen(last) ? `/machines/${machine}/jobs?limit=${MAX_JOBS}` : null, POLL_MS);
  return more.data ? more : newest;
}

export function isOpen(job: Job): boolean {
  return job.state === "running" || job.state === "queued";
}
