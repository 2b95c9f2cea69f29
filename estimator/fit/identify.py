"""Identification of a machine: from measured phasors to estimates with uncertainties, or to the reason why there are none."""

from collections.abc import Callable

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from estimator.arrays import Floats
from estimator.fit.calibrated_scatter import with_calibrated_scatter
from estimator.fit.changed_coefficients import (
    CLEAR,
    changed_words,
    freed_criterion,
    without_coefficients_of_calibration,
    without_gains_of_calibration,
)
from estimator.fit.conclusion import conclude, outliers_by_channel
from estimator.fit.far_moved_bearings import moved_far
from estimator.fit.fit_samples import (
    NotEnoughData,
    carried_by_films,
    most_samples,
    require_more_than,
    require_usable,
    thinned,
    without_empty_samples,
)
from estimator.fit.gap_checks import with_gaps
from estimator.fit.identification import Identification, Options
from estimator.fit.omitted_errors.coupling_run_outs import fit_with_run_outs
from estimator.fit.omitted_errors.explained_fit import ExplainedFit
from estimator.fit.omitted_errors.faulty_channel import fit_with_channel_errors, fit_with_errors_of_two
from estimator.fit.omitted_errors.suspected_errors import suspected_errors
from estimator.fit.optimisation.multistart import BestFit, FitFailed, best_fit
from estimator.fit.optimisation.nuisance_parameters import counted_by_effect, deviates_too_far
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.problem_setup import condensed_problem
from estimator.fit.validation.calibration_conflict import calibration_conflict
from estimator.fit.validation.form_discrepancy import needs_form
from estimator.fit.validation.goodness_of_fit import is_unfinished, judge
from estimator.fit.validation.identifiability import Reasons, reasons_for
from estimator.fit.validation.physical_limits import LimitsFunction, limits_for
from estimator.machine.document import Machine
from estimator.machine.rules import Noise
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import CondensedTrain, condense

LARGEST_ECCENTRICITY = 0.05
"""Eccentricity [m] of a disc's centre of mass above which an unbalance is most likely a slip of the units."""
FEW_SAMPLES = 40
"""Number of samples up to which starts go on until the best optimum has been reached twice: with few there may be several."""


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
    measurement = carried_by_films(machine, without_empty_samples(measurement))
    measurement = with_calibrated_scatter(machine, thinned(measurement, most=most_samples(machine)))
    require_usable(machine, measurement)
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


