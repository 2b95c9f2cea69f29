"""Sweeps of the film plant against a closed form and against the motion itself, integrated in time."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from tests.estimator.sweeps import MASS, UNBALANCE, single_mass_envelope
from tests.film_plant import sweep as sweep_module
from tests.film_plant.arrays import Complexes, Floats
from tests.film_plant.assembly import assemble
from tests.film_plant.motor_compressor import motor_compressor
from tests.film_plant.plant import RPM
from tests.film_plant.statics import Equilibrium, Statics
from tests.film_plant.sweep import ReducedTrain, sweep
from tests.film_plant.train import Bearing, ConstantOil, Disc, Material, Shaft, Train


def test_the_envelope_of_a_single_mass_is_the_closed_form() -> None:
    frequency, ratio, first, rate = 100.0, 0.02, 80.0, 5.0
    oil = ConstantOil(0.01)
    bearings = tuple(Bearing(0, station, 0.1, 0.05, 1e-4, oil) for station in (0.0, 0.4))
    disc = Disc(0, 0.2, MASS, 0.1, 0.2, UNBALANCE)
    train = Train((Shaft(((0.2, 0.1), (0.2, 0.1))),), (disc,), bearings, (), Material(1e14, 1e-3, 0.3))
    speed = np.linspace(50.0, 150.0, 8)
    each = np.broadcast_to(np.eye(2), (speed.size, 2, 2, 2)) * MASS / 2
    nothing = np.zeros((speed.size, 2))
    films = Equilibrium(
        speed,
        np.zeros((speed.size, 2, 2)),
        np.zeros((speed.size, 2, 2)),
        frequency**2 * each,
        2 * ratio * frequency * each,
        nothing,
        nothing,
    )
    found = sweep(assemble(train), films, first=first, last=120.0, rate=rate, samples=41)
    since = np.concatenate([[0.0], sweep_module.LEAD_S + found.time])
    due = single_mass_envelope(
        since, first=first - rate * sweep_module.LEAD_S, rate=rate, natural_frequency=frequency, damping_ratio=ratio
    )[1:]
    assert np.abs(due - found.steady[:, 0]).max() > 0.3 * np.abs(due).max()
    assert np.abs(found.instant[:, 0] - due).max() < 1e-3 * np.abs(due).max()
    assert np.abs(found.instant[:, 1] + 1j * due).max() < 1e-3 * np.abs(due).max()


def test_a_slow_sweep_is_steady_and_a_mean_lies_between() -> None:
    train = motor_compressor("flexible")
    films = Statics(train).follow(np.linspace(2300.0, 2700.0, 20) * RPM)
    fast, slow = (
        sweep(assemble(train), films, first=2500 * RPM, last=2440 * RPM, rate=rate * RPM, samples=4) for rate in (40.0, 10.0)
    )
    away = [np.abs(one.instant - one.steady).max() / np.abs(one.steady).max() for one in (fast, slow)]
    assert away[0] == pytest.approx(4 * away[1], rel=0.05)
    assert away[0] > 1e-3
    bent = np.abs(fast.averaged - fast.instant).max() / np.abs(fast.steady).max()
    assert bent < 0.02


@pytest.mark.long
def test_the_envelope_is_that_of_the_motion_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    """The real equations of motion with all coefficients following the speed, and the 1× of one revolution."""
    monkeypatch.setattr(sweep_module, "HIGHEST_MODE", 3.0)
    train = motor_compressor("flexible")
    matrices = assemble(train)
    films = Statics(train).follow(np.linspace(2000.0, 2800.0, 40) * RPM)
    found = sweep(matrices, films, first=2600 * RPM, last=2590 * RPM, rate=80 * RPM, samples=5)
    due = _demodulated(ReducedTrain(matrices, 3.0 * 2600 * RPM), films, found.time[2])
    assert np.abs(found.instant[2] - found.steady[2]).min() > 2e-3 * np.abs(due).min()
    assert np.abs(found.instant[2] - due).max() < 3e-5 * np.abs(due).max()


def _demodulated(train: ReducedTrain, films: Equilibrium, time: float) -> Complexes:
    """1× phasors around a time of a sweep from 2600 rpm at t = 0 with -80 rpm/s, begun in steady running."""
    rate, start, size = -80 * RPM, -sweep_module.LEAD_S, len(train.mass)
    stiffness, damping = (CubicSpline(films.speed, one) for one in (films.stiffness, films.damping))
    inverse = np.linalg.inv(train.mass)

    def speed(t: float) -> float:
        return 2600 * RPM + rate * t

    def angle(t: Floats) -> Floats:
        return 2600 * RPM * t + rate * t**2 / 2

    def change(t: float, state: Floats) -> Floats:
        w = speed(t)
        place, moving = state[:size], state[size:]
        force = ((w**2 - 1j * rate) * train.unbalance * np.exp(1j * angle(np.asarray(t)))).real
        journals = (train.relative @ np.stack([place, moving], axis=1)).reshape(-1, 2, 2)
        films = stiffness(w) @ journals[:, :, :1] + damping(w) @ journals[:, :, 1:]
        held = train.stiffness @ place + (train.damping + w * train.gyroscopic) @ moving + films.ravel() @ train.relative
        return np.concatenate([moving, inverse @ (force - held)])

    first = speed(start)
    steady = train.steady(first, stiffness(first), damping(first)) * np.exp(1j * angle(np.asarray(start)))
    state = np.concatenate([steady.real, (1j * first * steady).real])
    turn = np.pi / speed(time)
    instants = np.linspace(time - turn, time + turn, 401)
    solution = solve_ivp(change, (start, time + turn), state, method="DOP853", rtol=1e-7, atol=1e-13, t_eval=instants)
    assert solution.success
    wave = np.exp(1j * angle(instants))
    beside = instants - time
    columns = np.stack([wave.real, -wave.imag, beside * wave.real, -beside * wave.imag], axis=1)
    seen = solution.y[:size].T @ train.relative.T
    fitted = np.linalg.lstsq(columns, seen, rcond=None)[0]
    return np.asarray(fitted[0] + 1j * fitted[1])
