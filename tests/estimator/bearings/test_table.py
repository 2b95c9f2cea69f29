"""Bearings that follow a table over speed: its interpolation, its scale factors, and what is expected of the machine.

The plant is a full solve with coefficients that this file interpolates itself, by straight lines over a dense grid of them.
"""

import copy
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.bearings.model import ModelParameter
from estimator.bearings.table import Table
from estimator.fit.identification import Identification, Options
from estimator.fit.identify import identify
from estimator.machine.checks.document_size import accepted_machine, document_size
from estimator.machine.checks.document_warnings import document_warnings
from estimator.machine.document import DocumentError, Machine, parse_machine
from estimator.machine.parameter_description import describe
from estimator.modes.nominal_critical_speeds import nominal_critical_speeds
from estimator.phasors.measurement import Measurement
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.coefficient_models import expected_coefficients
from estimator.rotor.parameter_names import parameter_units
from estimator.rotor.parameters import unknowns
from estimator.rotor.system_matrices import system_matrices, system_matrices_over_speed
from estimator.simulation.simulated_plant import draw_truth, true_phasors, truth_of_run
from estimator.trends.between_run_scatter import DAMPING_SCATTER, STIFFNESS_SCATTER, expected_scatter
from estimator.units import rpm_to_rad_per_s
from estimator.updated_model.model import updated_model
from formats.files.document_files import read_yaml
from tests.estimator.full_train import elements, full_response, node_of
from tests.estimator.trains import LATERAL, Complexes, Document, Floats, chapter_3_document, few_examples, noisy
from tests.paths import EXAMPLES

SPEED: Floats = np.arange(12.0, 300.0, 2.0)
RPM = np.linspace(90.0, 3000.0, 40)
"""Speeds of the tables: so many that straight lines between them are as good as any curve [r/min]."""
DIRECT = ("kxx", "kyy", "cxx", "cyy")
GROWTH = {"kxx": 0.35, "kxy": 0.5, "kyx": -0.4, "kyy": 0.2, "cxx": -0.5, "cxy": 0.1, "cyx": 0.3, "cyy": -0.4}


def law(name: str, rpm: Floats) -> Floats:
    """Factor on a bearing's Chapter 3 coefficient at some speeds, like an oil film's: monotone, curved."""
    return np.exp(GROWTH[name] * np.tanh(rpm / 1500.0))


def tabulated(spread: float = 0.0, bearings: tuple[int, ...] = (0, 1, 2, 3)) -> Document:
    """Chapter 3 with tables at some bearings."""
    document = chapter_3_document()
    for place in bearings:
        bearing = document["bearings"][place]
        columns = {name: (bearing.pop(name) * law(name, RPM)).tolist() for name in LATERAL}
        bearing["speed_dependence"] = {"form": "table", "speed_rpm": RPM.tolist(), **columns, "scale_spread": spread}
    return document


def truth_phasors(document: Document, factors: dict[str, dict[str, float]], speed: Floats = SPEED) -> Complexes:
    """Full solves with the tables' values times a factor per bearing and direct term."""
    machine = parse_machine(document)
    constant = elements(machine)

    def at_speed(omega: float) -> tuple[Floats, Floats, Floats]:
        k, c, mass = (one.copy() for one in constant)
        for bearing in document["bearings"]:
            table, off = bearing["speed_dependence"], factors.get(bearing["id"], {})
            x = node_of(machine, bearing["shaft"], bearing["station"])
            for kind, matrix in (("k", k), ("c", c)):
                first, second = (off.get(f"{kind}{axis}", 1.0) for axis in ("xx", "yy"))
                mean = math.sqrt(first * second)
                part = [first, mean, mean, second]
                value = [
                    np.interp(omega * 30 / math.pi, table["speed_rpm"], table[f"{kind}{axes}"]) * scale
                    for axes, scale in zip(("xx", "xy", "yx", "yy"), part, strict=True)
                ]
                matrix[x : x + 2, x : x + 2] += np.reshape(value, (2, 2))
        return k, c, mass

    return full_response(machine, speed, at_speed=at_speed)


