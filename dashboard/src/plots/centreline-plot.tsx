// A journal's way through its clearance circle over speed: as the model has it, and as gaps measure it.
import type { DataColumn } from "../browser/download";
import { number } from "../format/numbers";
import { t } from "../messages/messages";
import { COLOURS } from "./curve-style";
import { SaveDrawing } from "./save-buttons";

const SIZE = 260;
const RADIUS = 104;
/** Speeds written beside a line: its first, middle and last. */
const LABELS = [0, 0.5, 1];
/** Distance inwards from a line to its text: beyond the scatter of gaps, and clear of the circle. */
const BESIDE = 11;

export interface JournalLine {
  name: string;
  style: number;
  speed: number[];
  /** From the bearing's centre, to the right and up, in the plot's unit. */
  x: (number | null)[];
  y: (number | null)[];
  /** Drawn as points with a thin line between. */
  measured: boolean;
}

interface Props {
  bearing: string;
  /** Radial, in the plot's unit. */
  clearance: number;
  unit: string;
  lines: JournalLine[];
  speedUnit: string;
}

export function CentrelinePlot({ bearing, clearance, unit, lines, speedUnit }: Props) {
  const reach = Math.max(clearance, ...lines.flatMap(({ x, y }) => x.map((one, at) => Math.hypot(one ?? 0, y[at] ?? 0))));
  const scale = RADIUS / reach;
  const label = t("centrelineInBearing", { bearing });
  return (
    <figure>
      <figcaption>
        <strong>{bearing}</strong> <span class="muted">{t("radialClearanceOf", { clearance: number(clearance), unit })}</span>
        <SaveDrawing label={label} columns={() => columnsOf(lines, unit, speedUnit)} />
      </figcaption>
      <svg viewBox={`${-SIZE / 2} ${-SIZE / 2} ${SIZE} ${SIZE}`} role="img" aria-label={`${label}: ${lines.map((one) => pathText(one, unit, speedUnit)).join("; ")}`}>
        <path class="grid" d={`M${-RADIUS} 0H${RADIUS}M0 ${-RADIUS}V${RADIUS}`} />
        <text x={RADIUS + 5} y={3}>
          x
        </text>
        <text y={-RADIUS - 6} text-anchor="middle">
          y
        </text>
        <circle class="clearance" r={clearance * scale} />
        {[...lines].sort((one, other) => Number(other.measured) - Number(one.measured)).map((one) => (
          <Line key={one.name} line={one} scale={scale} />
        ))}
      </svg>
    </figure>
  );
}

interface Place {
  x: number;
  y: number;
  speed: number;
}

/** Where both coordinates are known, in the order of speed. */
function placesOf({ speed, x, y }: JournalLine): Place[] {
  const known = speed.flatMap((one, at): Place[] => (x[at] === null || y[at] === null ? [] : [{ x: x[at]!, y: y[at]!, speed: one }]));
  return known.sort((one, other) => one.speed - other.speed);
}

function Line({ line, scale }: { line: JournalLine; scale: number }) {
  const places = placesOf(line);
  const drawn = places.map((one) => `${(one.x * scale).toFixed(1)} ${(-one.y * scale).toFixed(1)}`);
  if (drawn.length === 0) return null;
  const labelled = line.measured || line.style > 0 ? [] : LABELS.map((part) => places[Math.round(part * (places.length - 1))]!);
  return (
    <g class={`curve s${line.style % COLOURS}`}>
      {line.measured ? <path class="dots" d={drawn.map((one) => `M${one}h0`).join("")} /> : <path d={`M${drawn.join("L")}`} />}
      {labelled.map((one) => (
        <g key={one.speed}>
          <circle class="journal" cx={one.x * scale} cy={-one.y * scale} r={2} />
          <text class="speed" x={one.x * scale + (one.x > 0 ? -BESIDE : BESIDE)} y={-one.y * scale + 3} text-anchor={one.x > 0 ? "end" : "start"}>
            {number(one.speed)}
          </text>
        </g>
      ))}
    </g>
  );
}

function pathText(line: JournalLine, unit: string, speedUnit: string): string {
  const places = placesOf(line);
  const [first, last] = [places[0], places.at(-1)];
  if (!first || !last) return t("noPlaceKnown", { name: line.name });
  const at = ({ x, y, speed }: Place) => t("placeAtSpeed", { x: number(x), y: number(y), unit, speed: `${number(speed, 4)} ${speedUnit}` });
  return t("centrelineSpoken", { name: line.name, first: at(first), last: at(last) });
}

function columnsOf(lines: JournalLine[], unit: string, speedUnit: string): DataColumn[] {
  const rows = lines.flatMap((line) => placesOf(line).map((one) => ({ ...one, name: line.name })));
  return [
    { name: t("csvLine"), values: rows.map((one) => one.name) },
    { name: t("csvSpeedIn", { unit: speedUnit }), values: rows.map((one) => one.speed) },
    { name: `x [${unit}]`, values: rows.map((one) => one.x) },
    { name: `y [${unit}]`, values: rows.map((one) => one.y) },
  ];
}
