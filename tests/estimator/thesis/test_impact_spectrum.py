"""Impact tests against a single mass on springs in closed form, reciprocity, and the modes that the thesis's blows excite."""

import math

import numpy as np
import pytest
import yaml
from numpy.typing import NDArray

from estimator.machine.document import Machine, parse_machine
from estimator.modes.eigenmodes import natural_frequencies
from estimator.thesis.impact_spectrum import Place, impact_spectrum, spectrum_peaks
from estimator.thesis.rig import nominal_values, plane_frequencies
from tests.estimator.trains import ROOT, one_disc_document

Floats = NDArray[np.float64]


@pytest.fixture(scope="module")
def rig() -> Machine:
    return parse_machine(yaml.safe_load((ROOT / "examples" / "thesis-chapter-5-rig.yaml").read_text(encoding="utf-8")))


def test_a_mass_on_springs() -> None:
    """A rigid, massless shaft: -ω² / (2k - mω² + 2jωc) at the disc, along x only."""
    machine = parse_machine(one_disc_document(diameter=0.3, density=1e-6, kxx=1e5, cxx=50.0))
    frequency = np.array([5.0, 30.0, 31.8, 60.0])
    omega = 2 * math.pi * frequency
    expected = -(omega**2) / (2e5 - 5.0 * omega**2 + 2j * omega * 50.0)
    blow = [Place("S", 0.5)]
    coefficients, _ = nominal_values(machine)
    found = impact_spectrum(machine, coefficients=coefficients, blows=blow, sensor=Place("S", 0.5), frequency=frequency)
    assert found == pytest.approx(expected, rel=1e-3)
    across = impact_spectrum(machine, coefficients=coefficients, blows=blow, sensor=Place("S", 0.5, 90.0), frequency=frequency)
    assert np.abs(across).max() < 1e-9 * np.abs(expected).max()


def test_blow_and_sensor_change_places(rig: Machine) -> None:
    """The rig's cross-coupled terms are symmetric, so Maxwell's reciprocity holds."""
    coefficients, _ = nominal_values(rig)
    disc, bearing = Place("S2", 0.135, 30.0), Place("S1", 0.239, 90.0)
    frequency = np.array([50.0, 148.0, 260.0])
    one = impact_spectrum(rig, coefficients=coefficients, blows=[disc], sensor=bearing, frequency=frequency)
    other = impact_spectrum(rig, coefficients=coefficients, blows=[bearing], sensor=disc, frequency=frequency)
    assert one == pytest.approx(other, rel=1e-8)


def test_blows_add_up_and_a_negative_one_takes_away(rig: Machine) -> None:
    coefficients, _ = nominal_values(rig)
    frequency = np.array([148.0, 260.0])
    sensor = Place("S1", 0.239)

    def spectrum(*blows: Place) -> NDArray[np.complex128]:
        return impact_spectrum(rig, coefficients=coefficients, blows=blows, sensor=sensor, frequency=frequency)

    both = spectrum(Place("S1", 0.135), Place("S2", 0.135, size=-2.0))
    assert both == pytest.approx(spectrum(Place("S1", 0.135)) - 2.0 * spectrum(Place("S2", 0.135)), rel=1e-9)


@pytest.mark.parametrize("mode", [0, 1, 2])
def test_the_blows_of_figure_5_24_bring_out_their_mode(rig: Machine, mode: int) -> None:
    """First: both discs alike; second: opposite; third: alike, and against them at the coupling. Peak within its bandwidth."""
    coefficients, _ = nominal_values(rig)
    first, second = Place("S1", 0.135), Place("S2", 0.135)
    blows = ([first, second], [first, Place("S2", 0.135, size=-1.0)], [first, second, Place("S1", 0.27, size=-1.0)])[mode]
    sensor = Place("S2", 0.031) if mode == 0 else Place("S1", 0.239)
    frequency = np.arange(100.0, 450.0, 0.5)
    spectrum = impact_spectrum(rig, coefficients=coefficients, blows=blows, sensor=sensor, frequency=frequency)
    places, sizes = spectrum_peaks(frequency, spectrum)
    largest = places[np.argmax(sizes)]
    assert largest == pytest.approx(plane_frequencies(rig, coefficients=coefficients)[mode], rel=0.01)


def test_a_lightly_damped_peak_is_a_natural_frequency() -> None:
    machine = parse_machine(one_disc_document(cxx=5.0, cyy=5.0))
    coefficients, _ = nominal_values(machine)
    first = natural_frequencies(machine)[0] / (2 * math.pi)
    frequency = np.arange(0.8 * first, 1.2 * first, 1e-4 * first)
    spectrum = impact_spectrum(
        machine, coefficients=coefficients, blows=[Place("S", 0.5)], sensor=Place("S", 0.5), frequency=frequency
    )
    places, _ = spectrum_peaks(frequency, spectrum)
    assert places == pytest.approx([first], rel=2e-4)


def test_a_place_between_the_nodes_is_named(rig: Machine) -> None:
    coefficients, _ = nominal_values(rig)
    with pytest.raises(ValueError, match="no node at station"):
        impact_spectrum(
            rig, coefficients=coefficients, blows=[Place("S1", 0.1234)], sensor=Place("S1", 0.239), frequency=np.array([1.0])
        )
