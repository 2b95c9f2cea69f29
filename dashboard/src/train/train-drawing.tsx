// The train drawn to scale from its document: shafts, discs, bearings, seals, pedestals, couplings, probes.
import type { ComponentChildren } from "preact";
import { useEffect, useRef } from "preact/hooks";
import type { DataColumn } from "../browser/download";
import { elementId, elementName } from "../format/names";
import { decimal } from "../format/numbers";
import { t } from "../messages/messages";
import { SaveDrawing } from "../plots/save-buttons";
import type { Drawing } from "../schemas/machines";
import { trainLayout, type TrainLayout } from "./layout";
import { MARK_SIGNS, UNKNOWN, worstElement, type Mark } from "./marks";

const WIDTH = 1000;
const MARGIN = 24;

interface Props {
  name: string;
  drawing: Drawing;
  marks: Map<string, Mark>;
  onChoose: (element: string) => void;
}

/** Lengths [m] on the drawing. */
interface DrawingScale {
  height: number;
  axis: number;
  /** Length of a distance along the train. */
  along: (length: number) => number;
  /** Place along the train. */
  at: (z: number) => number;
  thick: (radius: number) => number;
  /** Diameters are drawn so many times larger than lengths. */
  stretch: number;
}

interface PartProps {
  layout: TrainLayout;
  scale: DrawingScale;
  marks: Map<string, Mark>;
  onChoose: (element: string) => void;
}

export function TrainDrawing({ name, drawing, marks, onChoose }: Props) {
  const layout = trainLayout(drawing);
  const scale = scaleOf(layout);
  const parts: PartProps = { layout, scale, marks, onChoose };
  const figure = useRef<HTMLElement>(null);
  const worst = worstElement(marks);
  // Where the train is wider than the window, the worst element is scrolled into sight.
  useEffect(() => {
    const whole = figure.current!;
    const box = worst && whole.querySelector(`[data-element="${worst}"]`)?.getBoundingClientRect();
    if (box) whole.scrollLeft += box.left + box.width / 2 - whole.getBoundingClientRect().left - whole.clientWidth / 2;
  }, [worst]);
  return (
    <figure class="train scroll" ref={figure}>
      <SaveDrawing label={t("trainNamed", { name })} columns={() => columnsOf(drawing, marks)} />
      <svg viewBox={`0 0 ${WIDTH} ${scale.height}`} role="group" aria-label={t("drawnToScale", { name })}>
        <line class="axis" x1={MARGIN / 2} x2={WIDTH - MARGIN / 2} y1={scale.axis} y2={scale.axis} />
        <Sections {...parts} />
        <Discs {...parts} />
        <Couplings {...parts} />
        <Bearings {...parts} />
        <Seals {...parts} />
        <Pedestals {...parts} />
        <Probes {...parts} />
        <Ruler length={layout.length} at={scale.at} y={scale.height - 8} />
      </svg>
      {scale.stretch > 1.05 && <figcaption>{t("lengthsToScale", { times: decimal(scale.stretch.toFixed(1)) })}</figcaption>}
    </figure>
  );
}

function columnsOf(drawing: Drawing, marks: Map<string, Mark>): DataColumn[] {
  const { discs, bearings, seals, pedestals, couplings } = drawing;
  const elements = [...discs, ...bearings, ...seals, ...pedestals, ...couplings].sort((one, other) => one.at - other.at);
  const mark = (element: string) => marks.get(element) ?? UNKNOWN;
  return [
    { name: t("csvElement"), values: elements.map((one) => one.element) },
    { name: "z [m]", values: elements.map((one) => one.at) },
    { name: t("csvMark"), values: elements.map((one) => mark(one.element).level) },
    { name: t("csvWords"), values: elements.map((one) => mark(one.element).words) },
  ];
}

/** Radii have the scale of lengths, unless the train is so slender that nothing would be seen. */
function scaleOf(layout: TrainLayout): DrawingScale {
  const scale = (WIDTH - 2 * MARGIN) / layout.length;
  const stretch = Math.max(1, 26 / (layout.radius * scale));
  const tall = Math.min(120, Math.max(34, layout.radius * scale * stretch));
  const axis = 44 + tall;
  return {
    height: axis + tall + (layout.pedestals.length ? 92 : 64),
    axis,
    along: (length) => length * scale,
    at: (z) => MARGIN + z * scale,
    thick: (radius) => Math.min(tall, radius * scale * stretch),
    stretch,
  };
}

interface ElementProps {
  id: string;
  kind: string;
  marks: Map<string, Mark>;
  onChoose: (element: string) => void;
  /** Place of the name. */
  x: number;
  y: number;
  children: ComponentChildren;
}

/** An element with its name and mark, which can be chosen. */
function Element({ id, kind, marks, onChoose, x, y, children }: ElementProps) {
  const mark = marks.get(id) ?? UNKNOWN;
  // tabindex, not tabIndex: names of SVG's attributes are case-sensitive.
  return (
    <g
      class={`element ${kind} ${mark.level}`}
      tabindex={0}
      role="button"
      aria-label={`${elementName(id)}${mark.words ? `: ${mark.words}` : ""}`}
      data-element={id}
      onClick={() => onChoose(id)}
      onKeyDown={(event: KeyboardEvent) => (event.key === "Enter" || event.key === " ") && (event.preventDefault(), onChoose(id))}
    >
      <title>{`${elementName(id)}${mark.words ? `\n${mark.words}` : ""}`}</title>
      {children}
      <text x={x} y={y} text-anchor="middle">
        {MARK_SIGNS[mark.level]} {elementId(id)}
      </text>
    </g>
  );
}