def found_from(document: Document, factors: dict[str, dict[str, float]], seed: int) -> Identification:
    clean = truth_phasors(document, factors)
    return identify(parse_machine(document), Measurement.of(speed=SPEED, phasor=noisy(clean, seed=seed), direction=1))


def drawn_factors(spread: float, seed: int) -> dict[str, dict[str, float]]:
    rng = np.random.default_rng(seed)
    return {f"B{n}": {name: float(np.exp(spread * rng.standard_normal())) for name in DIRECT} for n in range(1, 5)}


# --- the table itself -------------------------------------------------------------------------------------------------


def model_of(table: Table) -> Any:
    named = [ModelParameter(f"bearing.B1.{t}", "stiffness", "N/m", t in DIRECT, 1.0, 1.0, 1.0) for t in table.coefficients]
    return table.models(named)[0]


@few_examples
@given(
    st.lists(st.floats(1.0, 1e9), min_size=5, max_size=12),
    st.lists(st.floats(1.0, 500.0), min_size=12, max_size=12),
    st.booleans(),
)
def test_monotone_columns_stay_monotone_and_within_their_ends(values: list[float], gaps: list[float], falls: bool) -> None:
    column = sorted(values, reverse=falls)
    speeds = np.cumsum(gaps[: len(column)])
    table = Table(form="table", speed_rpm=tuple(speeds), kxx=tuple(column))
    dense = np.linspace(0.5 * speeds[0], 1.5 * speeds[-1], 400) * np.pi / 30
    found = model_of(table).at(dense).values(np.zeros(0))[:, 0]
    step = np.diff(found) * (-1.0 if falls else 1.0)
    assert step.min() >= -1e-9 * max(column)
    assert min(column) <= found.min()
    assert found.max() <= max(column)


def test_the_table_is_met_at_its_speeds_and_held_level_beyond() -> None:
    table = Table.model_validate(tabulated()["bearings"][1]["speed_dependence"])
    model = model_of(table)
    at = model.at(RPM * np.pi / 30).values(np.zeros(0))
    for column, name in enumerate(model.coefficients):
        assert at[:, column] == pytest.approx(np.array(getattr(table, describe(name).quantity)), rel=1e-12)
    beyond = model.at(np.array([1.0, 9.0, 400.0, 4000.0])).values(np.zeros(0))
    assert beyond == pytest.approx(np.stack([at[0], at[0], at[-1], at[-1]]), rel=1e-12)
    assert table.nominal("kyy", 3500.0) == pytest.approx(at[-1, model.coefficients.index("bearing.B1.kyy")])
    assert table.nominal("mxx", 3500.0) is None


def test_an_exact_table_has_no_parameters_and_a_scaled_one_four() -> None:
    for spread, count in ((0.0, 0), (0.1, 4)):
        table = Table.model_validate(tabulated(spread)["bearings"][0]["speed_dependence"])
        model = model_of(table)
        assert len(model.parameters) == count == table.parameter_count(LATERAL)
    assert [one.name for one in model.parameters] == [f"bearing.B1.{name}_scale" for name in DIRECT]
    assert {(one.unit, one.spread, one.expected) for one in model.parameters} == {("1", 0.1, 1.0)}


def test_a_cross_coupled_term_goes_with_the_geometric_mean_of_the_factors_beside_it() -> None:
    table = Table.model_validate(tabulated(0.1)["bearings"][0]["speed_dependence"])
    model = model_of(table)
    curves, factor = model.at(SPEED), np.array([1.2, 0.9, 1.5, 0.8])
    part = dict(zip(table.coefficients, (curves.values(np.log(factor)) / curves.values(np.zeros(4)))[3], strict=True))
    assert [part[name] for name in DIRECT] == pytest.approx(factor)
    assert [part["kxy"], part["kyx"]] == pytest.approx([math.sqrt(1.2 * 0.9)] * 2)
    assert [part["cxy"], part["cyx"]] == pytest.approx([math.sqrt(1.5 * 0.8)] * 2)


