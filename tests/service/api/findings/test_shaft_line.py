"""Oil films through the API: places of journals as the model and the gaps have them; coefficients over speed."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
import yaml

from estimator.fit.problem.coordinates import Coordinates
from estimator.machine.document import parse_machine
from estimator.machine.film_speeds import reported_rpm
from estimator.phasors.channel_status import ChannelStatus
from estimator.rotor.condensation import condense
from estimator.units import rpm_to_rad_per_s
from estimator.updated_model.film_coefficients import film_coefficients
from estimator.updated_model.model import model_at
from estimator.updated_model.shaft_line import modelled_lines
from storage.encoding.sample_blocks import Samples
from storage.machines import machines
from storage.measurements import runs
from tests.api_in_process import Api, problem
from tests.databases import Databases, opened
from tests.paths import EXAMPLES
from tests.plant import SECOND, START, identification, store_identification

COUNT = 30
MOVED = 5e-6
"""Motion of the second bearing's journal in y that the gaps have and the model has not, over the run [m]."""
SPEED = np.linspace(rpm_to_rad_per_s(4000.0), rpm_to_rad_per_s(900.0), COUNT)


def document() -> dict[str, Any]:
    said: dict[str, Any] = yaml.safe_load((EXAMPLES / "motor-compressor.yaml").read_text(encoding="utf-8"))
    for probe in said["probes"][:4]:
        probe["gap_grows"] = "away"
    return said


TRAIN = parse_machine(document())


def outcome() -> Any:
    train = condense(TRAIN, speed=SPEED, direction=np.ones(COUNT))
    coordinates = Coordinates.of(train, unbalance_scale=1.0)
    return identification(
        coordinates=coordinates.names,
        point=coordinates.point(np.zeros(coordinates.size)),
        covariance=np.diag(1e-4 * coordinates.unit**2),
        speed_minimum=float(SPEED.min()),
        speed_maximum=float(SPEED.max()),
    )


def held() -> Samples:
    """Gaps of the first two bearings with zeros of their own; a source that sends none of the others."""
    found = outcome()
    lines = modelled_lines(model_at(TRAIN, found.coordinates, found.point, found.covariance), speed=SPEED)
    assert lines is not None
    channels = len(TRAIN.probes)
    gap = np.full((COUNT, channels), np.nan)
    gap[:, :4] = lines.position[:, :2].reshape(COUNT, 4) + np.array([1e-3, 1.2e-3, -3e-4, 7e-4])
    gap[:, 3] += MOVED * np.linspace(-0.5, 0.5, COUNT)
    phasor = np.full((COUNT, channels), 1e-5 + 0j)
    return Samples(
        time=START + SECOND * np.arange(COUNT, dtype=np.int64),
        speed=SPEED,
        direction=np.ones(COUNT, np.int8),
        phasor=phasor,
        status=np.full(phasor.shape, ChannelStatus.GOOD, np.uint8),
        scatter=np.full(phasor.shape, np.nan),
        second=np.full(phasor.shape, complex(np.nan, np.nan)),
        gap=gap,
    )


@pytest.fixture(scope="module")
def api(databases: Databases, plant_template: str, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Api]:
    with opened(databases, plant_template, tmp_path_factory.mktemp("line") / "line.db") as database:
        with database.transaction() as session:
            machines.create(session, TRAIN)
            row = runs.open_run(session, TRAIN.id, revision=1, kind="run-down", direction=1, time_first=START)
            runs.close(row, samples=held(), state=runs.CLOSED, reason="the speed left the speed range")
            store_identification(session, outcome(), run_id=row.id, machine_id=TRAIN.id)
            store_identification(session, identification(), run_id=77)
        yield Api(database)


def test_measured_lines_follow_the_journals_from_the_models_zero(api: Api) -> None:
    body = api.value("/identifications/1/model/centreline", points=20)
    assert len(body["speed"]) == 20
    assert [one["bearing"] for one in body["bearings"]] == ["B1", "B2", "B3", "B4"]
    for one in body["bearings"]:
        way = np.hypot(one["x_um"], one["y_um"])
        assert (way < one["clearance_um"]).all()
        assert np.ptp(way) > 0.05 * one["clearance_um"]
    (run,) = body["measured"]
    assert [one["bearing"] for one in run["bearings"]] == ["B1", "B2"]
    assert run["speed"] == pytest.approx(SPEED * 30.0 / np.pi)
    found = outcome()
    exact = modelled_lines(model_at(TRAIN, found.coordinates, found.point, found.covariance), speed=SPEED)
    assert exact is not None
    drifted = MOVED * np.linspace(-0.5, 0.5, COUNT)
    for number, one in enumerate(run["bearings"]):
        assert one["x_um"] == pytest.approx(1e6 * exact.position[:, number, 0], abs=1e-3)
        moved = drifted if number == 1 else 0.0
        assert one["y_um"] == pytest.approx(1e6 * (exact.position[:, number, 1] + moved), abs=1e-3)


def test_a_machine_without_films_has_no_centreline(api: Api) -> None:
    detail = problem(api.get("/identifications/2/model/centreline"), 422)["detail"]
    assert "no journal's place is known" in detail or "kept no model" in detail


def test_coefficients_of_films_come_over_speed_with_their_bands(api: Api) -> None:
    body = api.value("/identifications/1/model/film-coefficients", points=10)
    found = outcome()
    model = model_at(TRAIN, found.coordinates, found.point, found.covariance)
    low, high = (rpm_to_rad_per_s(reported_rpm(TRAIN)[place]) for place in (0, -1))
    exact = film_coefficients(model, speed=np.linspace(low, high, 10))
    assert rpm_to_rad_per_s(body["speed"][0]) == pytest.approx(low)
    assert rpm_to_rad_per_s(body["speed"][-1]) == pytest.approx(high)
    told = [(one["bearing"], curve) for one in body["bearings"] for curve in one["coefficients"]]
    assert len(told) == len(exact) == 32
    for (bearing, curve), expected in zip(told, exact, strict=True):
        assert (bearing, curve["term"], curve["unit"]) == (expected.bearing, expected.term, expected.unit)
        for name in ("value", "lower", "upper"):
            assert curve[name] == pytest.approx(getattr(expected, name), rel=1e-5)


def test_a_machine_without_films_has_no_film_coefficients(api: Api) -> None:
    detail = problem(api.get("/identifications/2/model/film-coefficients"), 422)["detail"]
    assert "no coefficients follow from them" in detail or "kept no model" in detail
