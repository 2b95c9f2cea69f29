"""Derived quantities: closed forms of a rigid rotor, differences of the whole train, names, and reasons."""

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.fit.estimates import CONFIDENCE_95
from estimator.fit.identification import Identification
from estimator.machine.document import Machine, parse_machine
from estimator.machine.rules import Noise, Operation
from estimator.phasors.harmonic_ratio import Orders
from estimator.units import rpm_to_rad_per_s
from estimator.updated_model.amplification import peaks_with_errors
from estimator.updated_model.coupling_loads import coupling_forces
from estimator.updated_model.critical_speed_tracking import followed_crossings
from estimator.updated_model.derived_quantities import Derived, derived_quantities, model_quantities
from estimator.updated_model.model import UpdatedModel, expected_model
from estimator.updated_model.uncertainty import standard_errors
from tests.estimator.models import model_of, rich_model
from tests.estimator.rigid_rotor import MASS, STIFFNESS, rigid_rotor
from tests.estimator.trains import chapter_3
from tests.film_plant.documents import film_document
from tests.film_plant.plants import motor_compressor_plant

TOP = 250.0
"""Highest speed of the made-up identifications [rad/s]."""


def outcome(model: UpdatedModel) -> Identification:
    """An identification that leads to a model."""
    return Identification(
        estimates=(),
        coordinates=model.coordinates,
        covariance=model.covariance,
        point=model.values,
        accepted=True,
        verdict="",
        speed_minimum=10.0,
        speed_maximum=TOP,
        noise=Noise(),
        outliers={},
        chi_square=1.0,
        degrees_of_freedom=1,
        condition_number=1.0,
        starts=1,
        iterations=1,
        samples=1,
    )


def found(model: UpdatedModel, *runs: Orders) -> dict[str, Derived]:
    return {one.name: one for one in derived_quantities(model.machine, outcome(model), runs)}


def bouncing(*, error: float) -> UpdatedModel:
    """x and y bounce of a rigid rotor at 200 and 240 rad/s, damped by 5 % and 4.17 %; each stiffness uncertain by itself."""
    machine = rigid_rotor(diametral=2e-3, polar=1e-4, damping=50.0)
    stiff = tuple(one.model_copy(update={"kyy": 1.44 * STIFFNESS}) for one in machine.bearings)
    model = expected_model(machine.model_copy(update={"bearings": stiff}))
    uncertain = [name.endswith(("kxx", "kyy")) for name in model.coordinates]
    values = model.values + np.where([name == "disc.D.unbalance.real" for name in model.coordinates], 1e-3, 0.0)
    return replace(model, values=values, covariance=np.diag(np.where(uncertain, error**2, 0.0)))


def half_width(one: Derived) -> float:
    assert one.lower is not None
    assert one.upper is not None
    return (one.upper - one.lower) / 2


def test_critical_speeds_of_a_rigid_rotor() -> None:
    """Ω² = 2k/m = 2 k₁ + 2 k₂ over m: of two stiffnesses uncertain by ε each, Ω is by ε/√8; λ = -c/m ± j√(Ω² - (c/m)²)."""
    error = 0.02
    quantities = found(bouncing(error=error))
    decay = 50.0 / MASS
    natural = np.sqrt(2 * STIFFNESS / MASS * np.array([1.0, 1.44]))
    for number, frequency in enumerate(natural, start=1):
        damped = np.sqrt(frequency**2 - decay**2)
        speed, damping = quantities[f"critical_speed.{number}"], quantities[f"damping_ratio.{number}"]
        assert (speed.unit, damping.unit) == ("rad/s", "1")
        assert speed.value == pytest.approx(damped, rel=1e-4)
        assert damping.value == pytest.approx(decay / frequency, rel=1e-4)
        slope = frequency**2 / damped  # by ln Ω
        assert half_width(speed) == pytest.approx(CONFIDENCE_95 * slope * error / np.sqrt(8), rel=1e-3)
        assert half_width(damping) == pytest.approx(CONFIDENCE_95 * decay / frequency * error / np.sqrt(8), rel=1e-3)


def test_splitting_of_a_rigid_rotor() -> None:
    """2 (Ω₂ - Ω₁)/(Ω₂ + Ω₁) = 4/22 of 1 and 1.2, and its slopes by ln Ω are -/+ 4 Ω₁Ω₂/(Ω₁ + Ω₂)²."""
    error = 0.02
    one = found(bouncing(error=error))["splitting.1-2"]
    assert one.value == pytest.approx(2 * 0.2 / 2.2, rel=5e-3)
    assert half_width(one) == pytest.approx(CONFIDENCE_95 * 4 * 1.2 / 2.2**2 * np.sqrt(2) * error / np.sqrt(8), rel=5e-3)


def one_mass(damping: float) -> float:
    """AF of r²/√((1 - r²)² + (2ζr)²), its top at 1/√(1 - 2ζ²): half-power points from the roots of a quadratic in r²."""
    level = 1 / (8 * damping**2 * (1 - damping**2))
    lower, upper = np.sqrt(np.sort(np.roots([1 - 1 / level, -(2 - 4 * damping**2), 1.0]).real))
    return float(1 / np.sqrt(1 - 2 * damping**2) / (upper - lower))


def test_amplification_of_a_rigid_rotor() -> None:
    """ζ = c/√(2 k m), of the logarithm half the error of that of the stiffness: ε/√8. Interpolated, within some per cent."""
    error = 0.02
    quantities = found(bouncing(error=error))
    for channel, number, damping in (("X", 1, 0.05), ("Y", 2, 0.05 / 1.2)):
        one = quantities[f"probe.{channel}.amplification_factor.{number}"]
        assert one.value == pytest.approx(one_mass(damping), rel=2e-3)
        slope = np.log(one_mass(1.001 * damping) / one_mass(0.999 * damping)) / 0.002
        assert one.upper is not None
        assert one.lower is not None
        assert np.log(one.upper / one.lower) / 2 == pytest.approx(-slope * CONFIDENCE_95 * error / np.sqrt(8), rel=0.08)


