// Why an identification failed, and what a person can do.

const REMEDIES: [RegExp, string][] = [
  [/NotEnoughData|too few|not enough/i, "Wait for a run that covers more of the speed range, or lower what the document asks of a run."],
  [/OutOfTime|over time|too long/i, "Try again when fewer are waiting; if it repeats, simplify the document or allow more time."],
  [/memory/i, "Allow the workers more memory, or simplify the document."],
  [/worker|killed|BrokenProcess|cluster/i, "It is tried again by itself; if it repeats, the service's log says why its worker ended."],
  [/released|deleted/i, "The run's samples are no longer kept; only newer runs can be identified."],
  [/document|unknown parameter|stiffness/i, "Check the machine's document: a part of the model is missing or contradicts the data."],
];

export function jobRemedy(error: string | null): string {
  return REMEDIES.find(([form]) => form.test(error ?? ""))?.[1] ?? "Ask for it again from the run; if it repeats, the service's log says more.";
}
