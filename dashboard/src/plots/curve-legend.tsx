// The names of curves with a sample of each line.
import { COLOURS, dash } from "./curve-style";
import type { Curve } from "./plot-props";
import { listedCurves } from "./read-out";

export function CurveLegend({ curves }: { curves: Pick<Curve, "name" | "style" | "faint" | "unlisted">[] }) {
  return (
    <span class="names">
      {listedCurves(curves).map((one, index) => (
        <span key={one.name}>
          <svg class={`curve s${(one.style ?? index) % COLOURS}`} width={24} height={8} aria-hidden="true">
            <path d="M0 4h24" stroke-dasharray={dash(one.style ?? index).join(" ")} />
          </svg>{" "}
          {one.name}
        </span>
      ))}
    </span>
  );
}
