"""The API over identifications whose models are asked for."""

import math
from collections.abc import Iterator

import numpy as np
import pytest

from estimator.phasors.channel_status import ChannelStatus
from estimator.units import rpm_to_rad_per_s
from estimator.updated_model.fitted_response import fitted_response
from storage.encoding.sample_blocks import Samples
from storage.encoding.source_key import SourceKey
from storage.machines import machines
from storage.measurements import runs
from storage.measurements import samples as sample_store
from tests.api_in_process import Api
from tests.databases import Databases, opened
from tests.plant import KEY, SECOND, START, machine, store_identification
from tests.service.api.findings.modelled import COUNT, LEFT_OUT, MAXIMUM_RPM, NOISE, outcome, values


@pytest.fixture(scope="module")
def modelled(databases: Databases, plant_template: str, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Api]:
    """An API over two identifications: one of a stored run that the model made, with noise, and one of a deleted run."""
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
