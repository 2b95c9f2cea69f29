"""The static state on oil films on a terminal: what the document says, and what was identified."""

import pytest

from estimator.alignment.stability_margin import stability_margin
from estimator.machine.document import Machine
from estimator.machine.films import StaticLoad
from estimator.updated_model.film_results import film_results
from estimator.updated_model.model import expected_model
from service.commands.results.film_report import film_text, identified_films, identified_stability
from tests.estimator.models import rich_model
from tests.estimator.statics.films import between_two_bearings
from tests.estimator.updated_model.test_film_results import machine_of, uncertain


def test_no_number_of_a_report_is_minus_nothing() -> None:
    said = film_text(between_two_bearings(), service_rpm=3000.0)
    assert "as the document describes them" in said
    assert not {word for word in said.split() if word.startswith("-") and not word.strip("-0.")}


def with_force(force_y: float) -> Machine:
    """Two bearings with a static force [N] beside the first one."""
    machine = between_two_bearings()
    first = machine.bearings[0]
    load = StaticLoad(id="gear", shaft=first.shaft, station=first.station, force_y=force_y)
    return machine.model_copy(update={"static_loads": [load]})


def test_a_train_whose_journals_touch_is_not_said_to_be_stable() -> None:
    said = film_text(with_force(-2.0e6), service_rpm=3000.0)
    assert "the journals touch: 2e+06 N on bearing 'B1', whose journal touches first, at rest are" in said
    assert "without an equilibrium at 3000 r/min" in said
    assert "would not whirl" not in said


def test_films_are_said_not_to_be_valid_below_the_speed_from_which_they_carry() -> None:
    machine = between_two_bearings()
    film = machine.bearings[0].film
    assert film is not None
    lifted = machine.bearings[0].model_copy(update={"film": film.model_copy(update={"valid_above_rpm": 3500.0})})
    machine = machine.model_copy(update={"bearings": (lifted, *machine.bearings[1:])})
    said = film_text(machine, service_rpm=3000.0)
    rows = [row for row in said.splitlines() if row.endswith("not valid below 3500 r/min: lifted by other means here")]
    assert [row.split()[0] for row in rows] == ["B1", "B1"]
    assert "Stability as if the films of B1 carried, which are not valid at 3000 r/min:" in said
    assert "not valid" not in film_text(machine, service_rpm=3600.0).split("3600")[1]


def test_a_journal_that_is_lifted_against_its_upper_half_is_remarked() -> None:
    weight = sum(float(row.split()[2]) for row in film_text(between_two_bearings(), service_rpm=3000.0).splitlines()[2:4])
    said = film_text(with_force(weight), service_rpm=3000.0)
    assert [row.split()[0] for row in said.splitlines() if row.endswith("pressed upwards")] == ["B1", "B1"]
    assert "pressed upwards" not in film_text(between_two_bearings(), service_rpm=3000.0)


def test_each_film_is_reported_as_identified_with_half_its_interval() -> None:
    model = uncertain(machine_of())
    heading, *rows = identified_films(model)
    assert "as identified, at 3000 r/min" in heading
    assert [row.split()[0] for row in rows] == ["B1", "B2", "B3", "B4"]
    load = next(one for one in film_results(model) if one.name == "bearing.B2.load_vertical")
    told = rows[1].split()
    assert float(told[4]) == pytest.approx(load.value, abs=0.51)
    assert float(told[6]) == pytest.approx(1.96 * load.error, abs=0.51)


def test_a_train_without_films_has_no_such_report() -> None:
    assert not list(identified_films(rich_model()))
    assert not list(identified_stability(rich_model()))
    assert list(identified_films(expected_model(machine_of())))


def test_the_identified_train_has_its_stability_told_with_half_its_interval() -> None:
    model = uncertain(machine_of())
    margin = stability_margin(model)
    assert margin is not None
    (said,) = identified_stability(model)
    assert "at 3000 r/min" in said
    told = said.partition("log decrement ")[2].split(";")[0].split(" ± ")
    assert [float(one) for one in told] == pytest.approx([margin.log_decrement, 1.96 * margin.error], abs=6e-4)
