"""What follows from an identification, through the API: against the estimator itself, closed forms and simulated runs."""

import asyncio
import json
import math
import socket
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import httpx
import numpy as np
import pytest
from anyio.to_thread import current_default_thread_limiter

from benchmarks.serving import serving
from estimator.fit.problem.coordinates import Coordinates
from estimator.machine.rules import Noise
from estimator.modes.critical_speed import critical_speed_table
from estimator.phasors.channel_status import ChannelStatus
from estimator.rotor.condensation import condense
from estimator.units import rpm_to_rad_per_s
from estimator.updated_model.coupling_loads import coupling_forces
from estimator.updated_model.fitted_response import fitted_response
from estimator.updated_model.model import model_at
from service.api.application import THREADS
from service.api.cache.computation_queue import MAXIMUM_WAITING_PER_CALLER
from service.api.conventions.problems import Unsuitable
from storage.database.engine import Database
from storage.encoding.sample_blocks import Samples
from storage.encoding.source_key import SourceKey
from storage.machines import machines
from storage.measurements import runs
from storage.measurements import samples as sample_store
from storage.tables.findings import EstimateRow
from tests.api_in_process import PREFIX, Api, fields, problem
from tests.databases import Databases, opened
from tests.paths import ROOT
from tests.plant import KEY, SECOND, START, identification, machine, store_identification, wait_until

MICROMETRE_PP = 5e-7
NOISE = Noise(relative=0.02, floor=2e-7)
COUNT = 80
MAXIMUM_RPM = 4500.0
"""Critical speeds are looked for up to a quarter above it: there are some."""
MODEL = ("critical-speeds", "campbell", "modes", "misalignment-force", "balancing")
LEFT_OUT = (7, 2)
"""A sample and channel that the source calls bad."""


def values(*, stiffer: float = 1.0) -> tuple[tuple[str, ...], np.ndarray, np.ndarray]:
    """Coordinates of the machine, values near the document's, and a covariance; the coupling stiffer by a factor."""
    train = condense(machine(), speed=np.ones(1), direction=np.ones(1))
    coordinates = Coordinates.of(train, unbalance_scale=1.0)
    theta = np.zeros(coordinates.size)
    first = coordinates.names.index("disc.D1.unbalance.real")
    theta[first : first + 4] = (8e-4, 5e-4, -1e-3, 1.5e-3)
    theta[coordinates.names.index("coupling.C1.kxx")] = math.log(stiffer)
    size = np.where(np.char.find(coordinates.names, "unbalance") >= 0, 1e-5, 0.01 * coordinates.unit)
    half = np.diag(size) @ np.linalg.cholesky(0.9 * np.eye(coordinates.size) + 0.1)
    return coordinates.names, coordinates.point(theta), half @ half.T


def outcome(**how: Any) -> Any:
    names, point, covariance = values(**how)
    return identification(
        coordinates=names,
        point=point,
        covariance=covariance,
        noise=NOISE,
        speed_minimum=rpm_to_rad_per_s(400.0),
        speed_maximum=rpm_to_rad_per_s(2900.0),
    )


@pytest.fixture(scope="module")
def api(databases: Databases, plant_template: str, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Api]:
    """Over two identifications: one of a stored run that the model made, with its noise, and one of a run that is gone."""
    names, point, covariance = values()
    speed = np.linspace(rpm_to_rad_per_s(2900.0), rpm_to_rad_per_s(400.0), COUNT)
    turning = np.ones(COUNT)
    exact = fitted_response(machine(), names, point, covariance, speed=speed, direction=turning).value
    rng = np.random.default_rng(11)
    error = np.sqrt((NOISE.relative * np.abs(exact)) ** 2 + NOISE.floor**2)
    noise = error * (rng.standard_normal(exact.shape) + 1j * rng.standard_normal(exact.shape)) / math.sqrt(2)
    status = np.full(exact.shape, ChannelStatus.GOOD, np.uint8)
    status[LEFT_OUT] = ChannelStatus.BAD
    held = Samples(
        time=START + SECOND * np.arange(COUNT, dtype=np.int64),
        speed=speed,
        direction=turning.astype(np.int8),
        phasor=exact + noise,
        status=status,
        scatter=np.full(exact.shape, np.nan),
        second=np.full(exact.shape, complex(np.nan, np.nan)),
    )
    with opened(databases, plant_template, tmp_path_factory.mktemp("model") / "model.db") as database:
        with database.transaction() as session:
            machines.revise(session, machine(speed_range={"minimum_rpm": 300, "maximum_rpm": MAXIMUM_RPM}))
            sample_store.add_block(session, SourceKey(KEY.machine, "monitor", 1), revision=2, first_sequence=0, samples=held)
            row = runs.open_run(session, KEY.machine, revision=2, kind="run-down", direction=1, time_first=START)
            runs.close(row, samples=held, state=runs.CLOSED, reason="the speed left the speed range")
            store_identification(session, outcome(), run_id=row.id, revision=2)
            store_identification(session, outcome(stiffer=1.1), run_id=99, measured_at=START + SECOND, revision=2)
        yield Api(database)


