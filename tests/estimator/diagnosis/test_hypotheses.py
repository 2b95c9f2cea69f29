"""Tests what a diagnosis chooses from, for documents that fix, tie or vary parameters in every way that they may."""

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
import yaml

from estimator.diagnosis.hypotheses import Hypothesis, hypotheses
from estimator.fit.problem.coordinates import Coordinates
from estimator.machine.document import Machine, parse_machine
from estimator.rotor.condensation import condense
from tests.estimator.trains import ROOT


@cache
def document() -> dict[str, Any]:
    found: dict[str, Any] = yaml.safe_load((ROOT / "examples" / "sealed-pump.yaml").read_text(encoding="utf-8"))
    return found


def sealed_pump(*rules: dict[str, object], **changes: object) -> Machine:
    return parse_machine(document() | {"parameters": list(rules)} | changes)


def considered(machine: Machine) -> dict[tuple[str, str], Hypothesis]:
    """Return the hypotheses by kind and element; require that each can change something."""
    train = condense(machine, speed=np.array([50.0, 200.0]), direction=np.ones(2))
    coordinates = Coordinates.of(train, unbalance_scale=1e-4)
    typical = coordinates.point(np.full(coordinates.size, 0.1))
    amplitude = dict.fromkeys(machine.channels, 1e-5)
    found = hypotheses(machine, train.unknowns, coordinates.names, typical=typical, amplitude=amplitude)
    for one in found:
        assert one.variants
        assert all(np.any(columns != 0.0) for columns in one.variants)
        assert np.all(np.any(one.rising != 0.0, axis=1))
    return {(one.kind, one.element): one for one in found}


def kinds(found: Sequence[tuple[str, str]], element: str) -> set[str]:
    return {kind for kind, at in found if at == element}


def test_everything_that_a_document_names_can_change_a_seal_too() -> None:
    found = list(considered(sealed_pump()))
    assert kinds(found, "coupling.C1") == {"misalignment", "coupling"}
    assert all(kinds(found, element) == {"bearing"} for element in ("bearing.B1", "bearing.B4", "seal.N1"))
    assert kinds(found, "disc.impeller") == {"unbalance"}


def test_what_is_fixed_or_tied_to_another_element_does_not_change_by_itself() -> None:
    fixed = {"fixed": True}
    found = considered(sealed_pump({"names": "bearing.B2.*", **fixed}, {"names": "bearing.B4.*", "tied_to": "bearing.B3"}))
    assert ("bearing", "bearing.B2") not in found
    assert ("bearing", "bearing.B4") not in found
    assert found["misalignment", "coupling.C1"].elements == {"coupling.C1", "bearing.B3"}
    assert kinds(list(considered(sealed_pump({"names": "coupling.C1.*", **fixed}))), "coupling.C1") == set()
    stiff = {"names": "coupling.C1.k*", **fixed}
    assert kinds(list(considered(sealed_pump(stiff))), "coupling.C1") == {"coupling"}
    bearings = ({"names": f"bearing.B{number}.*", **fixed} for number in (2, 3))
    assert kinds(list(considered(sealed_pump(*bearings))), "coupling.C1") == {"coupling"}
    direct = [{"names": f"bearing.B1.{name}", **fixed} for name in ("kxx", "kyy", "cxx", "cyy")]
    assert kinds(list(considered(sealed_pump(*direct))), "bearing.B1") == {"bearing"}


def test_an_unbalance_that_is_fixed_is_none() -> None:
    found = list(considered(sealed_pump({"names": "disc.wheel.unbalance", "fixed": True})))
    assert kinds(found, "disc.wheel") == set()
    assert kinds(found, "disc.impeller") == {"unbalance"}
    assert not any(kind == "unbalance" for kind, _ in considered(sealed_pump({"names": "disc.*", "fixed": True})))


def test_a_machine_without_couplings_or_with_one_bearing_has_the_rest() -> None:
    shaft = next(one for one in document()["shafts"] if one["id"] == "pump")

    def of_the_pump(part: str) -> list[dict[str, Any]]:
        return [one for one in document()[part] if one["shaft"] == "pump"]

    parts = {part: of_the_pump(part) for part in ("discs", "bearings", "probes")}
    alone = considered(sealed_pump(shafts=[shaft], couplings=[], seals=[], **parts))
    assert {kind for kind, _ in alone} == {"bearing", "unbalance"}
    one = considered(sealed_pump(shafts=[shaft], couplings=[], seals=[], **(parts | {"bearings": parts["bearings"][:1]})))
    assert [element for kind, element in one if kind == "bearing"] == ["bearing.B3"]
