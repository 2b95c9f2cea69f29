// The train drawn to scale from its document: shafts, discs, bearings, seals, couplings, probes.
import { useEffect, useRef } from "preact/hooks";
import type { Drawing } from "../schemas/answers";
import { elementName } from "../words/format";
import { layout, type Layout } from "./layout";

/** How far an element is from its baseline; the words go beside it, so that colour is never alone. */
export interface Mark {
  level: "normal" | "changed" | "alert" | "danger" | "unknown";
  words: string;
}

const WIDTH = 1000;
const MARGIN = 24;
const GLYPHS: Record<Mark["level"], string> = { normal: "", changed: "●", alert: "▲", danger: "◆", unknown: "" };

function worstOf(marks: Map<string, Mark>): string | undefined {
  for (const level of ["danger", "alert", "changed"]) {
    for (const [element, mark] of marks) if (mark.level === level) return element;
  }
  return undefined;
}

interface Props {
  name: string;
  drawing: Drawing;
  marks: Map<string, Mark>;
  chosen: string | null;
  onChoose: (element: string) => void;
}

export function Train({ name, drawing, marks, chosen, onChoose }: Props) {
  const plan = layout(drawing);
  const scale = (WIDTH - 2 * MARGIN) / plan.length;
  // Radii are drawn to the same scale as lengths, unless the train is so slender that nothing would be seen.
  const stretch = Math.max(1, 26 / (plan.radius * scale));
  const tall = Math.min(120, Math.max(34, plan.radius * scale * stretch));
  const axis = 44 + tall;
  const height = axis + tall + 64;
  const at = (z: number) => MARGIN + z * scale;
  const thick = (radius: number) => Math.min(tall, radius * scale * stretch);
  const element = (id: string, kind: string, shape: preact.ComponentChildren, x: number, y: number) => {
    const mark = marks.get(id) ?? { level: "unknown", words: "not known: there is nothing to compare" };
    // tabindex, not tabIndex: names of SVG's attributes are case-sensitive.
    return (
      <g
        key={id}
        class={`element ${kind} ${mark.level} ${chosen === id ? "chosen" : ""}`}
        tabindex={0}
        role="button"
        aria-label={`${elementName(id)}${mark.words ? `: ${mark.words}` : ""}`}
        data-element={id}
        onClick={() => onChoose(id)}
        onKeyDown={(event: KeyboardEvent) => (event.key === "Enter" || event.key === " ") && (event.preventDefault(), onChoose(id))}
      >
        <title>{`${elementName(id)}${mark.words ? `\n${mark.words}` : ""}`}</title>
        {shape}
        <text x={x} y={y} text-anchor="middle">
          {GLYPHS[mark.level]} {id.split(".")[1]}
        </text>
      </g>
    );
  };
  const figure = useRef<HTMLElement>(null);
  const worst = worstOf(marks);
  // Where the train is longer than a phone is wide, what matters most is not left outside.
  useEffect(() => {
    const whole = figure.current!;
    const box = worst && whole.querySelector(`[data-element="${worst}"]`)?.getBoundingClientRect();
    if (box) whole.scrollLeft += box.left + box.width / 2 - whole.getBoundingClientRect().left - whole.clientWidth / 2;
  }, [worst]);
  return (
    <figure class="train" ref={figure}>
      <svg viewBox={`0 0 ${WIDTH} ${height}`} role="group" aria-label={`${name}, drawn to scale from driver to driven`}>
        <line class="axis" x1={MARGIN / 2} x2={WIDTH - MARGIN / 2} y1={axis} y2={axis} />
        {plan.sections.map((one) => (
          <rect
            class="section"
            x={at(one.at)}
            width={one.length * scale}
            y={axis - thick(one.radius)}
            height={2 * thick(one.radius)}
          />
        ))}
        {plan.discs.map((one) => {
          const half = thick(one.radius);
          const wide = Math.max(7, one.width * scale);
          return element(
            one.element,
            "disc",
            <rect x={at(one.at) - wide / 2} width={wide} y={axis - half} height={2 * half} rx={1.5} />,
            at(one.at),
            axis - half - 6,
          );
        })}
        {plan.couplings.map((one) => {
          const half = Math.max(16, thick(one.radius) + 5);
          return element(
            one.element,
            "coupling",
            <>
              <rect x={at(one.at) - 9} width={7} y={axis - half} height={2 * half} rx={1.5} />
              <rect x={at(one.at) + 2} width={7} y={axis - half} height={2 * half} rx={1.5} />
              <path d={`M${at(one.at) - 2} ${axis - half + 3}L${at(one.at) + 2} ${axis - half + 8}M${at(one.at) - 2} ${axis + half - 3}L${at(one.at) + 2} ${axis + half - 8}`} />
            </>,
            at(one.at),
            axis - half - 6,
          );
        })}
        {plan.bearings.map((one) => {
          const foot = axis + thick(one.radius);
          return element(
            one.element,
            "bearing",
            <path d={`M${at(one.at)} ${foot}l-11 19h22zM${at(one.at) - 15} ${foot + 22}h30`} />,
            at(one.at),
            foot + 37,
          );
        })}
        {plan.seals.map((one) => {
          const foot = axis + thick(one.radius);
          return element(
            one.element,
            "seal",
            <path d={`M${at(one.at) - 8} ${foot + 2}l4 7l4 -7l4 7l4 -7`} />,
            at(one.at),
            foot + 24,
          );
        })}
        <Probes plan={plan} marks={marks} at={at} y={axis} thick={thick} />
        <Ruler length={plan.length} at={at} y={height - 8} />
      </svg>
      {stretch > 1.05 && <figcaption>Lengths to scale; diameters {stretch.toFixed(1)} times larger.</figcaption>}
    </figure>
  );
}

interface ProbesProps {
  plan: Layout;
  marks: Map<string, Mark>;
  at: (z: number) => number;
  y: number;
  thick: (radius: number) => number;
}

function Probes({ plan, marks, at, y, thick }: ProbesProps) {
  return (
    <>
      {plan.probes.map((one) => {
        const found = one.channels.flatMap((channel) => marks.get(`probe.${channel}`) ?? []);
        const words = [`probes ${one.channels.join(", ")}`, ...found.map((mark) => mark.words)].join("\n");
        const top = y - thick(one.radius) - 3;
        return (
          <g class={`probe ${found[0]?.level ?? ""}`} role="img" aria-label={words}>
            <title>{words}</title>
            <path d={`M${at(one.at)} ${top}v-12m-3.5 0h7`} />
            {found[0] && (
              <text x={at(one.at)} y={top - 16} text-anchor="middle">
                {GLYPHS[found[0].level]}
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
  const marks = Array.from({ length: Math.floor(length / step + 1e-9) + 1 }, (_, index) => index * step);
  return (
    <g class="ruler">
      {marks.map((z) => (
        <text x={at(z)} y={y} text-anchor="middle">
          {z === 0 ? "0" : Number(z.toFixed(1))}
          {z === marks.at(-1) ? " m" : ""}
        </text>
      ))}
      {marks.map((z) => (
        <line x1={at(z)} x2={at(z)} y1={y - 15} y2={y - 11} />
      ))}
    </g>
  );
}
