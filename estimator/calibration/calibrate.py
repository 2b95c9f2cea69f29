"""Joint calibration of a machine from several runs with known unbalances, in several mountings."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from msgspec import structs
from numpy.typing import NDArray

from estimator.arrays import Floats
from estimator.calibration.calibrated_document import calibrated_document
from estimator.calibration.calibration_runs import CalibrationRun, check_runs
from estimator.calibration.chain_start import best_chains
from estimator.calibration.exchanges import exchange_text, likely_exchanges, log_likelihood
from estimator.calibration.forgotten_mountings import WORDS as OWN_MOUNTINGS
from estimator.calibration.forgotten_mountings import mounting_text, with_own_mountings
from estimator.calibration.likely_gains import unlikely_gains
from estimator.calibration.mixed_units import explaining_units, mixed_units
from estimator.calibration.mounted_problem import MountedProblem
from estimator.calibration.scatter_likelihood import information_of_means, with_scatter_bound
from estimator.calibration.small_sample import widened
from estimator.calibration.undetermined import distinct_speeds, with_free_gains, with_free_parameters
from estimator.calibration.variance_components import ScatterModel, ScatterSizes
from estimator.calibration.weights_in_step import NOT_SEEN, TOO_FEW, judge_weights
from estimator.calibration.wrong_senses import explaining_senses
from estimator.fit.optimisation.maximum_likelihood import descend
from estimator.fit.optimisation.multistart import BestFit, FitFailed, best_fit
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.validation.goodness_of_fit import LARGEST_ESTIMATED_NOISE
from estimator.machine.calibration import Calibration, CalibrationRunRecord, ChannelScatter, MountingSpread
from estimator.machine.document import Machine
from estimator.machine.rules import Noise
from estimator.phasors.measurement import Measurement, joined
from estimator.phasors.noise import error_size
from estimator.rotor.condensation import condense
from estimator.rotor.elimination import SingularCondensation
from estimator.units import rad_per_s_to_rpm

STATED_ECCENTRICITY = 4e-6
"""Eccentricity by which discs differ from mounting to mounting, before the runs have shown it [m]."""
STATED_RUN_OUT = 3e-7
"""Run-out by which a channel differs from mounting to mounting, before the runs have shown it [m]."""
STATED_NOISE = 2e-7
"""Rms error of a phasor at constant speed, before the runs have shown it [m]."""
UNLIKE = 10.0
"""Most times by which the noise of one dwell's channel is expected to be more or less than usual [-]."""
LARGE_MOUNTING_PART = 0.3
"""Part of the trial weights' effect beyond which differences between mountings are doubted [-]"""
USUAL_PASSES = 10
"""Most times that the sizes of scatter are estimated anew where mountings differ little beside the trial weights."""
PASSES, PASSES_OF_OTHERS = 40, 20
"""Most times where they differ by more, for runs as they are stated, and as they may have been meant."""
ENOUGH = 12
"""Passes from which on a fit ends as soon as it would be refused: those of runs that fit have settled by then."""
SOON = 4
"""Passes after which a fit of runs as they may have been meant ends where it can no longer explain them better."""
STILL_TO_COME = 5.0
"""Most times the last pass's gain in the logarithm of the likelihood that all later ones bring together [-]."""
HOPELESS_PART = 1.5
"""Part of the trial weights' effect by which mountings may differ in a fit of runs as they may have been meant [-]."""
STEPS = 40
"""Most steps of the fit in each of these."""
MOST_OF_SWEEPS = (120, 400)
"""Number of samples of all sweeps together for the starts, and for the end: more at nearly the same speeds say little."""
STARTS, STARTS_OF_OTHERS = 6, 1
"""Most starts of the first fit of the runs as they are stated, and as they may have been meant."""
NO_FIT = (FitFailed, SingularCondensation, np.linalg.LinAlgError)


