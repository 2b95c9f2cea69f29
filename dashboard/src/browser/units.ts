// The units that vibration and speed are shown in, chosen here and kept by the browser; the API's are µm peak-to-peak and r/min.
import { t } from "../messages/messages";
import { Store, useStore } from "./store";

/** A unit's label, and the factor from the API's unit. */
export interface Unit {
  label: string;
  factor: number;
}

export interface Units {
  amplitude: Unit;
  /** Unit of places along a probe's axis and of alignments, with the factor from µm. */
  length: Unit;
  speed: Unit;
}

const STORAGE_KEY = "rundown.units";
const MIL_UM = 25.4;
const MICROMETRES: Unit = { label: "µm", factor: 1 };
const MILS: Unit = { label: "mil", factor: 1 / MIL_UM };
const AMPLITUDES: Record<string, Unit> = {
  um_pp: { label: "µm pp", factor: 1 },
  um_p: { label: "µm 0-pk", factor: 0.5 },
  mil_pp: { label: "mil pp", factor: 1 / MIL_UM },
  mil_p: { label: "mil 0-pk", factor: 0.5 / MIL_UM },
};
const SPEEDS: Record<string, Unit> = { rpm: { label: t("rpm"), factor: 1 }, hz: { label: "Hz", factor: 1 / 60 } };

/** Every choice by its name: `um_pp,rpm`. */
export const UNIT_CHOICES: [string, Units][] = Object.entries(SPEEDS).flatMap(([speedName, speed]) =>
  Object.entries(AMPLITUDES).map(([name, amplitude]): [string, Units] => [`${name},${speedName}`, { amplitude, length: name.startsWith("mil") ? MILS : MICROMETRES, speed }]),
);

export const DEFAULT_UNITS = UNIT_CHOICES[0]![1];

function saved(): string {
  const name = window.localStorage.getItem(STORAGE_KEY);
  return UNIT_CHOICES.some(([one]) => one === name) ? name! : UNIT_CHOICES[0]![0];
}

export const unitChoice = new Store<string>(saved());

/** The unit of small lengths now, for what is drawn anew when another one is chosen. */
export function lengthUnit(): Unit {
  return UNIT_CHOICES.find(([one]) => one === unitChoice.value)![1].length;
}

export function chooseUnits(name: string): void {
  window.localStorage.setItem(STORAGE_KEY, name);
  unitChoice.set(name);
}

export function useUnits(): Units {
  const name = useStore(unitChoice);
  return UNIT_CHOICES.find(([one]) => one === name)![1];
}

/** Values in a unit. */
export function inUnit(values: (number | null)[], { factor }: Unit): (number | null)[] {
  return factor === 1 ? values : values.map((one) => (one === null ? null : one * factor));
}

export function speedsInUnit(values: number[], { factor }: Unit): number[] {
  return factor === 1 ? values : values.map((one) => one * factor);
}
