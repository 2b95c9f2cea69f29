// The fleet for a screen on the wall: large, without anything to click, always current.
import { useEffect, useState } from "preact/hooks";
import { link } from "../browser/router";
import { useUnits } from "../browser/units";
import { Loaded } from "../components/loading";
import { OperatingState } from "../components/operating-state";
import { Severity } from "../components/severity";
import { Speed } from "../components/speed";
import { useResource } from "../data/resource";
import { clock } from "../format/times";
import { t } from "../messages/messages";
import type { Fleet, FleetMachine } from "../schemas/machines";
import { alertTitle } from "../words/alert-states";
import { needOrder, needs } from "../words/needs";

const POLL_MS = 5000;

export function WallPage() {
  const result = useResource<Fleet>("/fleet", POLL_MS);
  return (
    <>
      <header class="wall-title">
        <h1>
          <a href={link([])}>{t("fleet")}</a>
        </h1>
        <Clock />
      </header>
      <Loaded result={result} lines={20}>
        {({ machines }) => (
          <ol class="wall">
            {[...machines].sort((a, b) => needOrder(b) - needOrder(a) || b.unacknowledged - a.unacknowledged || a.name.localeCompare(b.name)).map((one) => (
              <Tile key={one.id} one={one} />
            ))}
          </ol>
        )}
      </Loaded>
    </>
  );
}

/** The time of day: a wall that stands still shows it. */
function Clock() {
  const [now, setNow] = useState(Date.now());
  useEffect(() => {
    const every = window.setInterval(() => setNow(Date.now()), 1000);
    return () => window.clearInterval(every);
  }, []);
  return <span class="figure">{clock(now)}</span>;
}

function Tile({ one }: { one: FleetMachine }) {
  const units = useUnits();
  const severity = one.vibration_beyond_danger ? "danger" : (one.first_alert?.severity ?? "calm");
  return (
    <li class={`tile ${severity}`} data-machine={one.id}>
      <h2>{one.name}</h2>
      <p>
        <OperatingState state={one.state} /> <Speed rpm={one.speed_rpm} />
      </p>
      {one.first_alert && (
        <p>
          <Severity severity={one.first_alert.severity} acknowledged={one.unacknowledged === 0} />: {alertTitle(one.first_alert)}
        </p>
      )}
      <p class="muted">{needs(one, units)[0]?.words ?? t("needsNobody")}</p>
    </li>
  );
}
