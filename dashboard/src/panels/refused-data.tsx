// A badge on a machine whose sources sent something that was not taken in the last day, with the reasons in words.
import { useState } from "preact/hooks";
import { Time } from "../components/time";
import { useResource } from "../data/resource";
import { rich, t } from "../messages/messages";
import type { Quarantine } from "../schemas/operation";
import { refusals, refusalText } from "../words/refusals";

const POLL_MS = 15_000;
const DAY_MS = 86_400_000;
/** Entries that are looked through. */
const LIMIT = 500;

export function RefusedData({ machine }: { machine: string }) {
  const [open, setOpen] = useState(false);
  const { data } = useResource<Quarantine>(`/quarantine?machine=${machine}&limit=${LIMIT}`, POLL_MS);
  const recent = (data?.entries ?? []).filter((one) => Date.now() - Date.parse(one.received_at) < DAY_MS);
  const found = refusals(recent);
  if (found.length === 0) return null;
  return (
    <div class="refused" role="status">
      <p>
        <button type="button" aria-expanded={open} onClick={() => setOpen(!open)}>
          {t("dataRefusedSinceYesterday")}
        </button>{" "}
        {refusalText(found[0]!)}
        {found.length > 1 && (found.length === 2 ? t("oneOtherReason") : t("manyOtherReasons", { count: found.length - 1 }))}
        {recent.length === LIMIT && t("moreThanThese")}
      </p>
      {open && (
        <ul class="reasons">
          {found.map((one) => (
            <li key={one.reason}>
              {rich("refusalNewest", { refusal: refusalText(one), time: <Time at={one.newest} /> })} <q>{one.detail}</q>
            </li>
          ))}
        </ul>
      )}
    </div>
  );
}
