"""Finds the example machines and their recordings: beside the packages in a checkout, within this one in a wheel."""

from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]


def examples_folder() -> Path:
    """Return the folder of the example machines' documents; their recordings are in `recordings`."""
    installed = PACKAGE / "examples"
    return installed if installed.is_dir() else PACKAGE.parent / "examples"


def found_example(path: Path) -> Path:
    """Return the path, or the library's own file of this name where `examples/…` names none."""
    if not _names_example(path):
        return path
    example = examples_folder().joinpath(*path.parts[1:])
    return example if example.is_file() else path


def is_own_example(path: Path) -> bool:
    """Return whether a file is one of the library's own examples."""
    return path.resolve().is_relative_to(examples_folder().resolve())


def example_names() -> list[str]:
    """Return the examples as paths name them: documents, then recordings."""
    folder = examples_folder()
    files = [*sorted(folder.glob("*.yaml")), *sorted(folder.glob("recordings/*.csv"))]
    return [str(Path("examples") / one.relative_to(folder)) for one in files]


def _names_example(path: Path) -> bool:
    return path.parts[:1] == ("examples",) and not path.exists()


def other_examples(path: Path) -> str:
    """Return a clause that lists the examples, where a path is written as one of them and names no file; else nothing."""
    return f"; the examples that come with Rundown are {', '.join(example_names())}" if _names_example(path) else ""
