"""Equilibria at many speeds at once, against those followed from speed to speed."""

import numpy as np
import pytest

from estimator.machine.document import parse_machine
from estimator.statics.equilibrium import film_train
from estimator.statics.films_over_speed import equilibria_near
from estimator.units import rpm_to_rad_per_s
from tests.estimator.statics.films import motor_compressor_document
from tests.film_plant.motor_compressor import CouplingKind


@pytest.mark.parametrize("kind", ["rigid", "flexible"])
def test_equilibria_at_once_are_those_followed_one_by_one(kind: CouplingKind) -> None:
    train = film_train(parse_machine(motor_compressor_document(kind)))
    speeds = rpm_to_rad_per_s(1.0) * np.geomspace(1200.0, 3600.0, 6)
    highest = train.equilibrium(float(speeds[-1]))
    assert highest is not None
    found = equilibria_near(train, speeds, np.repeat(highest.position[None], speeds.size, axis=0))
    assert found is not None
    for one, followed in zip(found, train.follow(speeds), strict=True):
        assert followed is not None
        assert np.max(np.abs(one.position - followed.position) / train.scale[:, None]) < 1e-8
        for name in ("force", "stiffness", "damping"):
            expected = getattr(followed, name)
            np.testing.assert_allclose(getattr(one, name), expected, rtol=1e-6, atol=1e-7 * np.abs(expected).max())
