"""Identification of a machine: from measured phasors to estimates with uncertainties, or to the reason why there are none."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.fit.calibrated_scatter import with_calibrated_scatter
from estimator.fit.channel_sensitivity import ChannelEffects, channel_effects
from estimator.fit.coupling_run_outs import RunOutFit, fit_with_run_outs
from estimator.fit.estimates import Estimate, determined, estimates
from estimator.fit.form_discrepancy import FormVerdict, judge_form, needs_form
from estimator.fit.gap_checks import with_gaps
from estimator.fit.goodness_of_fit import Verdict, VerdictRemark, judge, remark
from estimator.fit.identifiability import Reasons, reasons_for
from estimator.fit.maximum_likelihood import STAGE_MISFITS
from estimator.fit.multistart import BestFit, FitFailed, best_fit
from estimator.fit.nuisance_parameters import counted_by_effect, excessive_deviations
from estimator.fit.omitted_warming import viscosity_trend
from estimator.fit.physical_limits import Limits, limits_for, without_growing_modes
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.fit_problem import FitProblem, FitResult, best_excitations
from estimator.fit.profile_likelihood import flat_coordinates
from estimator.machine.bearings_on_films import bearings_on_films
from estimator.machine.document import Machine
from estimator.machine.document_size import FEWEST_SAMPLES, document_size
from estimator.machine.rules import Noise
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import CondensedTrain, condense
from estimator.units import rad_per_s_to_rpm, rpm_to_rad_per_s

LARGEST_SAMPLE_COUNT = 5000
"""Most samples that one fit uses; more are thinned out."""
LARGEST_AMPLITUDE = 1e6
"""Amplitude [m] above which the data are refused as a slip that arithmetic may not survive."""
LARGEST_ECCENTRICITY = 0.05
"""Eccentricity [m] of a disc's centre of mass above which an unbalance is most likely a slip of the units."""
SCALE_PASSES = 10
"""Most searches for the unbalances' scale; each can find one a thousand times larger."""
LARGEST_CONDITION = 1e5
"""Condition number above which intervals are checked against the likelihood's profile [-]; full run-downs have some
thousands."""
FEW_SAMPLES = 40
"""Number of samples up to which starts go on until the best optimum has been reached twice: with few there may be several."""
SAME_SPEED = 1e-3
"""Relative difference of speeds that count as one [-]: samples there repeat each other."""
THINNING_BINS = 200
"""Number of pieces of the speed range in which samples are thinned out."""


class NotEnoughData(ValueError):
    """Raised when the data cannot determine the unknowns, whatever their values."""


@dataclass(frozen=True)
class Options:
    """Options of an identification.

    Attributes:
        starts: Most starts tried before a misfit is reported.
        seed: Seed of the random starts.
        robust: Whether phasors that cannot be noise are left out.
    """

    starts: int = 10
    seed: int = 0
    robust: bool = True


@dataclass(frozen=True)
class Identification:
    """Outcome of one fit, over N coordinates.

    Attributes:
        estimates: One estimate per parameter name.
        coordinates: Names of the real fit coordinates.
        covariance: Covariance (N, N) of the coordinates, direct terms as logarithms [SI² or 1].
        point: Values (N,) of the coordinates, also of those that are not estimable: for computing on, never for showing [SI or
            1].
        chi_square: χ² of the data [-].
        degrees_of_freedom: Degrees of freedom of χ².
        accepted: Whether the fit passed the χ² test.
        verdict: The verdict in words.
        condition_number: Condition number of the correlation form of the information matrix [-].
        starts: Number of starts tried.
        iterations: Number of steps tried.
        samples: Number of samples used in the fit.
        speed_minimum: Lowest speed used [rad/s].
        speed_maximum: Highest speed used [rad/s].
        noise: Noise model as stated or estimated.
        outliers: Number of phasors left out because no noise explains them, by channel.
        channel_effects: Effects of errors of single channels on the fit; None where several fits are combined.
    """

    estimates: tuple[Estimate, ...]
    coordinates: tuple[str, ...]
    covariance: Floats
    point: Floats
    chi_square: float
    degrees_of_freedom: int
    accepted: bool
    verdict: str
    condition_number: float
    starts: int
    iterations: int
    samples: int
    speed_minimum: float
    speed_maximum: float
    noise: Noise
    outliers: dict[str, int]
    channel_effects: ChannelEffects | None = None

    @property
    def correlation(self) -> Floats:
        """Return the correlation coefficients (N, N) between the errors of the coordinates [-]."""
        size = np.sqrt(np.diag(self.covariance))
        return np.asarray(self.covariance / np.outer(size, size))

    def estimate(self, name: str) -> Estimate:
        """Return the estimate of a name.

        Args:
            name: Name of the parameter.

        Returns:
            Its estimate.

        Raises:
            KeyError: There is no estimate of that name.
        """
        for one in self.estimates:
            if one.name == name:
                return one
        raise KeyError(name)


