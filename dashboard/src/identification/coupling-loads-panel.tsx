// The forces and moments that the couplings carry at 1×, over speed.
import { speedsInUnit, useUnits } from "../browser/units";
import { Loaded } from "../components/loading";
import { Empty, Panel } from "../components/panel";
import { useResource } from "../data/resource";
import { scaleOf } from "../format/numbers";
import { t } from "../messages/messages";
import { Plot } from "../plots/plot";
import type { MisalignmentForce } from "../schemas/model";

/** Loads with their labels, units and styles: one for each axis. */
const LOADS = [
  ["force_x", t("forceAlongX"), "N", 0],
  ["force_y", t("forceAlongY"), "N", 1],
  ["moment_x", t("momentAboutX"), "N m", 0],
  ["moment_y", t("momentAboutY"), "N m", 1],
] as const;

export function CouplingLoadsPanel({ path }: { path: string }) {
  const result = useResource<MisalignmentForce>(path);
  return (
    <Panel title={t("couplingLoadsAt1Over")} aside={<p class="muted">{t("n0ToPeakBandsAre")}</p>}>
      <Loaded result={result} lines={16}>
        {(found) =>
          found.couplings.length === 0 ? (
            <Empty>{t("theTrainHasNoCoupling")}</Empty>
          ) : (
            <div class="plots">
              {found.couplings.flatMap((coupling) =>
                LOADS.map((load) => <LoadPlot key={coupling.coupling + load[0]} speed={found.speed} coupling={coupling} load={load} />),
              )}
            </div>
          )
        }
      </Loaded>
    </Panel>
  );
}

interface LoadPlotProps {
  speed: number[];
  coupling: MisalignmentForce["couplings"][number];
  load: (typeof LOADS)[number];
}

function LoadPlot({ speed, coupling, load: [field, label, unit, style] }: LoadPlotProps) {
  const { speed: unitOfSpeed } = useUnits();
  const load = coupling[field];
  const scale = scaleOf(Math.max(0, ...load.amplitude.map((one) => one ?? 0)), unit);
  const scaled = (column: (number | null)[]) => column.map((one) => (one === null ? null : one * scale.factor));
  return (
    <figure>
      <figcaption>
        <strong>{coupling.coupling}</strong> {label} [{scale.unit}]
      </figcaption>
      <Plot
        label={t("couplingLoadOverSpeed", { label, coupling: coupling.coupling })}
        x={speedsInUnit(speed, unitOfSpeed)}
        xUnit={unitOfSpeed.label}
        yUnit={scale.unit}
        height={170}
        syncGroup="forces"
        curves={[{ name: label, style, y: scaled(load.amplitude), lower: scaled(load.lower), upper: scaled(load.upper) }]}
      />
    </figure>
  );
}