@dataclass(frozen=True)
class Calibrated:
    """Outcome of a calibration.

    Attributes:
        machine: The machine with the calibration in its document.
        accepted: Whether the calibration may be used.
        verdict: The verdict in words.
        remarks: Remarks on what the runs could not determine.
        starts: Number of starts of the fit.
        unique: Whether the best optimum was found twice.
        sizes: Sizes of scatter that the runs showed.
        speeds: Speeds (D,) that the dwells were taken at [rad/s].
        coarse: Fit of a part of the samples, beside which those of runs as they may have been meant are judged.
        doubts: Those of the remarks that speak against the weights' or the amplitudes' units.
    """

    machine: Machine
    accepted: bool
    verdict: str
    remarks: tuple[str, ...]
    starts: int
    unique: bool
    sizes: ScatterSizes
    speeds: Floats
    coarse: "CoarseFit"
    doubts: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class CoarseFit:
    """Fit of a part of the samples of a calibration's runs.

    Attributes:
        problem: Its problem, with the sizes of scatter that the samples showed.
        theta: Its end θ (n,) [-].
    """

    problem: MountedProblem
    theta: Floats

    @property
    def log_likelihood(self) -> float:
        """Return the logarithm of the likelihood of its samples, but for a constant [-]."""
        return log_likelihood(self.problem, self.theta)


@dataclass(frozen=True)
class _Effort:
    """Effort of a fit: samples of sweeps as in `MOST_OF_SWEEPS`, most starts, and most passes for either number of samples.

    likelier_than: logarithm of the likelihood that it shall exceed, or it ends as soon as it cannot; None for a whole fit.
    """

    of_sweeps: tuple[int, int]
    starts: int
    passes: int
    likelier_than: float | None = None


@dataclass(frozen=True)
class _Gathered:
    """All samples in the order of their mountings: mounting (S,), whether at constant speed (S,)."""

    measurement: Measurement
    mounting: NDArray[np.intp]
    steady: NDArray[np.bool_]


@dataclass(frozen=True)
class _Fitted:
    """Fit of all runs: the document that was fitted, what it holds in words, and where the fit and the scatter ended."""

    machine: Machine
    held: tuple[str, ...]
    problem: MountedProblem
    scatter: ScatterModel
    theta: Floats
    sizes: ScatterSizes
    converged: bool
    first: BestFit
    speeds: Floats
    coarse: CoarseFit


def calibrate(machine: Machine, runs: Sequence[CalibrationRun], *, seed: int = 0) -> Calibrated:
    """Calibrate a machine from runs with known unbalances.

    A mixed model (Henderson 1975, doi:10.2307/2529430): coefficients, moduli, gains, run-outs and the machine's own unbalance
    are common to all runs; unbalances and run-outs differ a little from mounting to mounting; noise is that of each channel,
    and of each speed at which it dwelt.

    Args:
        machine: The machine, with what is known of it.
        runs: The runs.
        seed: Seed of the random starts.

    Returns:
        The calibrated machine, with the verdict on it.

    Raises:
        CalibrationImpossible: A run does not state its weights or states impossible ones, or nothing differs between runs.
        FitFailed: No start leads to a finite misfit.
        SingularCondensation: The train cannot be condensed at a speed.
    """
    remarks, mixed = check_runs(machine, runs), mixed_units([disc.id for disc in machine.discs], runs)
    return _calibrated(machine, runs, (*remarks, *(() if mixed is None else (mixed.remark,))), seed)


