// A run's phasors in ascending order of speed, as plots need them.
import type { Phasors } from "../schemas/runs";

export interface SpeedSweep {
  channels: string[];
  rpm: number[];
  /** Per channel [µm pp]. */
  amplitude: (number | null)[][];
  /** Per channel, lag [°], 0 to 360. */
  lag: (number | null)[][];
  /** Amplitude of the 2× per channel [µm pp]; empty where it was not requested. */
  second: (number | null)[][];
  /** Lag of the 2× per channel, in degrees of the 2× [°]. */
  secondLag: (number | null)[][];
}

export function speedSweep(phasors: Phasors): SpeedSweep {
  const order = phasors.speed_rpm.map((_, index) => index).sort((a, b) => phasors.speed_rpm[a]! - phasors.speed_rpm[b]!);
  const sorted = <T>(values: T[]): T[] => order.map((index) => values[index]!);
  return {
    channels: phasors.channels,
    rpm: sorted(phasors.speed_rpm),
    amplitude: phasors.amplitude_um_pp.map(sorted),
    lag: phasors.phase_lag_deg.map(sorted),
    second: (phasors.amplitude_2x_um_pp ?? []).map(sorted),
    secondLag: (phasors.phase_2x_lag_deg ?? []).map(sorted),
  };
}