# --- the machine ------------------------------------------------------------------------------------------------------


def test_expected_coefficients_and_matrices_follow_the_table() -> None:
    document = tabulated()
    document["parameters"] = [{"names": "bearing.B4.*", "tied_to": "bearing.B2"}]
    machine = parse_machine(document)
    listed = unknowns(machine, assemble_rotor(machine)).coefficients
    speed = rpm_to_rad_per_s(float(RPM[17]))
    found = dict(zip([one.name for one in listed], expected_coefficients(listed, np.array([speed]))[0], strict=True))
    for bearing, column in (("B1", 0), ("B2", 1), ("B3", 2), ("B4", 1)):
        table = document["bearings"][column]["speed_dependence"]
        assert [found[f"bearing.{bearing}.{n}"] for n in LATERAL] == pytest.approx([table[n][17] for n in LATERAL], rel=1e-12)
    assert found["coupling.C1.kxx"] == document["couplings"][0]["kxx"]
    over = system_matrices_over_speed(machine)
    given_values = system_matrices(machine, coefficients=np.array([found[one.name] for one in listed]))
    assert over(speed).stiffness == pytest.approx(given_values.stiffness, rel=1e-12)
    assert over(speed).damping == pytest.approx(given_values.damping, rel=1e-12)
    middle = np.array([one.expected for one in listed])
    assert expected_coefficients(listed, np.array([rpm_to_rad_per_s(3045.0)]))[0] == pytest.approx(middle, rel=1e-9)


def test_nominal_critical_speeds_are_those_of_the_table_at_that_very_speed() -> None:
    machine = parse_machine(tabulated())
    found = nominal_critical_speeds(machine)
    assert found.size >= 3
    for one in found:
        document = chapter_3_document()
        for bearing in document["bearings"]:
            for name in LATERAL:
                # Interpolated as the table is, at a speed between its own, within the curvature of a straight line.
                column = bearing[name] * law(name, RPM)
                bearing[name] = float(np.interp(one * 30 / np.pi, RPM, column))
        constant = nominal_critical_speeds(parse_machine(document))
        assert np.abs(constant / one - 1).min() < 1e-4


def test_simulated_plant_follows_the_table() -> None:
    machine = parse_machine(tabulated())
    drawn = draw_truth(machine, np.random.default_rng(1))
    drawn = truth_of_run(drawn, np.random.default_rng(2))
    off = drawn.coefficients / np.array([one.expected for one in drawn.unknowns.coefficients])
    of_bearing = np.array([one.element.startswith("bearing") for one in drawn.unknowns.coefficients])
    assert off[of_bearing] == pytest.approx(1.0)
    assert np.abs(off[~of_bearing] - 1.0).max() > 0.02
    found = identify(machine, Measurement.of(speed=SPEED, phasor=noisy(true_phasors(machine, drawn, SPEED), seed=2)))
    assert found.accepted, found.verdict


# --- identification ---------------------------------------------------------------------------------------------------


def test_an_exact_table_leaves_coupling_and_unbalances_to_be_found() -> None:
    document = tabulated()
    found = found_from(document, {}, seed=3)
    assert found.accepted, found.verdict
    own = [one for one in found.estimates if one.element.startswith("bearing.")]
    assert len(own) == 32
    assert {one.reason for one in own} == {"as the document gives it over speed, which is taken as exact"}
    stiffness = found.estimate("coupling.C1.kxx")
    assert stiffness.value is not None
    assert stiffness.standard_error is not None
    assert abs(stiffness.value - 212_000) < 4 * stiffness.standard_error
    assert set(parameter_units(parse_machine(document))) == {one.name for one in found.estimates}