def identify_train(
    train: CondensedTrain,
    measurement: Measurement,
    *,
    noise: Noise,
    options: Options | None = None,
    reasons: Reasons | None = None,
    limits: LimitsFunction | None = None,
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

    def fitted(train: CondensedTrain, beginning: Floats | None) -> _TrainFit:
        return _fitted(train, measurement, noise, options, reasons, limits, beginning)

    one = fitted(train, beginning)
    if one.found.accepted:
        return one.found
    changed = _changed_since_calibration(one, fitted)
    if changed is not None:
        return changed
    return one.found if one.other is None else _explained(one.problem, one.found, one.other)


class _TrainFit(Struct, frozen=True, eq=False):
    """Fit of a train: its problem, the best of its starts, what is concluded, and one with errors of channels or couplings."""

    problem: FitProblem
    best: BestFit
    found: Identification
    other: ExplainedFit | None

    def criterion(self, *, held: int) -> float:
        """Return the information criterion beside fits that a calibration of so many parameters holds otherwise [-]."""
        return freed_criterion(self.problem, self.best.fit, held=held)


def _fitted(
    train: CondensedTrain,
    measurement: Measurement,
    noise: Noise,
    options: Options,
    reasons: Reasons | None,
    limits: LimitsFunction | None,
    beginning: Floats | None,
) -> _TrainFit:
    """Fit a train as `identify_train` does, whatever may have changed since its calibration. Raises as it does."""
    coordinates = Coordinates.of(train, unbalance_scale=1.0)
    by_prior = counted_by_effect(coordinates)
    by_prior[coordinates.scale_place] = True
    by_prior[coordinates.channels.places] = True
    free = coordinates.size - int(np.count_nonzero(by_prior))
    require_more_than(free, measurement)
    problem = condensed_problem(train, measurement, noise, robust=options.robust)
    begin = None if beginning is None else problem.coordinates.theta(beginning)

    best = _best_first(problem, begin, options)
    fits = judge(problem, best.fit).accepted
    if fits and deviates_too_far(problem, best.fit):
        best = replace(best, fit=moved_far(problem, best.fit, begin))
        fits = judge(problem, best.fit).accepted
    other, finished = None, not is_unfinished(problem, best.fit)
    if options.explain and finished and (not fits or deviates_too_far(problem, best.fit)):
        other = _with_suspected_errors(problem, best.fit, begin)
    if not fits and other is None and begin is not None and options.starts > 1:
        best = _best_of(problem, begin, options, starts=options.starts)
    joined = with_gaps(problem, best.fit)
    found = conclude(joined.problem, replace(best, fit=joined.found), joined.remarks, reasons, limits, options.open_errors)
    return _TrainFit(problem, best, found, other)


def _with_suspected_errors(problem: FitProblem, refused: FitResult, begin: Floats | None) -> ExplainedFit | None:
    """Return an accepted fit with errors of channels or of couplings, those first that explain more; None for none."""
    suspects = suspected_errors(problem, refused)

    def of_channel() -> ExplainedFit | None:
        return fit_with_channel_errors(problem, refused, begin, suspects)

    def of_couplings() -> ExplainedFit | None:
        return fit_with_run_outs(problem, refused.theta if begin is None else begin, near=begin is not None)

    one = of_couplings() or of_channel() if suspects.couplings_first else of_channel() or of_couplings()
    if one is not None or begin is None:  # of a machine that was never fitted the document is more likely wrong
        return one
    return fit_with_errors_of_two(problem, refused, begin, suspects)


def _changed_since_calibration(
    refused: _TrainFit, fitted: Callable[[CondensedTrain, Floats | None], _TrainFit]
) -> Identification | None:
    """Return a fit of a run that contradicts its calibration without the coefficients of this.

    None where it is refused, where gains that changed explain the run as well, or no calibration is contradicted.
    """
    conflict = calibration_conflict(refused.problem, refused.best.fit)
    if conflict is None:
        return None
    train, begin = refused.problem.train, refused.found.point
    held = len(refused.problem.coordinates.calibrated_places)
    try:
        freed = fitted(without_coefficients_of_calibration(train), begin)
        if not freed.found.accepted:
            return None
        with_gains = fitted(without_gains_of_calibration(train), begin)
    except (NotEnoughData, FitFailed):  # what the calibration held is more than the run can tell
        return None
    clear = freed.criterion(held=held) < with_gains.criterion(held=held) - CLEAR
    if with_gains.found.accepted and not clear:
        return None
    return replace(freed.found, verdict=f"{freed.found.verdict}; {changed_words(conflict)}")


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
        unfinished=lambda found: is_unfinished(problem, found),
        beginning=begin,
        twice=few and begin is None and not problem.coordinates.calibrated_places,
        held_first=needs_form(problem),
    )


def _explained(problem: FitProblem, found: Identification, other: ExplainedFit) -> Identification:
    """Return a refused fit with what one that was accepted with errors of a channel or couplings says of the machine."""
    return replace(
        found,
        point=other.point,
        covariance=other.covariance,
        doubted_forces=(),
        chi_square=other.refused_chi_square,
        degrees_of_freedom=other.degrees_of_freedom,
        verdict=f"{found.verdict}; {other.words}",
        outliers=outliers_by_channel(problem, other.outlier),
        channel_effects=other.effects,
    )


def _eccentric(machine: Machine, found: Identification) -> str:
    """Describe unbalances that no disc can have."""
    for disc in machine.discs:
        one = found.estimate(f"disc.{disc.id}.unbalance")
        if one.value is not None and one.imaginary is not None:
            eccentricity = abs(complex(one.value, one.imaginary)) / disc.mass
            if eccentricity > LARGEST_ECCENTRICITY:
                return f"; disc {disc.id} would be {1e3 * eccentricity:.0f} mm eccentric: are the amplitudes' units right?"
    return ""
