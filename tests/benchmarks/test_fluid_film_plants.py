"""Numbers of plants of the benchmark on films: one of most parts, another of some, and the page says which."""

import argparse

import pytest

from benchmarks.fluid_film.__main__ import counted
from benchmarks.fluid_film.page import counts
from benchmarks.fluid_film.report_line import ReportLine


def test_a_number_is_for_all_parts_or_for_one() -> None:
    assert counted("20") == ("", 20)
    assert counted("wrong-documents=6") == ("wrong-documents", 6)
    for wrong in ("six", "0", "wrong-document=6", "wrong-documents=", "-3"):
        with pytest.raises(argparse.ArgumentTypeError, match="from 1 on"):
            counted(wrong)


def test_the_page_says_how_many_plants_each_part_had() -> None:
    found: dict[str, list[ReportLine]] = {name: [] for name in ("films", "film-fits", "other-trains", "wrong-documents")}
    plants = {"films": 100, "film-fits": 20, "other-trains": 20, "wrong-documents": 6}
    assert counts(found, plants) == "20 wrong-documents=6"
