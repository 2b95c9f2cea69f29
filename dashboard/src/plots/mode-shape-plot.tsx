// A mode shape along the train, in the phase in which it is largest.
import type { DataColumn } from "../browser/download";
import { whirlName } from "../format/angles";
import { number } from "../format/numbers";
import { t } from "../messages/messages";
import type { Drawing } from "../schemas/machines";
import type { Displacement, ModeShape } from "../schemas/model";
import { SaveDrawing } from "./save-buttons";

const WIDTH = 420;
const HEIGHT = 130;
const MARGIN = 12;

export function ModeShapePlot({ mode, drawing }: { mode: ModeShape; drawing: Drawing }) {
  const at = (z: number) => MARGIN + (z / drawing.length) * (WIDTH - 2 * MARGIN);
  const whirl = whirlName(mode.whirl);
  const frequency = `${number(mode.frequency_hz)} Hz`;
  return (
    <figure>
      <figcaption>
        <strong>{frequency}</strong>
        {mode.standard_error_hz !== null && <span class="muted"> ± {number(1.96 * mode.standard_error_hz, 2)}</span>},{" "}
        <span class="muted">
          {t("dampingText", { ratio: number(100 * mode.damping_ratio), whirl, unstable: mode.damping_ratio < 0 && t("unstable") })}
        </span>
        <SaveDrawing label={t("modeShapeAt", { frequency, whirl })} columns={() => columnsOf(mode)} />
      </figcaption>
      <svg viewBox={`0 0 ${WIDTH} ${HEIGHT}`} role="img" aria-label={t("modeShapeAt", { frequency, whirl })}>
        <path class="grid" d={`M${MARGIN} ${HEIGHT / 2}H${WIDTH - MARGIN}`} />
        {drawing.couplings.map((one) => (
          <path class="grid dotted" d={`M${at(one.at)} 6V${HEIGHT - 6}`} />
        ))}
        {drawing.bearings.map((one) => (
          <path class="foot" d={`M${at(one.at)} ${HEIGHT - 16}l-5 9h10z`} />
        ))}
        <Shafts mode={mode} at={at} />
      </svg>
    </figure>
  );
}

function Shafts({ mode, at }: { mode: ModeShape; at: (z: number) => number }) {
  const up = (value: number) => HEIGHT / 2 - value * (HEIGHT / 2 - 16);
  const line = (where: number[], values: number[]) => `M${where.map((z, index) => `${at(z).toFixed(1)} ${up(values[index]!).toFixed(1)}`).join("L")}`;
  const turn = -phaseOfLargest(mode);
  const turned = (one: Displacement) => one.real.map((real, index) => real * Math.cos(turn) - one.imaginary[index]! * Math.sin(turn));
  return (
    <>
      {mode.shafts.map((shaft) => (
        <g key={shaft.shaft}>
          <path class="hull" d={`${line(shaft.at, shaft.semi_major)}${line([...shaft.at].reverse(), [...shaft.semi_major].reverse().map((one) => -one)).replace("M", "L")}Z`} />
          <g class="curve s0">
            <path d={line(shaft.at, turned(shaft.x))} />
          </g>
          <g class="curve s1 dashed">
            <path d={line(shaft.at, turned(shaft.y))} />
          </g>
        </g>
      ))}
    </>
  );
}

function columnsOf({ shafts }: ModeShape): DataColumn[] {
  const all = (of: (shaft: ModeShape["shafts"][number]) => number[]) => shafts.flatMap(of);
  return [
    { name: t("csvShaft"), values: shafts.flatMap((one) => one.at.map(() => one.shaft)) },
    { name: "z [m]", values: all((one) => one.at) },
    { name: t("csvReal", { axis: "x" }), values: all((one) => one.x.real) },
    { name: t("csvImaginary", { axis: "x" }), values: all((one) => one.x.imaginary) },
    { name: t("csvReal", { axis: "y" }), values: all((one) => one.y.real) },
    { name: t("csvImaginary", { axis: "y" }), values: all((one) => one.y.imaginary) },
    { name: t("csvSemiMajor"), values: all((one) => one.semi_major) },
    { name: t("csvSemiMinor"), values: all((one) => one.semi_minor) },
  ];
}

/** Phase [rad] of the largest displacement: turned back by it, the shape is seen at its largest. */
function phaseOfLargest(mode: ModeShape): number {
  let largest = 0;
  let phase = 0;
  for (const shaft of mode.shafts) {
    for (const one of [shaft.x, shaft.y]) {
      one.real.forEach((real, index) => {
        const size = Math.hypot(real, one.imaginary[index]!);
        if (size > largest) [largest, phase] = [size, Math.atan2(one.imaginary[index]!, real)];
      });
    }
  }
  return phase;
}
