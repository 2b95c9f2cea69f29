"""Floods of requests that are valid and dear: what one person asks for over and over, and a store in which it can be asked."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from estimator.phasors.channel_status import ChannelStatus
from estimator.units import rpm_to_rad_per_s
from estimator.updated_model.fitted_response import fitted_response
from storage.database.engine import Database
from storage.encoding.sample_blocks import Samples
from storage.encoding.source_key import SourceKey
from storage.machines import balancings, machines
from storage.measurements import runs
from storage.measurements import samples as sample_store
from tests.plant import KEY, SECOND, START, machine, store_identification
from tests.service.api.findings.modelled import MAXIMUM_RPM, outcome, values

FloodRequest = tuple[str, str, dict[str, Any] | None]
"""Method, path and body of a request."""
SAMPLES, BLOCKS = 1000, 20
TRIALS = 12
MACHINE = f"/machines/{KEY.machine}"
BY = {"by": "impatient"}
RESPONSE = 2e-2 * np.exp(0.7j)
"""Response to a trial weight at each probe [m/(kg m)]."""


@dataclass(frozen=True)
class Prepared:
    """Numbers of what is stored: two identifications, a run, a balancing with its trials; where webhooks go."""

    identifications: tuple[int, int]
    run: int
    balancing: int
    target: str


def prepare(store: Database, target: str) -> Prepared:
    """Store a machine with samples, runs, two identifications and a balancing that has its trial runs."""
    train = machine(speed_range={"minimum_rpm": 300, "maximum_rpm": MAXIMUM_RPM})
    names, point, covariance = values()
    speed = np.linspace(rpm_to_rad_per_s(2900.0), rpm_to_rad_per_s(400.0), SAMPLES)
    exact = fitted_response(machine(), names, point, covariance, speed=speed, direction=np.ones(SAMPLES)).value
    rng = np.random.default_rng(3)

    def held(begin: int, added: float = 0.0) -> Samples:
        noise = 1e-7 * (rng.standard_normal(exact.shape) + 1j * rng.standard_normal(exact.shape))
        return Samples(
            time=begin + SECOND // 10 * np.arange(SAMPLES, dtype=np.int64),
            speed=speed,
            direction=np.ones(SAMPLES, np.int8),
            phasor=exact + noise + added * RESPONSE,
            status=np.full(exact.shape, ChannelStatus.GOOD, np.uint8),
            scatter=np.full(exact.shape, np.nan),
            second=np.full(exact.shape, complex(np.nan, np.nan)),
        )

    with store.transaction() as session:
        machines.create(session, train)
        found = []
        for number in range(TRIALS + 1):
            begin = START + number * 3600 * SECOND
            row = runs.open_run(session, train.id, revision=1, kind="run-down", direction=1, time_first=begin)
            samples = held(begin, 8e-4 if number else 0.0)
            runs.close(row, samples=samples, state=runs.CLOSED, reason="the speed left the speed range")
            found.append(row.id)
        for number in range(BLOCKS):
            source = SourceKey(train.id, "monitor", 1)
            block = held(START + number * 3600 * SECOND)
            sample_store.add_block(session, source, revision=1, first_sequence=number * SAMPLES, samples=block)
        pair = tuple(store_identification(session, outcome(stiffer=1 + 0.1 * n), run_id=found[n]).id for n in range(2))
        begun = balancings.add(session, train.id, revision=1, initial=found[:1], by="Ada", comment="", disc_scale={})
        weights = [{"disc": "D1", "g_mm": 800.0, "angle_deg": 0.0}]
        balancings.record(begun, balancings.TRIED, trials=[{"run": one, "weights": weights, "by": "Ada"} for one in found[1:]])
        return Prepared((pair[0], pair[1]), found[0], begun.id, target)


def _models(stored: Prepared, number: int) -> FloodRequest:
    model = f"/identifications/{stored.identifications[number % 2]}/model"
    return (
        "GET",
        (
            f"{model}/campbell?points={10 + number % 110}",
            f"{model}/modes?rpm={500 + number}",
            f"{model}/balancing?from_rpm=500&to_rpm={1500 + number}&points=500",
            f"{model}/misalignment-force?from_rpm=500&to_rpm={1500 + number}&points=500",
            f"/identifications/{stored.identifications[0]}/bode?points={1000 + number}",
        )[number % 5],
        None,
    )


def _plots(stored: Prepared, number: int) -> FloodRequest:
    first, second = stored.identifications
    return (
        "GET",
        (
            f"/runs/{stored.run}/orbits?rpm={500 + number}",
            f"/runs/{stored.run}/phasors?slow_roll=none",
            f"/runs/{stored.run}/quality",
            f"{MACHINE}/vibration/trend?limit={10 + number % 190}",
            f"/identifications/compare?first={first}&second={second}",
            f"/identifications/{first}/correlation",
            f"{MACHINE}/deviations",
        )[number % 7],
        None,
    )


def _exports(_: Prepared, number: int) -> FloodRequest:
    names = "&".join(f"parameter={one}" for one in ("coupling.C1.kxx", "bearing.B1.kxx", "bearing.B2.cyy"))
    return (
        "GET",
        (
            f"{MACHINE}/samples?limit={10_000 - number}&format=csv",
            f"{MACHINE}/samples?limit={10_000 - number}",
            f"{MACHINE}/trends?{names}&max_points={1000 + number}&format=csv",
            f"{MACHINE}/trends?{names}&max_points={1000 + number}&format=parquet",
        )[number % 4],
        None,
    )


FLOODS: dict[str, Callable[[Prepared, int], FloodRequest]] = {
    "webhooks": lambda stored, number: (
        "POST",
        "/subscriptions",
        {"kind": "webhook", "name": f"hook {number}", "target": f"{stored.target}/{number}"},
    ),
    "webhooks by name": lambda _, number: (
        "POST",
        "/subscriptions",
        {"kind": "webhook", "name": f"unknown host {number}", "target": f"https://hook-{number}.example/"},
    ),
    "try-outs": lambda *_: ("POST", "/subscriptions/1/test", None),
    "calibrations": lambda stored, number: (
        "POST",
        f"{MACHINE}/model-calibrations",
        {"balancing": stored.balancing, "seed": number} | BY,
    ),
    "balancings": lambda stored, _: ("POST", f"{MACHINE}/balancings", {"runs": [stored.run]} | BY),
    "corrections": lambda stored, number: (
        "POST",
        f"{MACHINE}/balancings/{stored.balancing}/correction",
        {"grade": 1.0 + 0.01 * number} | BY,
    ),
    "models": _models,
    "plots": _plots,
    "exports": _exports,
    "reports": lambda _, number: ("GET", f"{MACHINE}/report.pdf?from=2023-11-{1 + number % 28:02d}T00:00:00Z", None),
}
"""A request by its number, by what it is a flood of."""