def with_named_senses(machine: Machine, runs: Sequence[CalibrationRun], found: Calibrated, *, seed: int = 0) -> Calibrated:
    """Name mixed units, wrong senses, exchanged probes or weights and forgotten mountings, without which runs fit far better.

    Units and senses are tried where a calibration is refused, and named where it would be accepted; exchanges and mountings
    are tried of an accepted one, too, for free gains and noise hide them.

    Source: own derivation: each of them is tried, and a calibration with it accepted, or likelier, or not.

    Args:
        machine: The machine.
        runs: The runs.
        found: Their calibration, as `calibrate` returns it.
        seed: Seed of the random starts.

    Returns:
        The calibration, with what was found in its verdict or, of an accepted one, in its remarks.
    """
    if found.accepted:
        doubt = _exchanged(machine, runs, found.coarse, seed) or _remounted(machine, runs, found.coarse, seed)
        return _with_remark(found, doubt) if doubt else found

    stated = found.coarse.log_likelihood

    def fits(other: Sequence[CalibrationRun]) -> bool:
        return _accepted_fit(machine, other, seed, likelier_than=stated) is not None

    discs = [disc.id for disc in machine.discs]
    meant = explaining_units(discs, runs, fits) or explaining_senses(runs, fits)
    meant = meant or _exchanged(machine, runs, found.coarse, seed)
    if not meant and (apart := with_own_mountings(runs)) is not None and fits(apart):
        meant = f"it fits with {OWN_MOUNTINGS}"
    return replace(found, verdict=f"{found.verdict}; {meant}") if meant else found


def _with_remark(found: Calibrated, remark: str) -> Calibrated:
    """Return a calibration with one more remark, in its document, too."""
    calibration = found.machine.calibration
    assert calibration is not None
    told = calibration.model_copy(update={"verdict": f"{calibration.verdict}; {remark}"})
    machine = found.machine.model_copy(update={"calibration": told})
    return replace(found, machine=machine, remarks=(*found.remarks, remark))


def _exchanged(machine: Machine, runs: Sequence[CalibrationRun], stated: CoarseFit, seed: int) -> str:
    """Return the exchanges of probes or weights with which accepted fits are far likelier, by a part of the samples."""
    before, better = stated.log_likelihood, []
    for exchange in likely_exchanges(machine, stated.problem, stated.theta):
        fit = _accepted_fit(machine, exchange.runs(runs), seed, likelier_than=before)
        if fit is not None:
            better.append((exchange, fit.log_likelihood - before))
    return exchange_text(better, int(np.count_nonzero(stated.problem.used)))


def _remounted(machine: Machine, runs: Sequence[CalibrationRun], stated: CoarseFit, seed: int) -> str:
    """Return the words for runs that agree far better with more mountings than are stated; empty where they do not."""
    apart = with_own_mountings(runs)
    if apart is None:
        return ""
    fit = _accepted_fit(machine, apart, seed, likelier_than=stated.log_likelihood)
    return "" if fit is None else mounting_text(fit.log_likelihood - stated.log_likelihood)


def _accepted_fit(machine: Machine, runs: Sequence[CalibrationRun], seed: int, *, likelier_than: float) -> CoarseFit | None:
    """Return the fit of a part of the samples of other runs from few starts; None where it is not accepted or ends early."""
    effort = _Effort((MOST_OF_SWEEPS[0],) * 2, STARTS_OF_OTHERS, PASSES_OF_OTHERS, likelier_than)
    try:
        found = _fitted(machine, runs, seed, effort)
    except NO_FIT:
        return None
    return found.coarse if _verdict(found.problem, found.theta, found.converged)[0] else None


def _calibrated(machine: Machine, runs: Sequence[CalibrationRun], remarks: tuple[str, ...], seed: int) -> Calibrated:
    """Return the calibration of runs that were checked, with the remarks on them."""
    found = _fitted(machine, runs, seed, _Effort(MOST_OF_SWEEPS, STARTS, PASSES))
    problem, scatter, theta = found.problem, found.scatter, found.theta
    gains = problem.coordinates.channels.gains(theta)
    doubts = unlikely_gains(gains, {unit for run in runs for unit in run.units if unit})
    remarks = (*found.held, *remarks, *found.first.remarks, *doubts)
    accepted, verdict = _verdict(problem, theta, found.converged)
    wide = widened(problem, scatter, theta, found.sizes)
    calibration = _calibration(
        scatter.applied(problem, wide), theta, runs, wide, speeds=found.speeds, groups=scatter.group
    ).model_copy(update={"verdict": "; ".join((verdict, *remarks))})
    document = calibrated_document(machine, found.machine, calibration)
    unique = bool(found.first.unique)
    return Calibrated(
        document, accepted, verdict, remarks, found.first.starts, unique, found.sizes, found.speeds, found.coarse, doubts
    )


