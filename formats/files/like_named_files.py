"""Suggests files for one that is not there: those of its kind in its folder with a name like it."""

from pathlib import Path

from estimator.close_matches import did_you_mean


def like_named(path: Path) -> str:
    """Return a clause with the files that may have been meant; empty where there is the file, or none like it."""
    try:
        there = sorted(one.name for one in path.parent.iterdir() if one.suffix == path.suffix)
    except OSError:
        return ""
    return "" if path.name in there else did_you_mean(path.name, there)
