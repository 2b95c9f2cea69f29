"""Warnings of documents that are taken: what is probably a mistake is named with its place and what is usual."""

import pytest

from estimator.machine.document import parse_machine
from estimator.machine.document_warnings import document_warnings
from tests.estimator.statics.films import motor_compressor_document


@pytest.mark.parametrize("axis", ["x", "y"])
def test_an_elevation_beyond_the_clearance_is_named(axis: str) -> None:
    said = motor_compressor_document("flexible")
    clearance = said["bearings"][2]["film"]["radial_clearance"]
    said["bearings"][2]["film"][f"elevation_{axis}"] = -1.5 * clearance
    (warning,) = document_warnings(parse_machine(said))
    assert warning.field == f"bearings[2].film.elevation_{axis}"
    assert warning.words.startswith(f"{-1.5e6 * clearance:.4g} µm is more than the radial clearance, {1e6 * clearance:.4g} µm")
    said["bearings"][2]["film"][f"elevation_{axis}"] = 0.9 * clearance
    assert document_warnings(parse_machine(said)) == ()