def test_critical_speeds_are_those_of_the_updated_model(api: Api) -> None:
    body = api.value("/identifications/1/model/critical-speeds")
    model = model_at(machine(), *values())
    expected = critical_speed_table(
        model.scaled_machine, highest=rpm_to_rad_per_s(1.25 * MAXIMUM_RPM), coefficients=model.coefficients
    )
    assert body["units"]["speed"] == "rpm"
    assert len(expected) == 4
    assert [rpm_to_rad_per_s(one["speed"]) for one in body["critical_speeds"]] == pytest.approx(
        [one.speed for one in expected]
    )
    for one in body["critical_speeds"]:
        assert one["upper"] - one["lower"] == pytest.approx(2 * 1.959964 * one["standard_error"], rel=1e-6)
        assert 0 < one["standard_error"] < 0.02 * one["speed"]
    hertz = api.value("/identifications/1/model/critical-speeds", units="hz")
    for one, other in zip(hertz["critical_speeds"], body["critical_speeds"], strict=True):
        assert 60 * one["speed"] == pytest.approx(other["speed"])
        assert 60 * one["standard_error"] == pytest.approx(other["standard_error"])


def test_the_curves_of_the_campbell_diagram_cross_at_the_critical_speeds(api: Api) -> None:
    body = api.value("/identifications/1/model/campbell", points=30)
    assert len(body["speed"]) == len(body["synchronous_hz"]) == 30
    assert body["speed"][0] == 0.0
    crossings = 0
    for curve in body["curves"]:
        above = [f > s for f, s in zip(curve["frequency_hz"], body["synchronous_hz"], strict=True) if f is not None]
        crossings += sum(one != other for one, other in zip(above[:-1], above[1:], strict=True))
    assert crossings == len(body["critical_speeds"])
    assert all(one["standard_error"] is None for one in body["critical_speeds"])


def test_modes_have_their_shapes_along_the_train(api: Api) -> None:
    body = api.value("/identifications/1/model/modes", rpm=1500)
    assert body["speed"] == pytest.approx(1500)
    frequencies = [one["frequency_hz"] for one in body["modes"]]
    assert frequencies == sorted(frequencies)
    assert frequencies
    for mode in body["modes"]:
        assert [shaft["shaft"] for shaft in mode["shafts"]] == ["S1", "S2"]
        assert mode["shafts"][0]["at"][0] == 0.0
        assert mode["shafts"][1]["at"][0] == pytest.approx(0.6)
        assert max(max(shaft["semi_major"]) for shaft in mode["shafts"]) == pytest.approx(1.0)
        assert 0 < mode["standard_error_hz"] < 0.02 * mode["frequency_hz"]


def test_misalignment_force_over_speed_with_its_band(api: Api) -> None:
    body = api.value("/identifications/1/model/misalignment-force", from_rpm=500, to_rpm=2500, points=21)
    assert body["speed"] == pytest.approx(np.linspace(500, 2500, 21).tolist())
    (expected,) = coupling_forces(model_at(machine(), *values()), speed=rpm_to_rad_per_s(1.0) * np.linspace(500, 2500, 21))
    (load,) = body["couplings"]
    for name in ("force_x", "force_y", "moment_x", "moment_y"):
        band = getattr(expected, name)
        assert load[name]["amplitude"] == pytest.approx(band.amplitude.tolist())
        assert load[name]["upper"] == pytest.approx(band.upper.tolist())
        assert load[name]["phase"] == pytest.approx(np.mod(-np.degrees(band.phase), 360.0).tolist())