def identify(
    machine: Machine, measurement: Measurement, options: Options | None = None, *, beginning: Floats | None = None
) -> Identification:
    """Identify every bearing and coupling coefficient and every disc's unbalance of a machine.

    Maximum likelihood under independent Gaussian errors of the size that the measurement or the machine's noise model states,
    by the method of Marquardt (1963, doi:10.1137/0111030). Starts from the nominal values; where the χ² test fails, random
    starts around them follow.

    Args:
        machine: The machine.
        measurement: Its measured phasors.
        options: Options of the fit; None for the usual ones.
        beginning: The `point` (N,) of an earlier identification of this machine to start from, in place of the nominal values
            [SI or 1].

    Returns:
        The identification.

    Raises:
        NotEnoughData: There are fewer measured numbers than unknowns.
        FitFailed: No start leads anywhere.
        SingularCondensation: The train cannot be condensed at a speed.
        ValueError: The channels are not the machine's.
    """
    measurement = _on_films(machine, _without_empty_samples(measurement))
    measurement = with_calibrated_scatter(machine, _thinned(measurement, most=most_samples(machine)))
    _require_enough(machine, measurement)
    train = condense(machine, speed=measurement.speed, direction=measurement.direction)
    found = identify_train(
        train,
        measurement,
        noise=machine.noise,
        options=options,
        reasons=reasons_for(machine),
        limits=limits_for(machine),
        beginning=beginning,
    )
    return replace(found, verdict=found.verdict + _eccentric(machine, found))


def expected_point(machine: Machine, measurement: Measurement) -> tuple[tuple[str, ...], Floats]:
    """Return all coordinates before any fit: the document's values, with the excitations that explain the data best.

    Args:
        machine: The machine.
        measurement: Its measured phasors.

    Returns:
        Names of the N coordinates and their values (N,) [SI or 1].

    Raises:
        NotEnoughData: No phasor is usable, or every usable one is zero.
        SingularCondensation: The train cannot be condensed at a speed.
        ValueError: The channels are not the machine's.
    """
    problem = fit_problem(machine, _without_empty_samples(measurement), robust=False)
    weight = problem.weight(problem.first_amplitude, STAGE_MISFITS[0])
    coordinates = problem.coordinates
    return coordinates.names, coordinates.point(best_excitations(problem, coordinates.centre, weight))


def fit_problem(machine: Machine, measurement: Measurement, *, robust: bool) -> FitProblem:
    """Build the problem of a fit, without solving it.

    Args:
        machine: The machine.
        measurement: Its measured phasors, each sample with a usable one.
        robust: Whether phasors that cannot be noise are left out.

    Returns:
        The problem.

    Raises:
        NotEnoughData: No phasor is usable, or every usable one is zero.
        SingularCondensation: The train cannot be condensed at a speed.
        ValueError: The channels are not the machine's.
    """
    measurement = _thinned(measurement, most=most_samples(machine))
    _require_enough(machine, measurement)
    train = condense(machine, speed=measurement.speed, direction=measurement.direction)
    return _problem(train, measurement, machine.noise, robust=robust)


def expected_phasors(machine: Machine, measurement: Measurement, point: Floats) -> Complexes:
    """Compute the phasors that the channels should show in the samples of a measurement.

    They are those of each sample's sense of rotation, with trial weights, and through the channels' gains with their run-outs.

    Args:
        machine: The machine.
        measurement: S samples of m channels.
        point: The `point` (N,) of an identification [SI or 1].

    Returns:
        Phasors (S, m) [m].
    """
    train = condense(machine, speed=measurement.speed, direction=measurement.direction)
    coordinates = Coordinates.of(train, unbalance_scale=1.0)
    problem = FitProblem(train, measurement, coordinates, machine.noise, np.zeros_like(measurement.usable))
    return problem.model(coordinates.theta(point))


