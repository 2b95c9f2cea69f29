"""Name the place of a recording's sidecar, apart from its reader: who only asks for the place need not load the reader."""

from pathlib import Path

SHARED_SIDECAR = "columns.yaml"
"""Name of the sidecar that maps the columns of all recordings in a folder that have none of their own."""


def sidecar_of(path: Path) -> Path:
    """Return the sidecar of a recording: its own beside it, or the one that maps the columns of all files in its folder."""
    own, shared = path.with_suffix(".yaml"), path.parent / SHARED_SIDECAR
    return shared if shared.exists() and not own.exists() else own


def is_plain_table(path: Path) -> bool:
    """Return whether a path names a CSV file that has no sidecar."""
    return path.suffix.lower() == ".csv" and not sidecar_of(path).exists()