def test_scale_factors_are_recovered_with_intervals_that_hold() -> None:
    document = tabulated(0.15)
    units = parameter_units(parse_machine(document))
    held, count = 0, 0
    for seed in range(4):
        factors = drawn_factors(0.15, seed)
        found = found_from(document, factors, seed)
        assert found.accepted, found.verdict
        assert set(units) == {one.name for one in found.estimates}
        for bearing, terms in factors.items():
            for name, factor in terms.items():
                one = found.estimate(f"bearing.{bearing}.{name}_scale")
                assert one.unit == units[one.name] == "1"
                if one.lower is not None and one.upper is not None:
                    count += 1
                    held += one.lower <= factor <= one.upper
                    assert one.upper < 1.5 * one.lower
    assert count >= 60
    assert held / count >= 0.86


def test_the_updated_model_follows_the_table_with_the_factors_found() -> None:
    document, factors = tabulated(0.15), drawn_factors(0.15, 7)
    machine = parse_machine(document)
    found = found_from(document, factors, seed=7)
    names = [one.name for one in unknowns(machine, assemble_rotor(machine)).coefficients]
    value = dict(zip(names, updated_model(machine, found).coefficients(rpm_to_rad_per_s(float(RPM[20]))), strict=True))
    for bearing in document["bearings"]:
        scale = found.estimate(f"bearing.{bearing['id']}.kxx_scale").value
        if scale is not None:
            expected = scale * bearing["speed_dependence"]["kxx"][20]
            assert value[f"bearing.{bearing['id']}.kxx"] == pytest.approx(expected, rel=1e-6)


def test_a_wrong_table_is_refused() -> None:
    document = tabulated()
    clean = truth_phasors(document, {"B2": {"kxx": 1.3, "kyy": 1.3}})
    measured = Measurement.of(speed=SPEED, phasor=noisy(clean, seed=5), direction=1)
    found = identify(parse_machine(document), measured, Options(starts=3))
    assert not found.accepted


def test_trends_measure_a_factor_by_the_term_it_scales() -> None:
    names = ("bearing.B1.kxx_scale", "bearing.B1.cyy_scale")
    assert expected_scatter(names).tolist() == [STIFFNESS_SCATTER, DAMPING_SCATTER]
    assert [describe(name).coefficient for name in names] == ["bearing.B1.kxx", "bearing.B1.cyy"]
    assert all(describe(name).positive for name in names)


# --- documents --------------------------------------------------------------------------------------------------------


def small(**changes: Any) -> dict[str, Any]:
    table = {"form": "table", "speed_rpm": [100, 500, 1000, 2000, 6000], "kxx": [2e5, 3e5, 3e5, 4e5, 5e5]}
    return {key: value for key, value in (table | changes).items() if value is not None}


def with_table(table: dict[str, Any]) -> Document:
    document = copy.deepcopy(chapter_3_document())
    del document["bearings"][1]["kxx"]
    document["bearings"][1]["speed_dependence"] = table
    return document


def refused(document: Document) -> tuple[str, str]:
    with pytest.raises(DocumentError) as raised:
        parse_machine(document)
    ((field, message),) = raised.value.problems
    return field.removeprefix("bearings[1].speed_dependence"), message


