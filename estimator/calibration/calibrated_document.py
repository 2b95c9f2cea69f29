"""Documents of calibrated machines: made from a calibration, and compared without it."""

from estimator.machine.calibration import MOST_DRIFT, Calibration
from estimator.machine.document import Machine, parse_machine


def calibrated_document(machine: Machine, fitted: Machine, calibration: Calibration) -> Machine:
    """Return a document with a calibration, and with the spreads without which its parameters would not be fitted.

    Args:
        machine: The machine.
        fitted: The same train as the calibration has fitted it, or as it was calibrated before.
        calibration: The calibration.

    Returns:
        The calibrated machine.
    """
    rms = [one.rms for one in calibration.scatter if one.rpm is not None]
    noise = machine.noise.model_copy(update={"floor": min([machine.noise.floor, *rms])})
    whole = machine.model_copy(
        update={"probes": fitted.probes, "materials": fitted.materials, "noise": noise, "calibration": calibration}
    )
    return parse_machine(whole.model_dump(mode="json", exclude_unset=False))


def with_gain_drift(machine: Machine, gain_drift: float) -> Machine:
    """Return a calibrated machine whose channels' gains may have drifted by the time of a later run.

    Args:
        machine: The machine with its calibration; one without stays as it is.
        gain_drift: Rms of the complex change of each gain, in parts of it [-].

    Returns:
        The machine.

    Raises:
        ValueError: The drift is below zero or above `MOST_DRIFT`.
    """
    require_gain_drift(gain_drift)
    if machine.calibration is None:
        return machine
    return machine.model_copy(update={"calibration": machine.calibration.model_copy(update={"gain_drift": gain_drift})})


def require_gain_drift(gain_drift: float) -> None:
    """Check that a drift of gains is one that a calibration can allow for.

    Args:
        gain_drift: Rms of the complex change of each gain, in parts of it [-].

    Raises:
        ValueError: The drift is below zero or above `MOST_DRIFT`.
    """
    if not 0.0 <= gain_drift <= MOST_DRIFT:
        raise ValueError(f"gain_drift is {gain_drift:g}: it lies between 0 and {MOST_DRIFT:g}, such as 0.02 for 2 %")


def is_the_same_but_for_calibrations(machine: Machine, other: Machine) -> bool:
    """Check whether two documents describe the same train, whether it is calibrated or not.

    Args:
        machine: The one document.
        other: The other document.

    Returns:
        Whether they do; spreads and noise, which a calibration changes, may differ.
    """
    return _bare(machine).is_the_same_train_as(_bare(other))


def _bare(machine: Machine) -> Machine:
    probes = tuple(probe.model_copy(update={"gain_spread": 0.0, "run_out_spread": 0.0}) for probe in machine.probes)
    materials = {name: one.model_copy(update={"young_modulus_spread": 0.0}) for name, one in machine.materials.items()}
    noise = machine.noise.model_copy(update={"floor": 0.0})
    return machine.model_copy(update={"probes": probes, "materials": materials, "noise": noise, "calibration": None})
