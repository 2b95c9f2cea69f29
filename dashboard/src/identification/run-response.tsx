// The Bode and polar plots of a run at some channels, another run overlaid; or why they are not there.
import { ErrorMessage, Loading, StaleNotice } from "../components/loading";
import { useLastComplete } from "../data/last-complete";
import { useRunResponse } from "../data/run-response";
import { speedSweep } from "../data/speed-sweep";
import { ResponsePanels } from "./response-panels";
import type { Document } from "../schemas/machines";
import type { Phasors, Run } from "../schemas/runs";
import { slowRollText } from "../words/slow-roll";

interface Props {
  machine: Document;
  run: Run | undefined;
  reference: Run | undefined;
  channels: string[];
  /** Nothing subtracted, whatever the identification subtracts. */
  asMeasured?: boolean;
  order?: 1 | 2;
  /** The machine that the reference is of, where it is another one. */
  overlaid?: string | undefined;
  /** What the plots are about where the run may change while they are looked at: they stay, zoomed as they are, until the next is loaded. */
  subject?: string;
}

export function RunResponse({ machine, run, reference, channels, asMeasured = false, order = 1, overlaid, subject }: Props) {
  const { measured, complete: now, failures } = useRunResponse(machine.id, run, reference, asMeasured);
  const about = subject ?? run?.id;
  const complete = useLastComplete([about, asMeasured].join(), now);
  return (
    <>
      {failures.map((one) => one?.isLocal && <ErrorMessage failure={one} />)}
      <StaleNotice result={measured} />
      {complete ? (
        <ResponsePanels
          key={about}
          machine={machine}
          channels={channels}
          measured={speedSweep(complete.measured)}
          reference={complete.overlaid === reference?.id && complete.other ? speedSweep(complete.other) : undefined}
          fit={complete.fit}
          noFit={complete.noFit}
          order={order}
          overlaid={overlaid}
          slowRoll={slowRollOf(complete.measured, channels)}
        />
      ) : (
        <Loading height="720px" />
      )}
    </>
  );
}

function slowRollOf(measured: Phasors, chosen: string[]): string {
  return slowRollText(measured.slow_roll_version, chosen.filter((one) => one in measured.slow_roll_left_out));
}