@pytest.mark.parametrize(
    ("changes", "field", "message"),
    [
        ({"speed_rpm": [100, 500, 1000, 2000]}, ".speed_rpm", "at least 5 speeds [r/min], usually 10 to 30, not 4"),
        ({"speed_rpm": [100, 500, 400, 2000, 6000]}, ".speed_rpm", "must ascend: 400 at place 3 follows 500"),
        ({"speed_rpm": [100, 500, 500, 2000, 6000]}, ".speed_rpm", "must ascend"),
        ({"kxx": [2e5, 3e5]}, "", "kxx needs one value at each of the 5 speeds of speed_rpm, not 2"),
        ({"kxx": [2e5, 3e5, -3e5, 4e5, 5e5]}, ".kxx[2]", "greater than"),
        ({"kxx": [2e5, 3e5, 0.0, 4e5, 5e5]}, ".kxx[2]", "greater than"),
        ({"kxx": [2e5, 3e5, math.nan, 4e5, 5e5]}, ".kxx[2]", "finite number"),
        ({"kxx": [2e5, 3e5, None, 4e5, 5e5]}, ".kxx[2]", "number"),
        ({"kxx": [2e5, 3e5, "3,5e5", 4e5, 5e5]}, ".kxx[2]", "number"),
        ({"speed_rpm": [100, 500, math.nan, 2000, 6000]}, ".speed_rpm[2]", "finite number"),
        ({"speed_rpm": [0, 500, 1000, 2000, 6000]}, ".speed_rpm[0]", "greater than 0"),
        ({"kxx": None}, "", "at least one of kxx, kxy"),
        ({"csv": "bearing.csv", "kxx": None, "speed_rpm": None}, "", "a file is read only by commands"),
        ({"scale_spread": -0.1}, ".scale_spread", "greater than or equal to 0"),
        ({"kzz": [1.0] * 5}, ".kzz", "there is no such field"),
    ],
)
def test_a_wrong_table_names_the_field(changes: dict[str, Any], field: str, message: str) -> None:
    place, words = refused(with_table(small(**changes)))
    assert place == field
    assert message in words


def test_a_coefficient_stands_in_one_place_only() -> None:
    document = with_table(small())
    document["bearings"][1]["kxx"] = 2e5
    assert refused(document) == ("bearings[1].kxx", "stands in the table of speed_dependence, too: give it in one place only")


@pytest.mark.parametrize("rule", [{"fixed": True}, {"spread": 0.1}])
def test_a_rule_does_not_hold_what_follows_a_table(rule: dict[str, Any]) -> None:
    document = with_table(small())
    document["parameters"] = [{"names": "bearing.B2.kxx", **rule}]
    place, words = refused(document)
    assert place == "parameters[0]"
    assert "scale_spread says how far it may be off" in words


def machine_of(table: dict[str, Any]) -> Machine:
    return parse_machine(with_table(table))


def over_load(load: float, loads: tuple[float, ...] = (500.0, 1000.0, 2000.0)) -> dict[str, Any]:
    """A table over the load, in which two terms go with a power of it."""
    columns = [
        {"load": one, "kxx": [2e5 * one**0.4 * k for k in range(1, 6)], "kxy": [-1e4 * one**0.4 * k for k in range(1, 6)]}
        for one in loads
    ]
    return {"form": "table", "speed_rpm": [90, 500, 1000, 2000, 6000], "over_load": columns, "load": load}


def test_a_table_over_the_load_is_met_at_its_loads_and_taken_between_them() -> None:
    for load in (500.0, 1000.0, 2000.0):
        table = Table.model_validate(over_load(load))
        assert table.column("kxx") == pytest.approx([2e5 * load**0.4 * k for k in range(1, 6)])
        assert table.nominal("kxy", 1000.0) == pytest.approx(-1e4 * load**0.4 * 3)
    between = Table.model_validate(over_load(1400.0))
    assert between.column("kxx") == pytest.approx([2e5 * 1400.0**0.4 * k for k in range(1, 6)], rel=0.01)
    two = Table.model_validate(over_load(np.sqrt(5e5), loads=(500.0, 1000.0)))
    assert two.column("kxx")[0] == pytest.approx(2e5 * (500.0**0.4 + 1000.0**0.4) / 2)