def identify_train(
    train: CondensedTrain,
    measurement: Measurement,
    *,
    noise: Noise,
    options: Options | None = None,
    reasons: Reasons | None = None,
    limits: Limits | None = None,
    beginning: Floats | None = None,
) -> Identification:
    """Identify a train that is condensed at the speeds of the measurement; `identify` does this for a machine.

    Args:
        train: The condensed train.
        measurement: Its measured phasors.
        noise: Noise model.
        options: Options of the fit; None for the usual ones.
        reasons: Function that says in words why a parameter is not estimable.
        limits: Function that looks for what no machine can have; None to accept it.
        beginning: The `point` (N,) of an earlier identification to start from [SI or 1].

    Returns:
        The identification.

    Raises:
        NotEnoughData: There are fewer measured numbers than unknowns, or every usable phasor is zero.
        FitFailed: No start leads anywhere.
        SingularCondensation: The train cannot be condensed at a speed.
    """
    options = options or Options()
    coordinates = Coordinates.of(train, unbalance_scale=1.0)
    by_prior = counted_by_effect(coordinates)
    by_prior[coordinates.scale_place] = True
    by_prior[coordinates.channels.places] = True
    free = coordinates.size - int(np.count_nonzero(by_prior))
    _require_more_than(free, measurement)
    problem = _problem(train, measurement, noise, robust=options.robust)
    begin = None if beginning is None else problem.coordinates.theta(beginning)

    best = _best_first(problem, begin, options)
    other = None
    if not judge(problem, best.fit).accepted:
        other = fit_with_run_outs(problem, best.fit.theta if begin is None else begin, near=begin is not None)
        if other is None and begin is not None and options.starts > 1:
            best = _best_of(problem, begin, options, starts=options.starts)
    joined = with_gaps(problem, best.fit)
    found = _result(joined.problem, replace(best, fit=joined.found), joined.remarks, reasons, limits)
    return found if other is None or found.accepted else _explained_by_run_outs(problem, found, other)


def _best_first(problem: FitProblem, begin: Floats | None, options: Options) -> BestFit:
    """Return the best fit of all starts, or of a beginning alone where it leads anywhere. Raises FitFailed."""
    if begin is None or options.starts == 1:
        return _best_of(problem, begin, options, starts=options.starts)
    try:
        return _best_of(problem, begin, options, starts=1)
    except FitFailed:
        return _best_of(problem, begin, options, starts=options.starts)


def _best_of(problem: FitProblem, begin: Floats | None, options: Options, *, starts: int) -> BestFit:
    few = problem.measurement.speed.size <= FEW_SAMPLES
    return best_fit(
        problem,
        starts=starts,
        seed=options.seed,
        good=lambda found: judge(problem, found).accepted,
        beginning=begin,
        twice=few and begin is None and not problem.coordinates.calibrated_places,
    )


def _require_more_than(free: int, measurement: Measurement) -> None:
    """Check that more independent numbers were measured than unknowns are free. Raises NotEnoughData."""
    count = _independent_numbers(measurement)
    if count <= free:
        raise NotEnoughData(
            f"{count} measured numbers cannot determine {free} unknowns: more speeds or more channels are needed "
            "(samples at one speed repeat each other)"
        )


def _explained_by_run_outs(problem: FitProblem, found: Identification, other: RunOutFit) -> Identification:
    """Return a refused fit with what one that was accepted with run-outs of couplings says of the machine."""
    return replace(
        found,
        point=other.point,
        covariance=other.covariance,
        chi_square=other.refused_chi_square,
        verdict=f"{found.verdict}; {other.words}",
        outliers=_counted(problem, other.outlier),
        channel_effects=other.effects,
    )


def _counted(problem: FitProblem, outlier: NDArray[np.bool_]) -> dict[str, int]:
    """Return the number of phasors left out by channel."""
    counts = np.count_nonzero(outlier, axis=0)
    return {channel: int(count) for channel, count in zip(problem.train.channels, counts, strict=True) if count}


def _eccentric(machine: Machine, found: Identification) -> str:
    """Describe unbalances that no disc can have."""
    for disc in machine.discs:
        one = found.estimate(f"disc.{disc.id}.unbalance")
        if one.value is not None and one.imaginary is not None:
            eccentricity = abs(complex(one.value, one.imaginary)) / disc.mass
            if eccentricity > LARGEST_ECCENTRICITY:
                return f"; disc {disc.id} would be {1e3 * eccentricity:.0f} mm eccentric: are the amplitudes' units right?"
    return ""


