"""Line protocol: what a reader by InfluxData's rules gets back is what was written."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.export.line_protocol import line
from tests.plant import few_examples


def parsed(text: str) -> tuple[str, dict[str, str], str, int]:
    """Measurement, tags, fields as they stand and time, split at separators that are not escaped."""
    parts: list[str] = []
    word, at = "", 0
    quoted = False
    while at < len(text):
        one = text[at]
        if quoted and one == "\\":
            word, at = word + text[at : at + 2], at + 2
            continue
        if not quoted and one == "\\" and text[at + 1 : at + 2] in (",", "=", " "):
            word, at = word + text[at : at + 2], at + 2
            continue
        quoted ^= one == '"' and len(parts) == 1
        if one == " " and not quoted:
            parts.append(word)
            word = ""
        else:
            word += one
        at += 1
    head, fields = parts
    pieces: list[str] = []
    piece, at = "", 0
    while at < len(head):
        if head[at] == "\\" and head[at + 1 : at + 2] in (",", "=", " "):
            piece, at = piece + "\0" + head[at + 1], at + 2
            continue
        if head[at] == ",":
            pieces.append(piece)
            piece = ""
        else:
            piece += head[at]
        at += 1
    pieces.append(piece)
    tags = {}
    for one in pieces[1:]:
        marks = [place for place, char in enumerate(one) if char == "=" and (place == 0 or one[place - 1] != "\0")]
        assert len(marks) == 1, one
        tags[one[: marks[0]].replace("\0", "")] = one[marks[0] + 1 :].replace("\0", "")
    return pieces[0].replace("\0", ""), tags, fields, int(word)


def test_a_point_is_one_line() -> None:
    told = line(
        "a b", {"machine": "pump=7, old", "unit": ""}, {"value": 1.5, "lower": math.nan, "n": 3, "text": 'a "b"\\'}, 17
    )
    assert told == r'a\ b,machine=pump\=7\,\ old value=1.5,n=3i,text="a \"b\"\\" 17'


@pytest.mark.parametrize("fields", [{}, {"value": None}, {"value": math.nan, "upper": math.inf}])
def test_a_point_without_a_value_is_none(fields: dict[str, float | int | str | None]) -> None:
    assert line("a", {}, fields, 0) is None


@few_examples
@given(st.text(min_size=1), st.text(), st.floats(allow_nan=False, allow_infinity=False))
def test_any_name_comes_back(name: str, value: str, number: float) -> None:
    told = line("m", {name: value}, {"value": number}, 5)
    assert told is not None
    assert "\n" not in told
    _, tags, fields, moment = parsed(told)
    plain = {"".join("_" if ord(c) < 32 or ord(c) == 127 else "/" if c == "\\" else c for c in one) for one in (name, value)}
    assert set(tags) <= plain
    assert set(tags.values()) <= plain
    assert (float(fields.removeprefix("value=")), moment) == (number, 5)