def test_a_load_beyond_the_table_is_held_at_its_end_and_warned_of() -> None:
    document = with_table(over_load(3000.0))
    del document["bearings"][1]["kxy"]
    (one,) = document_warnings(parse_machine(document))
    assert str(one) == (
        "bearings[1].speed_dependence.load: 3000 N: the table covers loads of 500 to 2000 N and is held at its end"
    )
    assert Table.model_validate(over_load(3000.0)).column("kxx") == Table.model_validate(over_load(2000.0)).column("kxx")


@pytest.mark.parametrize(
    ("changes", "field", "message"),
    [
        ({"load": None}, "", "over_load needs the bearing's own static load [N] as load"),
        ({"load": -5.0}, ".load", "greater than 0"),
        ({"kxx": [2e5] * 5}, "", "kxx beside over_load"),
        ({"over_load": over_load(1.0)["over_load"][:1]}, ".over_load", "at least two loads [N]"),
        ({"over_load": over_load(1.0)["over_load"][::-1]}, ".over_load", "must ascend: 1000 follows 2000"),
        ({"over_load": [{"load": 1.0, "kxx": [1e5] * 5}, {"load": 2.0, "kyy": [1e5] * 5}]}, ".over_load", "the same columns"),
        ({"over_load": [{"load": 1.0, "kxx": [1e5] * 4}, {"load": 2.0, "kxx": [1e5] * 5}]}, "", "kxx needs one value"),
        ({"over_load": [{"load": 1.0}, {"load": 2.0}]}, "", "at least one of kxx"),
        ({"over_load": [], "kxx": [2e5] * 5}, "", "load is of tables over the load"),
    ],
)
def test_a_wrong_table_over_the_load_names_the_field(changes: dict[str, Any], field: str, message: str) -> None:
    document = with_table(over_load(1000.0) | changes)
    del document["bearings"][1]["kxy"]
    place, words = refused(document)
    assert place == field
    assert message in words


def test_a_speed_range_beyond_the_table_is_warned_of() -> None:
    assert [str(one) for one in document_warnings(machine_of(small()))] == [
        "bearings[1].speed_dependence.speed_rpm: the table covers 100 to 6000 r/min and is held level beyond its ends, "
        "from 90 to 100 r/min"
    ]
    (short,) = document_warnings(machine_of(small(speed_rpm=[90, 500, 1000, 2000, 4000])))
    assert "from 4000 to 6000 r/min" in short.words
    assert not document_warnings(machine_of(small(speed_rpm=[90, 500, 1000, 2000, 6000])))
    (unit,) = document_warnings(machine_of(small(speed_rpm=[90, 500, 1000, 2000, 6000], kxx=[90.0, 91, 92, 93, 94])))
    assert unit.field == "bearings[1].speed_dependence.kxx"
    assert "was N/µm meant?" in unit.words
    with pytest.raises(
        DocumentError, match=r"dependence.kxx: 90 N/m: usual is 1e\+5 to 1e\+9 N/m; was 90 N/µm meant, 9e\+07 N/m"
    ):
        accepted_machine(with_table(small(speed_rpm=[90, 500, 1000, 2000, 6000], kxx=[90.0, 91, 92, 93, 94])))
    damped = with_table(small(speed_rpm=[90, 500, 1000, 2000, 6000], kxx=[2e7] * 5, cxx=[90.0] * 5))
    del damped["bearings"][1]["cxx"]
    (damping,) = document_warnings(parse_machine(damped))
    assert damping.field == "bearings[1].speed_dependence.cxx"
    assert damping.words.startswith("90 N s/m at 6000 r/min, with the speed 0.0028 of kxx there: films have 0.1 to 10 of it")


@pytest.mark.parametrize(("speeds", "meant"), [([2, 20, 40, 60, 100], "100 Hz"), ([10, 150, 300, 450, 630], "630 rad/s")])
def test_speeds_of_a_table_in_other_units_are_asked_for(speeds: list[float], meant: str) -> None:
    (unit,) = document_warnings(machine_of(small(speed_rpm=speeds)))
    assert f"; was {meant} meant, 60" in unit.words, unit.words