def test_errors_of_amplification_factors_are_those_of_small_changes() -> None:
    model = model_of(chapter_3(), error=0.001)
    names = ("bearing.B1.kxx", "bearing.B2.cyy", "coupling.C1.k_phix", "disc.D2.unbalance.real")
    some = [model.coordinates.index(name) for name in names]
    covariance = np.zeros_like(model.covariance)
    covariance[np.ix_(some, some)] = model.covariance[np.ix_(some, some)]
    model = replace(model, covariance=covariance)

    def peaks(changed: UpdatedModel) -> list[tuple[float, float]]:
        root = followed_crossings(model).modes.eigenvalue  # the same speeds each time
        place = model.machine.probes[0]
        (one,) = peaks_with_errors(changed, places=[place], crossings=root, lowest=30.0, highest=300.0)
        return [(peak.peak.amplification_factor or np.nan, peak.factor_error or np.nan) for peak in one]

    slopes = []
    for place in some:
        step = np.where(np.arange(model.values.size) == place, 0.1 * np.sqrt(covariance[place, place]), 0.0)
        ahead, behind = (np.array(peaks(replace(model, values=model.values + sign * step)))[:, 0] for sign in (1, -1))
        slopes.append((ahead - behind) / (2 * step[place]))
    expected = standard_errors(np.array(slopes).T, covariance[np.ix_(some, some)])
    error = np.array(peaks(model))[:, 1]
    assert error.size >= 3
    assert error == pytest.approx(expected, rel=0.02, nan_ok=True)


def at_running_speed(machine: Machine, rpm: float) -> Machine:
    return machine.model_copy(update={"operation": Operation(running_rpm=rpm)})


@pytest.mark.parametrize("rpm", [None, 1500.0])
def test_coupling_loads_are_those_at_running_speed(rpm: float | None) -> None:
    model = model_of(chapter_3())
    machine = model.machine if rpm is None else at_running_speed(model.machine, rpm)
    speed = TOP if rpm is None else rpm_to_rad_per_s(rpm)
    (load,) = coupling_forces(model, speed=np.array([speed]))
    quantities = {one.name: one for one in derived_quantities(machine, outcome(model))}
    for what, unit, band in (("force", "N", load.force), ("moment", "N m", load.moment)):
        one = quantities[f"coupling.C1.misalignment_{what}"]
        assert (one.unit, one.value, one.lower, one.upper) == (unit, band.amplitude[0], band.lower[0], band.upper[0])


def test_a_train_of_everything_has_its_quantities_in_order() -> None:
    quantities = list(found(rich_model()))
    kinds = list(dict.fromkeys(name.split(".")[0] for name in quantities))
    assert kinds == ["critical_speed", "damping_ratio", "splitting", "coupling", "probe"]
    assert len(set(quantities)) == len(quantities)


def test_the_second_order_is_told_where_it_is_measured() -> None:
    model = model_of(chapter_3())
    channels = len(model.machine.channels)
    second = np.full((10, channels), complex(np.nan, np.nan))
    second[:, 0], second[:3, 1] = 1e-6, 1e-6
    quantities = found(model, Orders(np.full(10, TOP), np.full((10, channels), 4e-6 + 0j), second))
    first, other = (quantities[f"probe.{channel}.second_over_first"] for channel in model.machine.channels[:2])
    assert (first.value, first.lower, first.upper) == pytest.approx((0.25, 0.25, 0.25))
    amplitude, phase = (quantities[f"probe.{model.machine.channels[0]}.second_{what}"] for what in ("amplitude", "phase"))
    assert amplitude.value == pytest.approx(1e-6)
    assert phase.value == pytest.approx(0.0)
    assert (amplitude.unit, phase.unit) == ("m", "rad")
    assert other.value is None
    assert other.reason == "fewer than 6 samples within 10 % of 2387 r/min have both"
    assert f"probe.{model.machine.channels[2]}.second_over_first" not in quantities


def test_what_is_damped_away_has_a_reason_and_keeps_its_number() -> None:
    model = bouncing(error=0.01)
    overdamped = model.values + np.where([name.endswith("cxx") for name in model.coordinates], np.log(40.0), 0.0)
    quantities = found(replace(model, values=overdamped))
    assert quantities["critical_speed.1"].value is None
    assert "damped away" in (quantities["splitting.1-2"].reason or "")
    assert quantities["critical_speed.2"].value == pytest.approx(np.sqrt(2 * 1.44 * STIFFNESS / MASS), rel=2e-3)


def test_the_sense_of_rotation_is_that_of_the_runs() -> None:
    model = model_of(chapter_3())
    forward, backward = (
        derived_quantities(model.machine, outcome(model), direction=direction)[0].value for direction in (1, -1)
    )
    assert forward != backward
    assert derived_quantities(model.machine, outcome(model))[0].value == forward


def test_a_train_on_films_that_runs_far_below_its_critical_speeds_has_all_other_quantities() -> None:
    """Its curves over speed were asked at no speed, and the identification of a stiff pump ended with an error."""
    said = film_document(motor_compressor_plant(0)) | {"speed_range": {"minimum_rpm": 300.0, "maximum_rpm": 900.0}}
    names = [one.name for one in model_quantities(expected_model(parse_machine(said)), speed=90.0)]
    assert not any(name.startswith("critical_speed") for name in names)
    assert {"bearing.B1.kxx@900rpm", "bearing.B4.load_vertical", "coupling.C1.static_shear_vertical"} <= set(names)