def _independent_numbers(measurement: Measurement) -> int:
    """Count the real numbers that were measured, those at the same speed, sense of rotation and trial weight once."""
    bins = np.round(np.log(measurement.speed) / SAME_SPEED)
    keys = [bins, measurement.direction]
    if measurement.added is not None:
        keys += [*measurement.added.real.T, *measurement.added.imag.T]
    _, place = np.unique(np.stack(keys, axis=1), axis=0, return_inverse=True)
    seen = np.zeros((place.max() + 1, measurement.phasor.shape[1]), dtype=bool)
    np.logical_or.at(seen, place.reshape(-1), measurement.usable)
    return 2 * int(np.count_nonzero(seen))


def _without_empty_samples(measurement: Measurement) -> Measurement:
    return measurement.pick(np.asarray(measurement.usable.any(axis=1)))


def _on_films(machine: Machine, measurement: Measurement) -> Measurement:
    """Pick the samples at speeds at which the films of the document carry their journals. Raises NotEnoughData."""
    slowest = rpm_to_rad_per_s(max((one.film.valid_above_rpm for one in bearings_on_films(machine.bearings)), default=0.0))
    found = measurement.pick(np.asarray(measurement.speed >= slowest))
    if found.speed.size == 0 < measurement.speed.size:
        raise NotEnoughData(f"no sample is above valid_above_rpm of a film, {rad_per_s_to_rpm(slowest):.0f} r/min")
    return found


def most_samples(machine: Machine) -> int:
    """Return the most samples of a machine that one fit uses: fewer of a long train.

    Args:
        machine: The machine.

    Returns:
        Number of samples.
    """
    return min(LARGEST_SAMPLE_COUNT, max(FEWEST_SAMPLES, document_size(machine).samples))


def _thinned(measurement: Measurement, *, most: int) -> Measurement:
    """Pick at most so many samples, taking away where speeds are most crowded: hours at speed add little."""
    if measurement.speed.size <= most:
        return measurement
    edges = np.linspace(measurement.speed.min(), measurement.speed.max(), THINNING_BINS + 1)
    place = np.clip(np.searchsorted(edges, measurement.speed, side="right") - 1, 0, THINNING_BINS - 1)
    held = np.bincount(place, minlength=THINNING_BINS)
    each = max(cap for cap in range(1, held.max() + 1) if cap == 1 or np.minimum(held, cap).sum() <= most)
    keep = np.zeros(place.size, dtype=bool)
    for crowd in range(THINNING_BINS):
        members = np.flatnonzero(place == crowd)
        keep[members[np.linspace(0, members.size - 1, min(each, members.size)).round().astype(int)]] = True
    return measurement.pick(keep)


def _require_enough(machine: Machine, measurement: Measurement) -> None:
    if measurement.phasor.shape[1] != len(machine.probes):
        raise ValueError(
            f"the measurement has {measurement.phasor.shape[1]} channels, machine '{machine.id}' has {len(machine.probes)}"
        )
    if measurement.added is not None and measurement.added.shape[1] != len(machine.discs):
        raise ValueError(
            f"added unbalances are given for {measurement.added.shape[1]} discs, "
            f"machine '{machine.id}' has {len(machine.discs)}"
        )
    if measurement.speed.size == 0:
        raise NotEnoughData("no sample has a usable channel")
    largest = float(np.max(np.abs(measurement.phasor), where=measurement.usable, initial=0.0))
    if largest > LARGEST_AMPLITUDE:
        raise ValueError(f"an amplitude of {largest:.3g} m: no shaft moves so far; are the units right?")


def _problem(train: CondensedTrain, measurement: Measurement, noise: Noise, *, robust: bool) -> FitProblem:
    """Build the fit problem, with the unbalances' scale taken from the data at the nominal coefficients."""
    # Unusable phasors become zero, so that arithmetic on whole arrays stays finite.
    silenced = replace(measurement, phasor=np.where(measurement.usable, measurement.phasor, 0.0))
    coordinates = Coordinates.of(train, unbalance_scale=1.0)
    problem = FitProblem(train, silenced, coordinates, noise, np.zeros_like(measurement.usable), robust)
    amplitude = problem.first_amplitude
    if not np.any(amplitude > 0.0):
        raise NotEnoughData("every usable phasor is zero: there is no response to identify from")
    scale = 1.0
    for _ in range(SCALE_PASSES):
        # The prior of a first scale that is far too small holds the unbalances back, so look again.
        theta = best_excitations(problem, coordinates.centre, problem.weight(amplitude, STAGE_MISFITS[0]))
        before = scale
        scale = float(np.max(np.abs(coordinates.excitations(theta)[: len(train.unknowns.unbalances)]), initial=0.0)) or 1.0
        coordinates = Coordinates.of(train, unbalance_scale=scale)
        problem = replace(problem, coordinates=coordinates)
        if scale < 2.0 * before:
            break
    return problem


