// Buttons by which a run is made of dwells, and identified, for those who may.
import { useState } from "preact/hooks";
import { navigate } from "../browser/router";
import { isDwells } from "../data/run-selection";
import { useMay } from "../data/session";
import { DwellsDialog, IdentifyDwellsDialog } from "../dialogs/dwells-dialogs";
import { t } from "../messages/messages";
import type { Run } from "../schemas/runs";

/** Make a run, which is shown then. */
export function MakeDwellsButton({ machine }: { machine: string }) {
  const [makes, setMakes] = useState(false);
  if (!useMay("analyst")) return null;
  return (
    <>
      <button type="button" onClick={() => setMakes(true)}>
        {t("runOfDwellsDots")}
      </button>
      {makes && <DwellsDialog machine={machine} onMade={(run) => navigate(["machines", machine, "response"], { run: String(run.id) })} onClose={() => setMakes(false)} />}
    </>
  );
}

/** Have a run of dwells identified; nothing for other runs, which are by themselves. */
export function IdentifyDwellsButton({ run }: { run: Run | undefined }) {
  const [asks, setAsks] = useState(false);
  const may = useMay("analyst");
  if (!run || !isDwells(run) || !may) return null;
  return (
    <>
      <button type="button" aria-label={t("identifyRun", { run: run.id })} onClick={() => setAsks(true)}>
        {t("identifyDots")}
      </button>
      {asks && <IdentifyDwellsDialog run={run} onClose={() => setAsks(false)} />}
    </>
  );
}