def _fitted(machine: Machine, runs: Sequence[CalibrationRun], seed: int, effort: _Effort) -> _Fitted:
    """Return the fit of all runs. Raises the errors of `calibrate`."""
    few, most = (_gathered(runs, most) for most in effort.of_sweeps)
    fitted, held = with_free_parameters(machine, most.measurement)
    problem, scatter, speeds = _problem(fitted, few)
    sizes = scatter.stated
    problem = scatter.applied(problem, sizes)
    first = best_fit(problem, starts=effort.starts, seed=seed, good=lambda _: True, twice=True, passes=0, begin=best_chains)
    theta, sizes, converged = _settled(problem, scatter, first.fit.theta, sizes, effort)
    coarse = CoarseFit(scatter.applied(problem, sizes), theta)
    if most.mounting.size > few.mounting.size:
        point = problem.coordinates.point(theta)
        problem, scatter, speeds = _problem(fitted, most)
        theta, sizes, converged = _settled(problem, scatter, problem.coordinates.theta(point), sizes, effort)
    problem = scatter.applied(problem, sizes)
    return _Fitted(fitted, held, problem, scatter, theta, sizes, converged, first, speeds, coarse)


def _settled(
    problem: MountedProblem, scatter: ScatterModel, theta: Floats, sizes: ScatterSizes, effort: _Effort
) -> tuple[Floats, ScatterSizes, bool]:
    """Return θ (n,) and the sizes of scatter that no longer change each other, and whether the fit has converged.

    It ends earlier where mountings differ little beside the weights, so that gains rest on these, and where the runs would be
    refused after enough passes, or can no longer become as likely as is asked. What still changes after the last has not
    converged.
    """
    pass_before, reached = None, -math.inf
    for number in range(1, effort.passes + 1):
        stated_square = (scatter.stated.eccentricity / sizes.eccentricity) ** 2
        now = with_scatter_bound(scatter.applied(problem, sizes), theta, stated_square=stated_square)
        theta, converged, _ = descend(now, theta, now.weight(np.abs(now.measurement.phasor), 0.0), STEPS)
        if effort.likelier_than is not None:
            before, reached = reached, log_likelihood(now, theta)
            most = reached + STILL_TO_COME * (reached - before)
            if number >= SOON and (most < effort.likelier_than or now.unexplained_part(theta) > HOPELESS_PART):
                return theta, sizes, False
        found = scatter.estimated(now, theta, sizes)
        ahead = found.ahead(sizes, pass_before)
        if ahead.is_near(sizes):
            return theta, sizes, converged
        pass_before, sizes = (sizes, found), ahead
        if number == USUAL_PASSES and now.unexplained_part(theta) <= LARGE_MOUNTING_PART:
            return theta, sizes, converged
        if number >= ENOUGH and not _verdict(now, theta, converged)[0]:
            return theta, sizes, converged
    return theta, sizes, False


def _gathered(runs: Sequence[CalibrationRun], most: int) -> _Gathered:
    whole = joined([run.measurement for run in runs])
    names = np.array([name for run in runs for name in run.mounting])
    steady = np.concatenate([np.full(run.measurement.speed.size, run.steady) for run in runs])
    kept = whole.usable.any(axis=1) & (whole.speed > 0.0) & _picked(runs, most)
    whole, names, steady = whole.pick(kept), names[kept], steady[kept]
    _, mounting = np.unique(names, return_inverse=True)
    order = np.argsort(mounting, kind="stable")
    silenced = np.where(whole.usable, whole.phasor, 0.0)
    return _Gathered(_sorted(structs.replace(whole, phasor=silenced), order), mounting[order], steady[order])


