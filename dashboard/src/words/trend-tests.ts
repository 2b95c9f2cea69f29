// The results of the trend tests of a parameter in words: of a vector's component where they are of one.
import { isCrossCoupled } from "../format/names";
import { number, percent } from "../format/numbers";
import { when } from "../format/times";
import { t } from "../messages/messages";
import type { ControlChart, Drift, TrendTest } from "../schemas/trends";

/** Drifts that chance would make more often than this are not stated. */
const SIGNIFICANT = 0.01;
/** So many runs that grow one after another make a drift that is stated: fewer may be its beginning, or a step. */
const TELL_A_STEP = 6;
const COMPONENTS: Record<string, string> = { real: t("realPart"), imaginary: t("imaginaryPart") };

/** One sentence for each test that was passed over its limit. */
export function trendTestTexts(parameter: string, tests: TrendTest[]): string[] {
  return tests.flatMap((test) => {
    const component = test.name.startsWith(`${parameter}.`) ? test.name.slice(parameter.length + 1) : "";
    const prefix = component ? `${COMPONENTS[component] ?? component}: ` : "";
    const drifts = drift(test, reference(parameter, component));
    // Whoever drifts for weeks passes the limit of a step as well: it is no step.
    const jumps = drifts.length > 0 ? drifted(test) : steps(test);
    return [...jumps, ...slowShift(test), ...drifts].map((one) => prefix + one);
  });
}

/** The quantity that per cent are of: a component is compared with its vector's length, a cross-coupled term with the direct ones. */
function reference(parameter: string, component: string): string {
  if (component) return t("ofBaselinesMagnitude");
  return isCrossCoupled(parameter) ? t("ofDirectTerms") : "";
}

function steps(test: TrendTest): string[] {
  return [...step(test.step_up, "stepUp", "higherSince"), ...step(test.step_down, "stepDown", "lowerSince")];
}

function step(chart: ControlChart | null, told: "stepUp" | "stepDown", young: "higherSince" | "lowerSince"): string[] {
  if (!chart?.passed) return [];
  const since = chart.began ? t("mostLikelySince", { began: when(chart.began) }) : "";
  return [t((chart.runs ?? TELL_A_STEP) < TELL_A_STEP ? young : told, { since })];
}

/** Since when a drift shows. */
function drifted({ step_up: up, step_down: down }: TrendTest): string[] {
  const began = up.passed ? up.began : down?.passed ? down.began : null;
  return began ? [t("driftingSeenSince", { began: when(began) })] : [];
}

function slowShift({ creep }: TrendTest): string[] {
  return creep.passed ? [t("meanOfNewest", { where: creep.value > 0 ? t("aboveBaseline") : t("belowBaseline") })] : [];
}

function drift({ drift: found }: TrendTest, of: string): string[] {
  if (!found || found.probability >= SIGNIFICANT) return [];
  return [t("driftPerWeek", { rate: percent(found.per_week / 100), of, lower: number(found.lower, 2), upper: number(found.upper, 2), forecast: forecast(found) })];
}

function forecast(found: Drift): string {
  const next = [found.alert, found.danger].find((one) => one?.expected !== null && one?.expected !== undefined && one.expected > 0);
  return next ? t("reachesIn", { per_cent: number(next.per_cent, 2), weeks: number(next.expected, 2) }) : "";
}
