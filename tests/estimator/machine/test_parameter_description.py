"""Tests what names of parameters say."""

import pytest

from estimator.machine.parameter_description import describe, is_direct


@pytest.mark.parametrize(
    ("name", "element", "quantity", "knot", "component"),
    [
        ("bearing.B1.kxx", "bearing.B1", "kxx", None, None),
        ("bearing.B1.kxy@1500.5rpm", "bearing.B1", "kxy", "1500.5rpm", None),
        ("disc.D1.unbalance.real", "disc.D1", "unbalance", None, "real"),
        ("probe.P-1.run_out.imaginary", "probe.P-1", "run_out", None, "imaginary"),
        ("material.steel.density", "material.steel", "density", None, None),
        ("critical_speed.1", "critical_speed.1", "", None, None),
        ("machine", "machine", "", None, None),
    ],
)
def test_parts_of_a_name(name: str, element: str, quantity: str, knot: str | None, component: str | None) -> None:
    said = describe(name)
    assert (said.element, said.quantity, said.knot, said.component) == (element, quantity, knot, component)


def test_terms_and_what_is_beside_them() -> None:
    said = describe("coupling.C1.kx_phiy@900rpm")
    assert said.term is not None
    assert (said.term.quantity, said.term.force, said.term.motion) == ("coupled stiffness", "x", "phiy")
    assert [said.of_term(one) for one in said.term.beside] == ["coupling.C1.kxx@900rpm", "coupling.C1.k_phiy@900rpm"]
    assert describe("disc.D1.unbalance").term is None


def test_what_is_positive_by_nature() -> None:
    positive = {"bearing.B.kyy", "seal.S.mxx", "coupling.C.c_phix", "bearing.B.cxx@500rpm", "material.M.young_modulus"}
    others = {"bearing.B.cxy", "coupling.C.ky_phix", "disc.D.unbalance.real", "probe.P.gain.real", "critical_speed.1"}
    assert {name for name in positive | others if is_direct(name)} == positive
