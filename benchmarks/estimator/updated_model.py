"""Coverage of the bands of the updated model's results, on the Chapter 3 train measured at the bearings only.

Data as in `benchmarks.estimator.trains`: 150 speeds, 2 to 300 rad/s, 1 % complex noise. Each run draws its own noise,
identifies the train and predicts; the truth is the nominal train itself.

    python -m benchmarks.estimator.updated_model [--runs N]
"""

import math
from collections import defaultdict
from collections.abc import Sequence

import numpy as np
from threadpoolctl import threadpool_limits

from benchmarks.estimator.arguments import runs_asked
from benchmarks.estimator.trains import SimulatedTrain, two_shafts
from estimator.balancing.model_balancing import balance
from estimator.fit.estimates import CONFIDENCE_95
from estimator.fit.identify import identify
from estimator.machine.parts import Probe
from estimator.modes.critical_speed import critical_speed_table
from estimator.updated_model.coupling_loads import coupling_forces
from estimator.updated_model.forced_response import forced_response
from estimator.updated_model.modal_uncertainty import critical_speed_errors
from estimator.updated_model.model import UpdatedModel, updated_model
from estimator.updated_model.station_response import station_response
from estimator.updated_model.uncertainty import PhasorBand

RUNS = 100
SPEED = np.array([60.0, 110.0, 150.0, 220.0, 290.0])
PLACES = (Probe(id="P1", shaft="S1", station=0.6, angle_deg=30.0), Probe(id="P2", shaft="S2", station=1.0, angle_deg=90.0))
"""Between the bearings, where nothing is measured."""
HIGHEST = 300.0
COMPONENTS = ("force_x", "force_y", "moment_x", "moment_y")
SPRINGS = ("k_phix", "k_phiy")


def true_model(train: SimulatedTrain) -> UpdatedModel:
    """Return the nominal train."""
    count = train.truth.size - 2 * len(train.machine.discs)
    parts = train.truth[count:].reshape(-1, 2)
    nothing = np.zeros((train.truth.size, train.truth.size))
    unbalances = parts[:, 0] + 1j * parts[:, 1]
    return UpdatedModel.of(train.machine, coefficients=train.truth[:count], unbalances=unbalances, covariance=nothing)


def relative_error(band: PhasorBand) -> float:
    """Return the median standard error of an amplitude, relative to it."""
    return float(np.median((band.upper - band.amplitude) / band.amplitude)) / CONFIDENCE_95


def main(arguments: Sequence[str] | None = None) -> None:
    """Run and print."""
    name = "benchmarks.estimator.updated_model"
    runs = runs_asked(arguments, name=name, description=__doc__, default=RUNS, what="noise draws")
    with threadpool_limits(limits=1):
        print(report(two_shafts(), runs))


def report(train: SimulatedTrain, runs: int) -> str:
    """Return the coverage of each result, and the residual after balancing the true train with an identified model."""
    truth = true_model(train)
    (true_force,) = coupling_forces(truth, speed=SPEED)
    true_response = station_response(truth, speed=SPEED, places=PLACES).response.amplitude
    true_critical = np.array([one.speed for one in critical_speed_table(train.machine, highest=HIGHEST)])
    hits: dict[str, list[float]] = defaultdict(list)
    errors: dict[str, list[float]] = defaultdict(list)
    left = []
    for seed in range(runs):
        identification = identify(train.machine, train.measured(seed))
        model = updated_model(train.machine, identification)
        (force,) = coupling_forces(model, speed=SPEED)
        for name in COMPONENTS:
            band: PhasorBand = getattr(force, name)
            hits[f"coupling {name}"].append(_part_inside(band, getattr(true_force, name).amplitude))
            errors[f"coupling {name}"].append(relative_error(band))
        for name in SPRINGS:
            estimate = identification.estimate(f"coupling.C1.{name}")
            errors[f"coupling {name} itself"].append((estimate.standard_error or math.nan) / (estimate.value or math.nan))
        response = station_response(model, speed=SPEED, places=PLACES).response
        hits["response between the bearings"].append(_part_inside(response, true_response))
        errors["response between the bearings"].append(relative_error(response))
        table = critical_speed_table(model.scaled_machine, highest=HIGHEST, coefficients=model.coefficients)
        spread = critical_speed_errors(model, table)
        found = np.array([one.speed for one in table])
        hits["critical speeds"].append(float(np.mean(np.abs(found - true_critical) <= CONFIDENCE_95 * spread)))
        errors["critical speeds"].append(float(np.median(spread / found)))
        correction = balance(model, planes=[disc.id for disc in train.machine.discs], speed=SPEED)
        after = np.abs(forced_response(truth, speed=SPEED, added=correction.unbalance).phasor)
        hits["vibration after balancing below its bound"].append(float(np.mean(after <= correction.after.upper)))
        left.append(float(after.max() / correction.before.amplitude.max()))
    lines = [f"{runs} identifications of the Chapter 3 train, bearings only, 1 % noise", ""]
    lines.append(f"  {'':<44}{'asked':>8}{'inside':>9}{'median standard error':>25}")
    for name in dict.fromkeys([*hits, *errors]):
        asked = "" if name not in hits else "97.5 %" if "bound" in name else "95 %"
        inside = f"{100 * np.mean(hits[name]):.1f} %" if name in hits else ""
        error = f"{100 * np.median(errors[name]):.2f} %" if name in errors else ""
        lines.append(f"  {name:<44}{asked:>8}{inside:>9}{error:>25}".rstrip())
    lines.append(f"  largest vibration after balancing, part of before: median {np.median(left):.4f}, worst {max(left):.4f}")
    return "\n".join(lines)


def _part_inside(band: PhasorBand, truth: np.ndarray) -> float:
    return float(np.mean((truth >= band.lower) & (truth <= band.upper)))


if __name__ == "__main__":
    main()