def test_a_table_for_several_loads_in_other_units_is_refused() -> None:
    table = over_load(1000.0)
    table["over_load"][1]["kxx"] = [20.0, *table["over_load"][1]["kxx"][1:]]
    document = with_table(table)
    del document["bearings"][1]["kxy"]
    with pytest.raises(DocumentError, match=r"speed_dependence.over_load\[1\].kxx: 20 N/m: usual is .*; was 20 N/µm meant"):
        accepted_machine(document)


def test_what_neither_a_table_nor_its_bearing_gives_is_warned_of() -> None:
    document = with_table(small(speed_rpm=[90, 500, 1000, 2000, 6000]))
    for name in ("kyy", "cxy"):
        del document["bearings"][1][name]
    (lacking,) = document_warnings(parse_machine(document))
    assert lacking.field == "bearings[1].speed_dependence"
    assert lacking.words.startswith("neither in the table nor beside it: kyy, cxy; each is a constant that a fit must find")


def test_a_hole_between_the_speeds_is_warned_of() -> None:
    (hole,) = document_warnings(machine_of(small(speed_rpm=[90, 100, 200, 300, 6000])))
    assert hole.field == "bearings[1].speed_dependence.speed_rpm"
    assert hole.words.startswith(
        "no speed between 300 and 6000 r/min, 96 % of the machine's range: the course there is a guess"
    )


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"kxx": [9e7, 9e7, 9e10, 9e7, 9e7]}, "kxx: 9e+10 N/m at 1000 r/min stands beside 9e+07 N/m: is its exponent right?"),
        ({"kxx": [9e10, 9e7, 8e7, 8e7, 8e7]}, "kxx: 9e+10 N/m at 90 r/min stands beside 9e+07 N/m"),
        ({"kxx": [9e7, 9e7, 8e7, 8e4, 8e7]}, "kxx: 80000 N/m at 2000 r/min stands beside 8e+07 N/m"),
        ({"kxx": [1e9, 1e8, 3e7, 1e7, 8e6]}, None),
        ({"kxx": [9e7] * 5, "kxy": [1e7, 1e6, 0.0, -1e6, -8e6]}, None),
    ],
)
def test_a_value_far_from_those_beside_it_is_warned_of(change: dict[str, Any], words: str | None) -> None:
    document = with_table(small(speed_rpm=[90, 500, 1000, 2000, 6000], **change))
    for name in change:
        document["bearings"][1].pop(name, None)
    told = [str(one) for one in document_warnings(parse_machine(document))]
    assert len(told) == (words is not None), told
    assert words is None or told[0].startswith(f"bearings[1].speed_dependence.{words}")


def test_loads_of_a_table_in_kilonewtons_are_asked_for() -> None:
    document = read_yaml(EXAMPLES / "motor-on-rolling-elements.yaml")
    columns = {"kxx": [9e7] * 5}
    tables = [{"load": load, **columns} for load in (0.8, 2.0)]
    table = {"form": "table", "speed_rpm": [500, 1000, 2000, 3000, 5000], "over_load": tables, "load": 1.3}
    document["bearings"][0]["speed_dependence"] = table
    del document["bearings"][0]["kxx"], document["parameters"]
    (unit,) = document_warnings(parse_machine(document))
    assert unit.field == "bearings[0].speed_dependence.load"
    assert unit.words.startswith("1.3 N is 0.0011 times a bearing's share of all rotors' weight, ")
    assert unit.words.endswith("N: usual is 0.2 to 5 times; was 1.3 kN meant, 1300 N?")


def test_unknowns_of_a_table_are_counted() -> None:
    before = document_size(parse_machine(chapter_3_document())).unknowns
    assert document_size(parse_machine(tabulated(0.0))).unknowns == before - 32
    assert document_size(parse_machine(tabulated(0.1))).unknowns == before - 16
