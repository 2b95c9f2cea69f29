"""The comparison of pictures of the page: the same again, a small and a large change, another height, and a new view."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from benchmarks.page_screens import ACCEPTED, BLOCK_PX, SIZES, compare, views_in

HEIGHT, WIDTH = 40 * BLOCK_PX, 30 * BLOCK_PX


def picture(folder: Path, name: str, *, dark_rows: int = 0, height: int = HEIGHT) -> Path:
    """A light picture with so many dark rows of blocks at its top."""
    grey = np.full((height, WIDTH), 230, dtype=np.uint8)
    grey[: dark_rows * BLOCK_PX] = 40
    path = folder / f"{name}.png"
    Image.fromarray(grey).save(path)
    return path


def test_what_differs_is_counted_and_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    accepted = tmp_path / "accepted"
    names = ("same", "changed", "higher")
    assert compare([picture(tmp_path, one) for one in names], accepted, accept=True) == 0
    assert sorted(path.stem for path in accepted.glob("*.png")) == sorted(names)
    assert max(path.stat().st_size for path in accepted.glob("*.png")) < 4000
    capsys.readouterr()
    now = [
        picture(tmp_path, "same"),
        picture(tmp_path, "changed", dark_rows=2),
        picture(tmp_path, "higher", height=HEIGHT + 4 * BLOCK_PX),
        picture(tmp_path, "another"),
    ]
    assert compare(now, accepted, accept=False) == 3
    told = capsys.readouterr().out
    assert "same.png" not in told
    assert "5.0 % differs" in told
    assert "another.png" in told


def test_a_picture_of_every_view_is_accepted() -> None:
    views = [f"{size}-{view}" for size in SIZES for view in views_in(size)]
    assert sorted(path.stem for path in ACCEPTED.glob("*.png")) == sorted(views)