def _result(
    problem: FitProblem, best: BestFit, of_gaps: tuple[str, ...], reasons: Reasons | None, limits: Limits | None
) -> Identification:
    coordinates, found = problem.coordinates, best.fit
    information = found.information + coordinates.prior.precision
    covariance = np.linalg.inv(information)
    covariance = (covariance + covariance.T) / 2
    size = np.sqrt(np.diag(information))
    condition = float(np.linalg.cond(information / np.outer(size, size)))
    verdict = judge(problem, found)
    beside = VerdictRemark()
    doubtful, form_alone = frozenset[int](), frozenset[int]()
    if verdict.accepted:
        found_form = _form_verdict(problem, found, covariance, condition)
        found, verdict = _possible(problem, found, found_form.applied(verdict), limits)
        form_alone = _determined(coordinates, covariance) - _determined(coordinates, found_form.covariance)
        covariance = found_form.covariance
        beside = remark(problem, found)
        covariance = covariance * beside.inflation
        if verdict.accepted and condition > LARGEST_CONDITION and not coordinates.models:
            doubtful = flat_coordinates(problem, found, covariance, sorted(_determined(coordinates, covariance)))
    speed = problem.measurement.speed
    error = np.sqrt(np.diag(covariance))
    why = None if reasons is None else reasons(problem, found, covariance)
    if why is not None and form_alone:
        why = _with_form_alone(why, frozenset(coordinates.names[place] for place in form_alone))
    return Identification(
        estimates=estimates(problem.train, coordinates, found.theta, error, why, doubtful),
        coordinates=coordinates.names,
        covariance=covariance * np.outer(coordinates.unit, coordinates.unit),
        point=coordinates.point(found.theta),
        chi_square=found.chi_square,
        degrees_of_freedom=verdict.degrees_of_freedom,
        accepted=verdict.accepted,
        verdict="; ".join((verdict.words + beside.words, *best.remarks, *of_gaps)),
        condition_number=condition,
        starts=best.starts,
        iterations=best.iterations,
        samples=int(speed.size),
        speed_minimum=float(speed.min()),
        speed_maximum=float(speed.max()),
        noise=found.noise,
        outliers=_counted(problem, found.outlier),
        channel_effects=channel_effects(problem, found, inflation=beside.inflation),
    )


def _form_verdict(problem: FitProblem, found: FitResult, covariance: Floats, condition: float) -> FormVerdict:
    """Return the verdict on how coefficients follow the speed: by assumed forms, and by films with their deviations."""
    excess = excessive_deviations(problem, found, covariance)
    trend = None if excess else viscosity_trend(problem, found, covariance)
    if trend is not None:
        excess = trend.words
    if excess or not needs_form(problem):
        return FormVerdict(covariance, excess)
    return judge_form(problem, found, covariance, condition)


def _determined(coordinates: Coordinates, covariance: Floats) -> frozenset[int]:
    return frozenset(determined(coordinates, np.sqrt(np.diag(covariance))))


def _with_form_alone(why: Callable[[str], str], names: frozenset[str]) -> Callable[[str], str]:
    """Return the function that says why a coordinate is left open, with those that the form over speed alone determines."""

    def reason(name: str) -> str:
        if name in names:
            return "only the form over speed that the document assumes determines it, and no data show whether that is true"
        return why(name)

    return reason


def _possible(problem: FitProblem, found: FitResult, verdict: Verdict, limits: Limits | None) -> tuple[FitResult, Verdict]:
    """Return an accepted fit without growing modes, or the verdict that it has one."""
    if limits is None or not verdict.accepted:
        return found, verdict
    moved, growing = without_growing_modes(limits(problem), problem, found)
    if growing is None:
        return moved, verdict
    return found, verdict.refused(growing.words)
