"""`make lint` refuses what takes a struct for a dataclass: mypy alone does not, and it ends in a TypeError."""

import os
import re
from pathlib import Path

import mypy.api
import pytest

from tests.paths import ROOT

CODE = """
import dataclasses
import msgspec

class Speed(msgspec.Struct):
    rpm: float

@dataclasses.dataclass
class Angle:
    degrees: float

def changed[S: Speed](one: S, either: Speed | Angle) -> None:
    dataclasses.replace(one, rpm=1.0)  # wrong
    dataclasses.replace(Angle(1.0), degrees=2.0)
    dataclasses.asdict(either)  # wrong
    dataclasses.fields(Speed)  # wrong
    vars(one)  # wrong
    vars(Angle(1.0))
    msgspec.structs.replace(one, rpm=1.0)
"""


def test_structs_are_refused_where_only_dataclasses_may_stand(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    file = tmp_path / "calls.py"
    file.write_text(CODE)
    options = ["--config-file", "pyproject.toml", "--cache-dir", os.devnull, "--num-workers", "0", "--python-version", "3.12"]
    said, _, _ = mypy.api.run([*options, str(file)])
    found = [int(line) for line in re.findall(r"calls\.py:(\d+): error: .* is a struct, no dataclass", said)]
    assert found == [number for number, line in enumerate(CODE.splitlines(), 1) if line.endswith("# wrong")], said