def test_balancing_leaves_less_vibration(api: Api) -> None:
    body = api.value("/identifications/1/model/balancing")
    assert [one["plane"] for one in body["corrections"]] == ["D1", "D2"]
    # Two planes, two unbalances: the correction takes both away.
    added = [one["unbalance_g_mm"] * np.exp(1j * math.radians(one["angle_deg"])) for one in body["corrections"]]
    assert added == pytest.approx([-(8e-4 + 5e-4j) * 1e6, -(-1e-3 + 1.5e-3j) * 1e6], rel=1e-6)
    before = np.array([one["amplitude"] for one in body["before"]])
    after = np.array([one["amplitude"] for one in body["after"]])
    assert np.max(after) < 1e-6 * np.max(before)
    one = api.value("/identifications/1/model/balancing", plane="D2")
    assert [correction["plane"] for correction in one["corrections"]] == ["D2"]
    squares = [sum(np.sum(np.square(channel["amplitude"])) for channel in one[when]) for when in ("before", "after")]
    assert squares[1] < squares[0]


def test_no_correction_is_proposed_for_speeds_outside_the_documents_range(api: Api) -> None:
    body = api.value("/identifications/1/model/balancing")
    assert 300 <= min(body["speed"]) <= max(body["speed"]) <= MAXIMUM_RPM
    answer = api.get("/identifications/1/model/balancing", to_rpm=MAXIMUM_RPM + 1)
    assert "lies outside the document's speed range" in problem(answer, 422)["detail"]


def test_bode_of_measured_points_fit_and_residuals(api: Api) -> None:
    body = api.value("/identifications/1/bode", points=50)
    assert body["slow_roll_subtracted"] is False
    names, point, covariance = values()
    speed = np.linspace(rpm_to_rad_per_s(400.0), rpm_to_rad_per_s(2900.0), 50)
    band = fitted_response(machine(), names, point, covariance, speed=speed, direction=np.ones(50))
    assert [one["channel"] for one in body["fitted"]["channels"]] == list(machine().channels)
    for number, one in enumerate(body["fitted"]["channels"]):
        assert one["amplitude"] == pytest.approx((band.amplitude[:, number] / MICROMETRE_PP).tolist())
        assert one["upper"] == pytest.approx((band.upper[:, number] / MICROMETRE_PP).tolist())
        assert one["phase"] == pytest.approx(np.mod(-np.degrees(band.phase[:, number]), 360.0).tolist())
    (measured,) = body["measured"]
    assert measured["run"] == 1
    assert measured["time"][0] == "2023-11-14T22:13:20.000000Z"
    sigmas = np.array([one["residual_sigma"] for one in measured["channels"]], dtype=float)
    # Squares of a complex error over its expected square: exponential with mean 1.
    used = np.array([one["used"] for one in measured["channels"]])
    assert np.mean(sigmas[used] ** 2) == pytest.approx(1.0, abs=4 / math.sqrt(used.sum()))
    assert not used[LEFT_OUT[1], LEFT_OUT[0]]
    assert np.count_nonzero(~used) == 1


def test_bode_of_an_identification_whose_runs_are_gone_is_the_fit_alone(api: Api) -> None:
    body = api.value("/identifications/2/bode", points=10)
    assert body["measured"] == []
    assert len(body["fitted"]["speed"]) == 10


@pytest.mark.parametrize(
    ("units", "speed", "amplitude", "phase"),
    [
        ("mil_pp,hz,deg_lead", 1 / 60, 1 / 25.4, lambda lag: -lag % 360),
        ("m_p,rad_s,rad_lag", math.pi / 30, 5e-7, math.radians),
        ("um_p", 1.0, 0.5, lambda lag: lag),
    ],
)
def test_phasors_and_speeds_come_in_the_units_asked_for(
    api: Api, units: str, speed: float, amplitude: float, phase: Any
) -> None:
    usual = api.value("/identifications/1/bode", points=10)
    body = api.value("/identifications/1/bode", points=10, units=units)
    assert set(units.split(",")) <= set(body["units"].values())
    assert body["fitted"]["speed"] == pytest.approx([speed * one for one in usual["fitted"]["speed"]])
    for one, other in zip(body["measured"][0]["channels"], usual["measured"][0]["channels"], strict=True):
        for name in ("amplitude", "residual"):
            assert one[name] == pytest.approx([amplitude * value for value in other[name]])
        assert one["phase"] == pytest.approx([phase(value) for value in other["phase"]])
        assert one["residual_sigma"] == other["residual_sigma"]


