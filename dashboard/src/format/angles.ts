// Directions and angles: how unbalances count, how a shaft whirls.
import { t } from "../messages/messages";
import { decimal, number } from "./numbers";

/** State how angles of unbalances count; a lag, as of all measured phases, counts against the rotation. */
export function angleConvention(rotation: "positive" | "negative" = "positive"): string {
  return t("fromTheMark", { sense: rotation === "positive" ? t("withRotation") : t("againstRotation") });
}

/** Half an interval that leaves every angle open [°]. */
export const ANY_ANGLE = 180;

/** An angle from the keyphasor mark with its 95 % interval; empty for what is no vector or not known. */
export function angleText(angle: number | null, halfWidth: number | null): string {
  if (angle === null || halfWidth === null) return "";
  return halfWidth < ANY_ANGLE ? t("atAngle", { angle: decimal(angle.toFixed(1)), half: number(halfWidth, 2) }) : t("atAnyAngle");
}

/** A whirl of a smaller size is planar, as in estimator/rotor/whirl.py. */
const PLANAR = 0.05;

/** Whether a whirl between -1, circular against the rotation, and 1, circular with it, is backward. */
export function isBackward(whirl: number): boolean {
  return whirl <= -PLANAR;
}

/** Name a whirl between -1, circular against the rotation, and 1, circular with it. */
export function whirlName(whirl: number): string {
  if (Math.abs(whirl) < PLANAR) return t("planar");
  return isBackward(whirl) ? t("backward") : t("forward");
}