function Sections({ layout, scale: { at, along, axis, thick } }: PartProps) {
  return (
    <>
      {layout.sections.map((one) => (
        <rect class="section" x={at(one.at)} width={along(one.length)} y={axis - thick(one.radius)} height={2 * thick(one.radius)} />
      ))}
    </>
  );
}

function Discs({ layout, scale: { at, along, axis, thick }, marks, onChoose }: PartProps) {
  return (
    <>
      {layout.discs.map((one) => {
        const half = thick(one.radius);
        const wide = Math.max(7, along(one.width));
        return (
          <Element key={one.element} id={one.element} kind="disc" marks={marks} onChoose={onChoose} x={at(one.at)} y={axis - half - 6}>
            <rect x={at(one.at) - wide / 2} width={wide} y={axis - half} height={2 * half} rx={1.5} />
          </Element>
        );
      })}
    </>
  );
}

function Couplings({ layout, scale: { at, axis, thick }, marks, onChoose }: PartProps) {
  return (
    <>
      {layout.couplings.map((one) => {
        const half = Math.max(16, thick(one.radius) + 5);
        const x = at(one.at);
        return (
          <Element key={one.element} id={one.element} kind="coupling" marks={marks} onChoose={onChoose} x={x} y={axis - half - 6}>
            <rect x={x - 9} width={7} y={axis - half} height={2 * half} rx={1.5} />
            <rect x={x + 2} width={7} y={axis - half} height={2 * half} rx={1.5} />
            <path d={`M${x - 2} ${axis - half + 3}L${x + 2} ${axis - half + 8}M${x - 2} ${axis + half - 3}L${x + 2} ${axis + half - 8}`} />
          </Element>
        );
      })}
    </>
  );
}

function Bearings({ layout, scale: { at, axis, thick }, marks, onChoose }: PartProps) {
  return (
    <>
      {layout.bearings.map((one) => {
        const foot = axis + thick(one.radius);
        return (
          <Element key={one.element} id={one.element} kind="bearing" marks={marks} onChoose={onChoose} x={at(one.at)} y={foot + 37}>
            <path d={`M${at(one.at)} ${foot}l-11 19h22zM${at(one.at) - 15} ${foot + 22}h30`} />
          </Element>
        );
      })}
    </>
  );
}

function Seals({ layout, scale: { at, axis, thick }, marks, onChoose }: PartProps) {
  return (
    <>
      {layout.seals.map((one) => {
        const foot = axis + thick(one.radius);
        return (
          <Element key={one.element} id={one.element} kind="seal" marks={marks} onChoose={onChoose} x={at(one.at)} y={foot + 24}>
            <path d={`M${at(one.at) - 8} ${foot + 2}l4 7l4 -7l4 7l4 -7`} />
          </Element>
        );
      })}
    </>
  );
}

/** Under its bearing, whose name stands between them. */
function Pedestals({ layout, scale: { at, axis, thick }, marks, onChoose }: PartProps) {
  return (
    <>
      {layout.pedestals.map((one) => {
        const foot = axis + thick(one.radius);
        return (
          <Element key={one.element} id={one.element} kind="pedestal" marks={marks} onChoose={onChoose} x={at(one.at)} y={foot + 66}>
            <path d={`M${at(one.at) - 12} ${foot + 42}h24l4 10h-32zM${at(one.at) - 20} ${foot + 54}h40`} />
          </Element>
        );
      })}
    </>
  );
}

function Probes({ layout, scale: { at, axis, thick }, marks }: PartProps) {
  return (
    <>
      {layout.probes.map((one) => {
        const found = one.channels.flatMap((channel) => marks.get(`probe.${channel}`) ?? []);
        const words = [t("probesAt", { probes: one.channels.join(", ") }), ...found.map((mark) => mark.words)].join("\n");
        const top = axis - thick(one.radius) - 3;
        return (
          <g class={`probe ${found[0]?.level ?? ""}`} role="img" aria-label={words}>
            <title>{words}</title>
            <path d={`M${at(one.at)} ${top}v-12m-3.5 0h7`} />
            {found[0] && (
              <text x={at(one.at)} y={top - 16} text-anchor="middle">
                {MARK_SIGNS[found[0].level]}
              </text>
            )}
          </g>
        );
      })}
    </>
  );
}

function Ruler({ length, at, y }: { length: number; at: (z: number) => number; y: number }) {
  const step = [0.1, 0.2, 0.5, 1, 2, 5, 10].find((one) => length / one <= 12) ?? 20;
  const ticks = Array.from({ length: Math.floor(length / step + 1e-9) + 1 }, (_, index) => index * step);
  return (
    <g class="ruler">
      {ticks.map((z) => (
        <text x={at(z)} y={y} text-anchor="middle">
          {z === 0 ? "0" : decimal(String(Number(z.toFixed(1))))}
          {z === ticks.at(-1) ? " m" : ""}
        </text>
      ))}
      {ticks.map((z) => (
        <line x1={at(z)} x2={at(z)} y1={y - 15} y2={y - 11} />
      ))}
    </g>
  );
}