ASKED = {"parameter": "coupling.C1.kxx", "rpm": 1000}
"""Of those that take it."""


def takes_units() -> dict[str, tuple[str, dict[str, Any]]]:
    """Every path whose answer is declared to come in units that are asked for, such units, and what else is asked."""
    found = {}
    for path, item in json.loads((ROOT / "docs" / "openapi.json").read_text())["paths"].items():
        takes = {one["name"]: one for one in item.get("get", {}).get("parameters", [])}
        if "units" in takes and not path.endswith("/centreline"):  # of machines on oil films only
            units = "n_um" if "n_um" in takes["units"]["description"] else "hz,mil_p,rad_lead"
            found[path.removeprefix(PREFIX)] = units, {name: value for name, value in ASKED.items() if name in takes}
    return found


@pytest.mark.parametrize(("path", "units", "asked"), [(path, *rest) for path, rest in takes_units().items()])
def test_units_that_are_taken_change_values(api: Api, path: str, units: str, asked: dict[str, Any]) -> None:
    place = path.format(identification_id=1, run_id=1, machine_id=KEY.machine)
    plain, other = numbers(api.value(place, **asked)), numbers(api.value(place, **asked, units=units))
    assert other != plain


def numbers(answer: Any) -> list[float]:
    """All numbers of an answer, in order."""
    if isinstance(answer, dict | list):
        parts = answer.values() if isinstance(answer, dict) else answer
        return [number for part in parts for number in numbers(part)]
    return [answer] if isinstance(answer, float) else []


@pytest.mark.parametrize("units", ["furlong", "um_pp,mil_pp", "", "rpm,,um_pp", "rpm " * 20])
def test_units_that_are_none_are_refused(api: Api, units: str) -> None:
    assert fields(api.get("/identifications/1/bode", units=units)) == ["query.units"]


def test_correlation_names_what_the_data_hardly_tell_apart(plant: Database) -> None:
    names = ("bearing.B1.kxx", "bearing.B1.kyy", "bearing.B1.cxx")
    covariance = np.array([[1.0, -0.95, 0.0], [-0.95, 1.0, 0.0], [0.0, 0.0, 0.0]])
    with plant.transaction() as session:
        one = identification(coordinates=names, covariance=covariance, point=np.zeros(3))
        store_identification(session, one, run_id=1)
    body = Api(plant).value("/identifications/1/correlation")
    assert body["coordinates"] == list(names)
    assert np.array(body["correlation"]) == pytest.approx(np.array([[1, -0.95, 0], [-0.95, 1, 0], [0, 0, 0]]))
    assert body["strongest"] == [{"one": names[0], "other": names[1], "correlation": pytest.approx(-0.95)}]


def test_two_identifications_are_compared(api: Api) -> None:
    body = api.value("/identifications/compare", first=1, second=2)
    changed = {one["parameter"]: one for one in body["changes"]}
    stiffness = changed["coupling.C1.kxx"]
    assert stiffness["per_cent"] == pytest.approx(10.0)
    assert stiffness["sigma"] == pytest.approx(math.log(1.1) / (0.01 * math.sqrt(2)), rel=1e-6)
    assert all(one["sigma"] == pytest.approx(0.0) for name, one in changed.items() if name != "coupling.C1.kxx")
    elements = {one["element"]: one for one in body["elements"]}
    assert elements["coupling.C1"]["probability"] < 1e-6
    assert elements["bearing.B1"]["distance"] == pytest.approx(0.0, abs=1e-9)
    assert (body["only_first"], body["only_second"]) == ([], [])


def test_what_one_of_two_does_not_determine_has_no_change(api: Api) -> None:
    name = "coupling.C1.kxx"
    with api.database.transaction() as session:
        row = session.get(EstimateRow, (2, name))
        assert row is not None
        row.value, row.reason = None, "the data do not determine it"
    changes = {one["parameter"]: one for one in api.value("/identifications/compare", first=1, second=2)["changes"]}
    assert changes.pop(name) == {"parameter": name, "first": pytest.approx(2e6), "second": None} | {
        "per_cent": None,
        "sigma": None,
    }
    assert all(one["second"] is not None for one in changes.values())


