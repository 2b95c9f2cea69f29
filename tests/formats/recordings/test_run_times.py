"""Times of recordings: dates and times are read as seconds since the first, and times that no run has are refused."""

from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from formats.files.document_files import UnreadableFile
from formats.recordings.recorded_runs import read_runs
from formats.recordings.recording import read_recording, states_start
from formats.recordings.run_times import doubted_times, moment_of, seconds_since_first, wrong_times
from storage.clock import from_datetime, now, to_datetime
from tests.formats.recordings.test_recording import ROWS, refused, write
from tests.plant import SECOND, START, machine

DATED = tuple(f"{time}{row[row.index(',') :]}" for time, row in zip(("00", "00.5", "01.25"), ROWS, strict=True))


def dated(folder: Path, *, before: str = "2025-01-01 12:00:", behind: str = "", **changes: Any) -> Path:
    """A recording with dates and times; its sidecar does not say when it was taken unless the changes do."""
    rows = tuple(f"{before}{row.replace(',', f'{behind},', 1)}" for row in DATED)
    return write(folder, rows=rows, **{"start": None, **changes})


@pytest.mark.parametrize(
    ("before", "behind"),
    [
        ("2025-01-01 12:00:", ""),
        ("2025-01-01T12:00:", ""),
        ("2025-01-01T12:00:", "Z"),
        ("2025-01-01 14:00:", "+02:00"),
    ],
)
def test_dates_and_times_are_read_as_when_the_rows_were_taken(tmp_path: Path, before: str, behind: str) -> None:
    path = dated(tmp_path, before=before, behind=behind)
    first = from_datetime(datetime(2025, 1, 1, 12))
    assert read_recording(path).time_ns == [first, first + SECOND // 2, first + SECOND + SECOND // 4]
    assert states_start(path)


def test_a_stated_start_counts_more_than_the_clock_of_the_table(tmp_path: Path) -> None:
    path = dated(tmp_path, start="2023-11-14T22:13:20Z")
    assert read_recording(path).time_ns == [START, START + SECOND // 2, START + SECOND + SECOND // 4]
    assert states_start(path)
    assert not states_start(write(tmp_path, start=None))


def test_a_local_clock_ahead_of_utc_is_no_wrong_one(tmp_path: Path) -> None:
    soon = to_datetime(now() + 3600 * 2 * SECOND).strftime("%Y-%m-%d %H:%M:")
    ((recorded, _),), left_out = read_runs(machine(), [dated(tmp_path, before=soon)])
    assert (recorded.speed.size, left_out) == (3, [])


def test_dates_over_a_day_are_not_asked_for_milliseconds(tmp_path: Path) -> None:
    """Those of seconds are."""
    days = dated(tmp_path)
    text = days.read_text().replace("2025-01-01 12:00:01.25", "2025-01-02 12:00:00")
    days.write_text(text.replace("2025-01-01 12:00:00.5", "2025-01-01 23:30:00"))
    assert read_runs(machine(), [days])[1] == []


def test_a_time_zone_in_some_rows_is_one_line(tmp_path: Path) -> None:
    path = dated(tmp_path)
    path.write_text(path.read_text().replace("12:00:00,", "12:00:00Z,"))
    assert refused(path) == (
        f"{path}, column 'seconds': '2025-01-01 12:00:00+00:00' has a time zone and '2025-01-01 12:00:00.500000' has none: "
        "write it in all rows or none"
    )


def test_what_is_no_time_is_told_both_kinds(tmp_path: Path) -> None:
    path = dated(tmp_path)
    path.write_text(path.read_text().replace("2025-01-01 12:00:00.5,", "noon,"))
    assert refused(path).endswith(
        "line 3: 'noon' in column 'seconds' is no time: write seconds since the start, or dates and times such as "
        "2025-01-01 00:00:00"
    )


def test_times_that_no_run_has_are_refused_of_sweeps(tmp_path: Path) -> None:
    behind = [row[row.index(",") :] for row in ROWS]
    same = write(tmp_path, rows=tuple(f"0.0{one}" for one in behind))
    assert refused(same).endswith(
        "column 'seconds': all times are the same, 0 s: give those of the samples, or leave the column out"
    )
    back = tuple(f"{3 - row}{one}" for row, one in enumerate(behind))
    assert "go backwards, as from 3 s in row 1 to 2 s in row 2: put the rows in order" in refused(write(tmp_path, rows=back))
    assert len(read_recording(write(tmp_path, rows=back, kind="dwells")).time_ns) == 3


def test_times_are_judged_as_a_whole() -> None:
    assert wrong_times(np.array([0.0, 0.0, 1.0, 1.0, 2.0])) == ""
    assert wrong_times(np.array([5.0])) == ""
    assert wrong_times(np.array([0.0, 3.0, 2.0, 4.0])) == ""
    assert doubted_times(np.array([0.0, 3.0, 2.0, 4.0]), np.arange(4.0)) == [
        "the times go back 1 time, first from row 2 to row 3, from 3 s to 2 s: are the rows in order of time?"
    ]
    hours = np.array([0.0, 20e3, 36e3])
    assert doubted_times(hours, np.arange(3.0)) == ["the run lasts 10 h: are its times in milliseconds? Write seconds"]
    assert doubted_times(hours, np.array([300.0, 400.0, 310.0])) == []  # of a machine that works
    assert doubted_times(hours, np.arange(3.0), dated=True) == []
    days = np.arange(200.0) * 3.0 / 86400.0
    (short,) = doubted_times(days, np.arange(200.0))
    assert short == "the run lasts 0.0069 s: are its times in days, hours or minutes? Write seconds"
    (jump,) = doubted_times(np.append(np.arange(200.0), 4000.0), np.arange(201.0))
    assert jump.startswith("row 201 comes 3.8e+03 s behind row 200, others 1 s behind each other: are these one run")


def test_clocks_that_are_set_back_are_asked_for() -> None:
    back = np.array([0.0, 297.0, -3300.0, -3297.0])
    assert "offset from UTC with each date where the clock was set back, or leave" in wrong_times(back, dated=True)
    assert "UTC" not in wrong_times(back)
    (doubt,) = doubted_times(np.array([0.0, 297.0, 294.0, 600.0]), np.arange(4.0), dated=True)
    assert doubt.endswith(
        "in order of time? Put them so, give the offset from UTC with each date where the clock was set back"
    )


def test_moments_of_several_zones_are_counted_in_one() -> None:
    """A clock that is set to winter time does not go back."""
    moments = [moment_of("2025-10-26T02:59:59+02:00"), None, moment_of("2025-10-26T02:00:01+01:00")]
    assert seconds_since_first(moments) == [0.0, None, 2.0]
    assert moment_of("soon") is moment_of(5.0) is None
    with pytest.raises(ValueError, match="has a time zone and"):
        seconds_since_first([moment_of("2025-10-26T02:59:59"), moment_of("2025-10-26T02:00:01+01:00")])


def test_columns_of_words_that_a_sidecar_does_not_name_are_told(tmp_path: Path) -> None:
    rows = tuple(f"{row},{stamp},{value}" for row, stamp, value in zip(ROWS, ("", "ok", "ok"), "123", strict=True))
    path = write(tmp_path, header="seconds,rpm,size,phase,size_2,phase_2,status,number", rows=rows)
    _, left_out = read_runs(machine(), [path])
    assert left_out == [f"{path}, column 'status' left out: no numbers, and not named by its sidecar"]
    _, left_out = read_runs(machine(), [write(tmp_path, header=path.read_text().splitlines()[0], rows=rows, kind="dwells")])
    assert left_out == []


def test_channels_in_small_letters_are_those_of_the_document(tmp_path: Path) -> None:
    channels = [{"channel": "b2x", "amplitude": "size", "phase": "phase"}]
    ((recorded, _),), left_out = read_runs(machine(), [write(tmp_path, channels=channels)])
    assert left_out == []
    assert np.abs(recorded.phasor[:, 0]) == pytest.approx([50e-6, 50.5e-6, 51e-6])
    channels = [{"channel": "B2Z", "amplitude": "size", "phase": "phase"}]
    with pytest.raises(ValueError, match=r"has no channel B2Z; it has B2X, .*; did you mean 'B2"):
        read_runs(machine(), [write(tmp_path, channels=channels)])
    both = [{"channel": one, "amplitude": f"size{two}", "phase": f"phase{two}"} for one, two in (("B2X", ""), ("b2x", "_2"))]
    with pytest.raises(UnreadableFile, match="lists channel B2X twice, in capitals and in small letters"):
        read_runs(machine(), [write(tmp_path, channels=both)])


def test_a_header_behind_a_comment_sign_is_one(tmp_path: Path) -> None:
    assert read_recording(write(tmp_path, header="# seconds,rpm,size,phase,size_2,phase_2")).speed == [2990.0, 2980.0, 2970.0]


def test_a_misspelt_column_gets_those_like_it(tmp_path: Path) -> None:
    assert "; did you mean 'rpm'? A run is nothing without the keyphasor's speed" in refused(write(tmp_path, speed="rmp"))
