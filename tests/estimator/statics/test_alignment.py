"""Alignment of couplings: the lever rule, a bent shaft's closed form, the reference cases, rigid motions."""

from collections.abc import Sequence

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from estimator.arrays import Floats
from estimator.machine.document import Machine, parse_machine
from estimator.statics.alignment import CouplingAlignment, coupling_alignments
from tests.estimator.statics.films import motor_compressor_document
from tests.estimator.trains import few_examples
from tests.film_plant.motor_compressor import ANGLE, PARALLEL, CouplingKind
from tests.paths import EXAMPLES

ROUNDING = 1e-9
"""Part of a motion that rounding may leave of it [-]."""


def long_train(stations: Sequence[float] | None = None) -> Machine:
    """The turbine, compressor and generator, with the compressor's bearings at other stations where they are given."""
    said = yaml.safe_load((EXAMPLES / "turbine-compressor-generator.yaml").read_text(encoding="utf-8"))
    shaft = said["shafts"][1]["id"]
    own = [one for one in said["bearings"] if one["shaft"] == shaft]
    stations = [one["station"] for one in own] if stations is None else stations
    others = [one for one in said["bearings"] if one["shaft"] != shaft]
    said["bearings"] = others + [{**own[0], "id": f"N{number}", "station": at} for number, at in enumerate(stations)]
    kept = {one["id"] for one in said["bearings"]}
    said["pedestals"] = [one for one in said.get("pedestals", []) if one["bearing"] in kept]
    return parse_machine(said)


def places(machine: Machine) -> Floats:
    """Distance of each bearing along the whole train [m]."""
    lengths = {one.id: sum(section.length for section in one.sections) for one in machine.shafts}
    begins, at = {}, 0.0
    for shaft in machine.shafts:
        begins[shaft.id] = at
        at += lengths[shaft.id]
    return np.array([begins[one.shaft] + one.station for one in machine.bearings])


def three_bearings(machine: Machine) -> list[float]:
    """Stations of the compressor's bearings with one more between them."""
    own = sorted(one.station for one in machine.bearings if one.shaft == machine.shafts[1].id)
    return [own[0], 0.4 * own[0] + 0.6 * own[-1], own[-1]]


@pytest.mark.parametrize("kind", ["flexible", "rigid"])
@pytest.mark.parametrize(
    ("case", "offset", "angle"),
    [("aligned", 0.0, 0.0), ("parallel_up", 1.0, 0.0), ("parallel_down", -1.0, 0.0), ("angle_100urad", 0.0, -ANGLE)],
)
def test_the_reference_cases_have_their_offset_and_angle(kind: CouplingKind, case: str, offset: float, angle: float) -> None:
    machine = parse_machine(motor_compressor_document(kind, case))
    (found,) = coupling_alignments(machine)
    elevation = np.array([one.film.elevation_y for one in machine.bearings if one.film is not None])
    assert found.offset @ elevation == pytest.approx(offset * PARALLEL[kind], abs=1e-12)
    assert found.angle @ elevation == pytest.approx(angle, abs=1e-12)


def test_shafts_on_two_bearings_are_levers() -> None:
    """Driver: 1.6 m, bearings at 0.1 and 1.48 m; driven: bearings at 0.1 and 1.46 m; lifted bearing by bearing."""
    (found,) = coupling_alignments(parse_machine(motor_compressor_document("flexible")))
    first, second = 1.48 - 0.1, 1.46 - 0.1
    assert found.offset == pytest.approx([0.12 / first, -(1.0 + 0.12 / first), 1.0 + 0.1 / second, -0.1 / second])
    assert found.angle == pytest.approx([1.0 / first, -1.0 / first, -1.0 / second, 1.0 / second])


@few_examples
@given(st.floats(-1e-3, 1e-3), st.floats(-1e-3, 1e-3), st.booleans())
def test_a_rigid_motion_of_the_whole_train_is_no_misalignment(up: float, tilt: float, on_three: bool) -> None:
    machine = long_train()
    machine = long_train(stations=three_bearings(machine)) if on_three else machine
    moved = up + tilt * places(machine)
    found = coupling_alignments(machine)
    assert len(found) == 2
    for one in found:
        assert abs(one.offset @ moved) <= ROUNDING * (abs(up) + abs(tilt))
        assert abs(one.angle @ moved) <= ROUNDING * (abs(up) + abs(tilt))


def test_each_coupling_goes_by_its_own_two_shafts() -> None:
    machine = long_train()
    shaft_of = [one.shaft for one in machine.bearings]
    for coupling, one in zip(machine.couplings, coupling_alignments(machine), strict=True):
        moved = {shaft for shaft, part in zip(shaft_of, one.offset, strict=True) if part != 0.0}
        assert moved == {coupling.driver, coupling.driven}
        lifted = np.array([float(shaft == coupling.driven) for shaft in shaft_of])
        assert one.offset @ lifted == pytest.approx(1.0)
        assert one.angle @ lifted == pytest.approx(0.0, abs=1e-12)


def test_a_shaft_on_three_bearings_bends_as_a_beam() -> None:
    """A slender uniform shaft, lifted by δ in the middle of its span L: slope 3 δ/L at its outer bearings."""
    said = motor_compressor_document("flexible")
    said["shafts"][0]["sections"] = [{"length": 4.5, "outer_diameter": 0.02, "material": "steel"}]
    said["bearings"][0]["station"], said["bearings"][1]["station"] = 0.2, 4.2
    said["discs"] = [one for one in said["discs"] if one["shaft"] == "S2"]
    middle = {**said["bearings"][0], "id": "B5", "station": 2.2}
    said["bearings"].append(middle)
    said["probes"] = [one for one in said["probes"] if one["shaft"] == "S2"]
    (found,) = coupling_alignments(parse_machine(said))
    assert found.angle[4] == pytest.approx(3.0 / 4.0, rel=2e-3)
    assert found.offset[4] == pytest.approx(0.3 * 3.0 / 4.0, rel=2e-3)
    assert found.offset[[2, 3]] == pytest.approx(alignment_of("flexible").offset[[2, 3]])


def alignment_of(kind: CouplingKind) -> CouplingAlignment:
    return coupling_alignments(parse_machine(motor_compressor_document(kind)))[0]


def test_a_shaft_on_one_bearing_has_no_place_of_its_own() -> None:
    machine = long_train()
    lone = long_train(stations=three_bearings(machine)[:1])
    for one in coupling_alignments(lone):
        assert one.undefined is not None
        assert f"shaft {machine.shafts[1].id} does not lie on two bearings of its own" in one.undefined
        assert not one.offset.any()