def test_identifications_of_two_machines_are_not_compared(plant: Database) -> None:
    api = Api(plant)
    with plant.transaction() as session:
        row = store_identification(session, outcome(), run_id=1)
        other = store_identification(session, outcome(), run_id=2)
        machines.create(session, machine(id="fan-2"))
        other.machine_id = "fan-2"
        first, second = row.id, other.id
    detail = problem(api.get("/identifications/compare", first=first, second=second), 422)["detail"]
    assert "one machine" in detail


@pytest.mark.parametrize("path", [*(f"model/{name}" for name in MODEL), "bode", "correlation"])
def test_of_an_unknown_identification_there_is_nothing(api: Api, path: str) -> None:
    problem(api.get(f"/identifications/77/{path}"), 404)
    problem(api.get("/identifications/compare", first=1, second=77), 404)


def test_an_identification_of_an_older_release_has_no_model(plant: Database) -> None:
    with plant.transaction() as session:
        row = store_identification(session, outcome(), run_id=1)
        row.point = None
        number = row.id
    assert "older release" in problem(Api(plant).get(f"/identifications/{number}/bode"), 409)["detail"]


@pytest.mark.parametrize(
    ("path", "word"),
    [
        ("model/misalignment-force?from_rpm=2000&to_rpm=1000", "from_rpm"),
        ("model/balancing?plane=D9", "D9"),
        ("model/balancing?plane=D1&plane=D1", "once"),
        ("bode?run=99", "run 99"),
    ],
)
def test_what_cannot_be_made_is_refused_in_words(api: Api, path: str, word: str) -> None:
    assert word in problem(api.get(f"/identifications/1/{path}"), 422)["detail"]


@pytest.mark.parametrize("what", ["balancing", "misalignment-force"])
@pytest.mark.parametrize(
    ("asked", "speeds"),
    [
        ({"from_rpm": 2000, "to_rpm": 1000}, "2000 and 1000"),
        ({"from_rpm": 5000}, "5000 and 2900"),
        ({"to_rpm": 100}, "400 and 100"),
    ],
)
def test_an_empty_range_of_speeds_is_refused_by_its_own_name(
    api: Api, what: str, asked: dict[str, float], speeds: str
) -> None:
    detail = problem(api.get(f"/identifications/1/model/{what}", **asked), 422)["detail"]
    assert detail.startswith(f"from_rpm must be below to_rpm, not {speeds}: ")
    assert "400 and 2900" in detail
    assert "plane" not in detail


@pytest.mark.parametrize(
    ("path", "field"),
    [
        ("model/modes?rpm=0", "query.rpm"),
        ("model/modes?rpm=NaN", "query.rpm"),
        ("model/campbell?points=1000", "query.points"),
        ("model/misalignment-force?from_rpm=-1", "query.from_rpm"),
        ("model/misalignment-force?from_rpm=5e-324", "query.from_rpm"),
        ("bode?points=1", "query.points"),
    ],
)
def test_bounds_of_what_may_be_asked(api: Api, path: str, field: str) -> None:
    assert fields(api.get(f"/identifications/1/{path}")) == [field]


def test_the_drawing_is_to_scale(api: Api) -> None:
    body = api.value("/machines/pump-7/drawing")
    assert body["length"] == pytest.approx(1.2)
    assert [(one["begin"], one["end"]) for one in body["sections"]] == [(0.0, 0.6), (0.6, 1.2)]
    assert {one["element"]: one["at"] for one in body["bearings"]} == pytest.approx(
        {"bearing.B1": 0.0, "bearing.B2": 0.6, "bearing.B3": 0.6, "bearing.B4": 1.2}
    )
    assert [one["at"] for one in body["discs"]] == pytest.approx([0.3, 0.9])
    (coupling,) = body["couplings"]
    assert (coupling["element"], coupling["driver"], coupling["driven"], coupling["at"]) == ("coupling.C1", "S1", "S2", 0.6)
    assert [(one["channel"], one["at"]) for one in body["probes"]][-1] == ("B3Y", 0.6)
    problem(api.get("/machines/nobody/drawing"), 404)


