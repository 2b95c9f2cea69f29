"""Finds the example machines and their recordings: beside the packages in a checkout, within this one in a wheel."""

from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]


def examples_folder() -> Path:
    """Return the folder of the example machines' documents; their recordings are in `recordings`."""
    installed = PACKAGE / "examples"
    return installed if installed.is_dir() else PACKAGE.parent / "examples"


def found_example(path: Path) -> Path:
    """Return the path, or the library's own file of this name where `examples/…` names none."""
    if path.parts[:1] != ("examples",) or path.exists():
        return path
    example = examples_folder().joinpath(*path.parts[1:])
    return example if example.is_file() else path
