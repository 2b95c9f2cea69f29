"""Files that are hostile or broken are refused with words, at once, whatever they hold."""

import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from formats.files import bounded_yaml, document_files
from formats.files.document_files import UnreadableFile, read_machine, read_yaml
from tests.paths import EXAMPLES

LETTERS = "abcdefghij"
LAUGHS = "a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n" + "".join(
    f"{one}: &{one} [{', '.join([f'*{before}'] * 10)}]\n" for before, one in zip(LETTERS, LETTERS[1:], strict=False)
)
"""Ten thousand million values in a few hundred characters."""
WRONG = {
    "aliases without end": (LAUGHS + "shafts: *j", "values, as some stand for many others; at most 1000000"),
    "an alias in itself": ("shafts: &s [*s]", "stands for something in which it lies itself"),
    "a deep list": ("[" * 50_000, "too deep in each other"),
    "deep fields": ("\n".join(" " * number + "a:" for number in range(3000)), "too deep in each other"),
    "a month that there is not": ("name: 2020-13-45", "month must be in 1..12"),
    "an hour that there is not": ("name: 2020-01-01T99:99:99Z", "hour must be in 0..23"),
    "a number of 5,000 digits": (f"mass: {'9' * 5000}", "5000 digits"),
    "a tag of a number": ("id: !!int abc", "neither YAML nor JSON"),
    "a tag of a truth": ("id: !!bool abc", "neither YAML nor JSON"),
    "a tag of a time": ("id: !!timestamp abc", "neither YAML nor JSON"),
    "no character": ('id: "\\U00110000"', "neither YAML nor JSON"),
    "a tag of Python": ("id: !!python/object/apply:os.getpid []", "could not determine a constructor"),
}


@pytest.fixture
def usual_depth() -> Iterator[None]:
    """Python's own limit of recursion: what builds the documentation raises it for all that runs in its process."""
    before = sys.getrecursionlimit()
    sys.setrecursionlimit(1000)
    yield
    sys.setrecursionlimit(before)


@pytest.mark.usefixtures("usual_depth")
@pytest.mark.parametrize("what", WRONG)
def test_what_is_no_document_is_refused_with_words_and_at_once(tmp_path: Path, what: str) -> None:
    text, words = WRONG[what]
    path = tmp_path / "machine.yaml"
    path.write_text(text)
    began = time.perf_counter()
    with pytest.raises(UnreadableFile, match=words) as refused:
        read_machine(path)
    assert time.perf_counter() - began < 5.0
    assert str(path) in str(refused.value)


def test_a_recording_in_the_documents_place_is_named(tmp_path: Path) -> None:
    recording = tmp_path / "run.csv"
    recording.write_text("speed,B1L_um_pp\n3000,12\n")
    with pytest.raises(UnreadableFile, match=r"run\.csv is a table and not a machine document: the document comes first"):
        read_machine(recording)


def test_a_file_that_is_too_large_is_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "machine.yaml"
    path.write_text("a: 1")
    monkeypatch.setattr(document_files, "LARGEST_BYTES", 3)
    with pytest.raises(UnreadableFile, match="has 4 bytes; at most 3"):
        read_yaml(path)


def test_reading_ends_at_the_first_value_too_many(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "machine.yaml"
    path.write_text("schema_version: 1\n" + "".join(f"k{number}: {number}\n" for number in range(9)))
    monkeypatch.setattr(bounded_yaml, "MOST_WRITTEN", 21)  # the whole, ten names, ten values
    assert len(read_yaml(path)) == 10
    path.write_text(path.read_text() + "more: 1\n[")  # what is behind it is not looked at any more
    with pytest.raises(UnreadableFile, match=r"machine\.yaml, line 11: more values are written than the 21 a file may have"):
        read_yaml(path)


def test_aliases_of_an_honest_document_are_taken(tmp_path: Path) -> None:
    text = (EXAMPLES / "motor-compressor.yaml").read_text()
    path = tmp_path / "machine.yaml"
    path.write_text("x-places: &p [1, 2]\n")
    assert read_yaml(path) == {"x-places": [1, 2]}
    path.write_text("first: &p [1, 2]\nsecond: *p\n")
    assert read_yaml(path) == {"first": [1, 2], "second": [1, 2]}
    path.write_text(text)
    assert read_machine(path).id == "motor-compressor"


def test_a_field_that_is_written_twice_is_named_with_its_lines(tmp_path: Path) -> None:
    file = tmp_path / "machine.yaml"
    file.write_text(
        "id: pump\nnoise: {relative: 0.01}\nbearings:\n- {id: B1, kxx: 1.8e+7, kxx: 9.9e+7}\nnoise: {relative: 0.05}\n"
    )
    with pytest.raises(
        UnreadableFile, match=r"machine\.yaml, line 5: 'noise' is written a second time, after line 2: keep one"
    ):
        read_yaml(file)
    file.write_text('{"id": "pump", "bearings": [{"kxx": 1,\n"kxx": 2}]}')
    with pytest.raises(UnreadableFile, match=r"line 2: 'kxx' is written a second time, after line 1"):
        read_yaml(file)
    file.write_text("a: &a {k: 1}\nb: &b {c: 2}\nd: {<<: *a, k: 3}\ne: [{<<: [*a, *b]}]\n")
    assert read_yaml(file)["d"] == {"k": 3}