@pytest.mark.parametrize("what", ["campbell", "balancing"])
def test_whoever_waits_for_a_model_keeps_nobody_from_reading(api: Api, what: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Be it a computation of tenths of a second: each one holds a thread, and there are few."""
    finish = threading.Event()

    def computed(*_: Any, **__: Any) -> Any:
        assert finish.wait(60)
        raise Unsuitable("enough")

    for name in ("_diagram", "_correction"):
        monkeypatch.setattr(f"service.api.findings.model.{name}", computed)
    asked = 6 * THREADS

    async def ask() -> list[httpx.Response]:
        transport = httpx.ASGITransport(api.app)
        async with (
            api.app.router.lifespan_context(api.app),
            httpx.AsyncClient(transport=transport, base_url="http://x") as client,
        ):
            url = f"{PREFIX}/identifications/1/model/{what}"
            waiting = [asyncio.create_task(client.get(url, params={"points": 60 + one})) for one in range(asked)]
            try:
                async with asyncio.timeout(30):
                    while sum(one.done() for one in waiting) < asked - MAXIMUM_WAITING_PER_CALLER:
                        await asyncio.sleep(0.01)
                    other = await client.get(f"{PREFIX}/machines/{machine().id}/revisions")
                assert other.status_code == 200
            finally:
                finish.set()
            answers = await asyncio.gather(*waiting)
            assert current_default_thread_limiter().total_tokens == THREADS
            return answers

    answers = asyncio.run(ask())
    assert {one.status_code for one in answers} == {422, 503}
    assert {one.headers["Retry-After"] for one in answers if one.status_code == 503} == {"5"}


def test_computations_whose_clients_have_gone_are_given_up(api: Api, monkeypatch: pytest.MonkeyPatch) -> None:
    """And neither they nor those whose clients wait keep the server from stopping."""
    other, finish = Api(api.database), threading.Event()
    cache = other.app.state.computed_cache

    def computed(*_: Any, **__: Any) -> Any:
        assert finish.wait(60)
        raise Unsuitable("enough")

    monkeypatch.setattr("service.api.findings.model._diagram", computed)
    with ThreadPoolExecutor(1) as threads:
        with serving(other.app) as url:

            def ask(points: int) -> socket.socket:
                client = socket.create_connection(("127.0.0.1", int(url.split(":")[2].split("/")[0])))
                target = f"{PREFIX}/identifications/1/model/campbell?points={points}"
                client.sendall(f"GET {target} HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n".encode())
                return client

            def answer(client: socket.socket) -> bytes:
                try:
                    return client.recv(65536)
                finally:
                    finish.set()

            first = ask(20)
            wait_until(lambda: cache.waiting == 1)
            clients = [ask(21 + number) for number in range(4)]
            wait_until(lambda: cache.waiting == 5)
            for one in clients:
                one.close()
            wait_until(lambda: cache.waiting == 1)
            again = ask(60)
            wait_until(lambda: cache.waiting == 2)
            told = threads.submit(answer, again)
        assert told.result().startswith(b"HTTP/1.1 503")
    for one in (first, again):
        one.close()


@pytest.mark.parametrize("what", [*(f"model/{one}" for one in MODEL), "bode"])
def test_a_process_of_its_own_answers_the_same(api: Api, what: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """As for a long train."""
    expected = api.value(f"/identifications/1/{what}")
    monkeypatch.setattr("service.api.findings.model_process.LONG_ELEMENTS", 0)
    other, computed = Api(api.database), []
    compute = other.app.state.model_process.compute

    def counted(work: Any, *arguments: Any) -> Any:
        computed.append(work)
        return compute(work, *arguments)

    monkeypatch.setattr(other.app.state.model_process, "compute", counted)
    try:
        assert other.value(f"/identifications/1/{what}") == expected
        assert len(computed) == 1
        assert other.value(f"/identifications/1/{what}") == expected
        assert len(computed) == 1
    finally:
        other.app.state.model_process.close()


def test_what_does_not_suit_is_told_by_a_process_of_its_own_as_well(api: Api, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("service.api.findings.model_process.LONG_ELEMENTS", 0)
    other = Api(api.database)
    try:
        answer = other.get("/identifications/1/model/balancing", plane=["nowhere"])
        assert "nowhere" in problem(answer, 422)["detail"]
    finally:
        other.app.state.model_process.close()
