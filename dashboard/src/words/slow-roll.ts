// Which slow-roll vectors were subtracted from measured phasors.

/** leftOut: channels without a vector in that version. */
export function slowRollText(version: number | null, leftOut: string[] = []): string {
  if (version === null) return "as measured, no slow roll subtracted";
  return `slow roll version ${version} subtracted${leftOut.length > 0 ? `, but not at ${leftOut.join(", ")}` : ""}`;
}