def _picked(runs: Sequence[CalibrationRun], most: int) -> NDArray[np.bool_]:
    """Return which samples (S,) are fitted: all dwells, and of sweeps hardly more than `most`, each run's at other speeds."""
    total = sum(run.measurement.speed.size for run in runs if not run.steady)
    step = max(1, -(-total // most))
    return np.concatenate(
        [
            np.arange(run.measurement.speed.size) % (1 if run.steady else step) == number % (1 if run.steady else step)
            for number, run in enumerate(runs)
        ]
    )


def _sorted(measurement: Measurement, order: NDArray[np.intp]) -> Measurement:
    return Measurement(
        measurement.speed[order],
        measurement.direction[order],
        measurement.phasor[order],
        measurement.usable[order],
        measurement.scatter[order],
        None if measurement.added is None else measurement.added[order],
    )


def _problem(machine: Machine, gathered: _Gathered) -> tuple[MountedProblem, ScatterModel, Floats]:
    measurement = gathered.measurement
    train = condense(machine, speed=measurement.speed, direction=measurement.direction)
    largest = 0.0 if measurement.added is None else float(np.max(np.abs(measurement.added)))
    problem = MountedProblem(
        train,
        measurement,
        with_free_gains(Coordinates.of(train, unbalance_scale=largest)),
        Noise(floor=0.0),
        np.zeros_like(measurement.usable),
        robust=False,
        mounting=gathered.mounting,
        spread=np.ones(len(machine.discs) + len(machine.probes)),
    )
    speeds, group = _groups(gathered)
    channels = len(machine.probes)
    modelled = error_size(machine.noise, np.abs(measurement.phasor), np.full(measurement.phasor.shape, np.nan))
    base = np.where(gathered.steady[:, None], 1.0, modelled)
    noise = np.r_[_stated_noise(machine, gathered, group, speeds.size * channels), np.ones(channels)]
    pool = np.r_[np.zeros(speeds.size * channels, dtype=np.intp), np.ones(channels, dtype=np.intp)]
    mass = np.array([disc.mass for disc in machine.discs])
    stated = ScatterSizes(noise, STATED_ECCENTRICITY, np.full(channels, STATED_RUN_OUT))
    return problem, ScatterModel(base, group, pool, mass, stated), speeds


def _stated_noise(machine: Machine, gathered: _Gathered, group: NDArray[np.intp], count: int) -> Floats:
    """Return the noise of dwells (count,) [m] before the runs have shown it, in proportion to the document's at their size."""
    amplitude, usable = np.abs(gathered.measurement.phasor), gathered.measurement.usable & gathered.steady[:, None]
    typical = np.full(count, np.nan)
    for one in np.unique(group[usable]):
        typical[one] = np.median(amplitude[usable & (group == one)])
    size = error_size(machine.noise, typical, np.full(count, np.nan))
    shown = size[np.isfinite(size) & (size > 0.0)]
    relative = size / np.median(shown) if shown.size else np.ones(count)
    return np.asarray(STATED_NOISE * np.clip(np.nan_to_num(relative, nan=1.0), 1.0 / UNLIKE, UNLIKE))


def _groups(gathered: _Gathered) -> tuple[Floats, NDArray[np.intp]]:
    """Return the speeds of the dwells (D,) [rad/s], and the group of each phasor (S, m): of sweeps the last ones."""
    speed, steady = gathered.measurement.speed, gathered.steady
    speeds = distinct_speeds(speed[steady]) if steady.any() else np.zeros(0)
    channels = gathered.measurement.phasor.shape[1]
    nearest = np.full(speed.size, speeds.size, dtype=np.intp)
    if speeds.size:
        nearest[steady] = np.argmin(np.abs(np.log(speed[steady, None] / speeds)), axis=1)
    return speeds, nearest[:, None] * channels + np.arange(channels)


def _verdict(problem: MountedProblem, theta: Floats, converged: bool) -> tuple[bool, str]:
    """Return whether a calibration may be used, and why: by what it leaves unexplained."""
    used = problem.used
    model = problem.model(theta)
    amplitude = np.sqrt(np.sum(np.where(used, np.abs(problem.measurement.phasor) ** 2, 0.0), axis=0))
    rest = np.sqrt(np.sum(np.where(used, np.abs(problem.measurement.phasor - model) ** 2, 0.0), axis=0))
    part = np.divide(rest, amplitude, out=np.zeros_like(rest), where=amplitude > 0.0)
    worst = int(np.argmax(part))
    words = f"{100 * float(np.median(part)):.2g} % of the phasors unexplained, at most {100 * part[worst]:.2g} %"
    words += f" ({problem.train.channels[worst]})"
    if part[worst] > LARGEST_ESTIMATED_NOISE:
        unfit = "not converged, " if not converged else "the model does not fit the runs: "
        return False, f"{unfit}{words}; are weights, angles and their sense right?"
    doubt, moved = "", problem.unexplained_part(theta)
    if moved > LARGE_MOUNTING_PART:
        words += f"; mountings differ by {100 * moved:.0f} % of what the trial weights do"
        doubt = judge_weights(problem, theta, part=moved)
        words += f", {doubt or 'by chance: heavier weights would calibrate better'}"
    if doubt:
        light = "heavier weights or more runs are needed; " if doubt in {NOT_SEEN, TOO_FEW} else ""
        words += f"; {light}are weights, angles, their sense and the phase's right?"
    if not converged:
        return False, f"not converged, {words}"
    return (False, f"the model does not fit the runs: {words}") if doubt else (True, f"accepted: {words}")


def _calibration(
    problem: MountedProblem,
    theta: Floats,
    runs: Sequence[CalibrationRun],
    sizes: ScatterSizes,
    *,
    speeds: Floats,
    groups: NDArray[np.intp],
) -> Calibration:
    coordinates, train = problem.coordinates, problem.train
    information = information_of_means(problem, theta)
    covariance = np.linalg.inv(information + coordinates.prior.precision) * np.outer(coordinates.unit, coordinates.unit)
    covariance = (covariance + covariance.T) / 2.0
    unbalances = [f"{one.name}.{part}" for one in train.unknowns.unbalances for part in ("real", "imaginary")]
    discs = [
        MountingSpread(name=one.name, rms=rms) for one, rms in zip(train.unknowns.unbalances, problem.spread, strict=False)
    ]
    chains = [
        MountingSpread(name=f"probe.{channel}.run_out", rms=rms)
        for channel, rms in zip(train.channels, sizes.run_out, strict=True)
    ]
    rpm = [*(rad_per_s_to_rpm(speed) for speed in speeds), None]
    shown = set(np.unique(groups).tolist())
    scatter = [
        ChannelScatter(channel=channel, rpm=at, rms=float(sizes.noise[len(train.channels) * row + column]))
        for row, at in enumerate(rpm)
        for column, channel in enumerate(train.channels)
        if len(train.channels) * row + column in shown
    ]
    return Calibration(
        parameters=coordinates.names,
        values=tuple(map(float, coordinates.point(theta))),
        covariance=tuple(tuple(map(float, row)) for row in covariance),
        unbalances=tuple(name for name in unbalances if name in coordinates.names),
        mounting=tuple(discs + chains),
        scatter=tuple(scatter),
        runs=tuple(
            CalibrationRunRecord(
                name=run.name, samples=run.measurement.speed.size, mountings=len(set(run.mounting)), sha256=run.sha256
            )
            for run in runs
        ),
    )
