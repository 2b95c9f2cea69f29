"""Hold the rooms of the page's sources: which may import which, without circles of files, and how large they are."""

import re
from collections import Counter
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from statistics import median

import pytest

SOURCES = Path(__file__).parents[2] / "dashboard" / "src"
MAY_IMPORT: dict[str, set[str]] = {
    "messages": {"declarations"},
    "browser": {"messages"},
    "format": {"declarations", "messages"},
    "declarations": set(),
    "findings": {"declarations", "format", "messages"},
    "schemas": {"findings"},
    "words": {"browser", "declarations", "findings", "format", "messages", "schemas"},
    "data": {"browser", "messages", "schemas"},
    "components": {"browser", "data", "format", "messages", "schemas"},
    "dialogs": {"components", "data", "declarations", "findings", "format", "messages", "schemas", "words"},
    "plots": {"browser", "format", "messages", "schemas"},
    "train": {"browser", "format", "messages", "plots", "schemas", "words"},
    "panels": {
        *("browser", "components", "data", "declarations", "dialogs", "findings", "format", "messages", "plots"),
        *("schemas", "words"),
    },
    "identification": {
        *("browser", "components", "data", "declarations", "format", "messages", "plots", "schemas", "words"),
    },
    "reports": {
        "components",
        "data",
        "format",
        "identification",
        "messages",
        "panels",
        "schemas",
        "train",
        "vibration",
        "words",
    },
    "vibration": {"browser", "components", "data", "format", "messages", "plots", "schemas", "words"},
    "pages": {
        *("browser", "components", "data", "dialogs", "format", "identification", "panels", "reports", "schemas"),
        *("messages", "train", "vibration", "words"),
    },
    "shell": {"browser", "components", "data", "dialogs", "format", "messages", "pages"},
    "styles": set(),
}
"""By room the rooms that its files may import. `main.tsx`, which starts the page, may import all."""
LARGEST, MEDIAN = 25, 12
"""Most files of a room, and of the median room."""
FROM = re.compile(r"""^(?:import|export)\b[^;"'()=]*?\bfrom\s*["'](\.[^"']*)["']""", re.MULTILINE)
BARE = re.compile(r"""\bimport\s*\(?\s*["'](\.[^"']*)["']""")
ENDINGS = ("", ".ts", ".tsx", "/index.ts", "/index.tsx")


def imports(file: Path, text: str) -> set[Path]:
    """Return the files of the page that a source imports; types count as well."""
    return {_resolved(file, name) for name in FROM.findall(text) + BARE.findall(text)}


def _resolved(file: Path, name: str) -> Path:
    target = file.parent / name
    found = [path for path in (target.parent / (target.name + ending) for ending in ENDINGS) if path.is_file()]
    assert found, f"{file}: imports {name}, which is no file"
    return found[0].resolve()


def forbidden(room: str, imported: set[str]) -> list[str]:
    """Return the rooms among those imported that a room may not import."""
    return sorted(imported - MAY_IMPORT[room] - {room})


@pytest.fixture(scope="module")
def graph() -> dict[Path, set[Path]]:
    """The sources of the page with the files that each imports."""
    files = [path.resolve() for path in SOURCES.rglob("*") if path.suffix in {".ts", ".tsx"}]
    return {file: imports(file, file.read_text()) for file in files}


def room_of(file: Path) -> str:
    """Return the room of a file; empty for those beside the rooms."""
    parts = file.relative_to(SOURCES.resolve()).parts
    return parts[0] if len(parts) > 1 else ""


def test_every_source_but_the_first_is_in_a_room(graph: dict[Path, set[Path]]) -> None:
    assert [file.name for file in graph if room_of(file) == ""] == ["main.tsx"]
    assert {path.name for path in SOURCES.iterdir() if path.is_dir()} == set(MAY_IMPORT), (
        "name a new room in MAY_IMPORT, with the rooms that it may import, and give it a README.md"
    )


def test_rooms_import_only_what_they_may(graph: dict[Path, set[Path]]) -> None:
    for file, imported in graph.items():
        room = room_of(file)
        if room:
            wrong = forbidden(room, {room_of(other) for other in imported})
            assert wrong == [], (
                f"{file.relative_to(SOURCES.resolve())} imports from {wrong}, which {room}/ may not import: move what it "
                f"needs to a room that both may import; only if the new arrow leads downwards, add it to MAY_IMPORT "
                f"and to {room}/README.md"
            )


def test_rooms_have_one_direction() -> None:
    try:
        tuple(TopologicalSorter(MAY_IMPORT).static_order())
    except CycleError as error:
        raise AssertionError(f"MAY_IMPORT allows a circle of rooms: {' -> '.join(error.args[1])}") from error


def test_no_files_import_each_other_in_a_circle(graph: dict[Path, set[Path]]) -> None:
    try:
        tuple(TopologicalSorter(graph).static_order())
    except CycleError as error:
        circle = " -> ".join(file.name for file in error.args[1])
        raise AssertionError(f"{circle}: move what they share, such as a type, to a file that imports neither") from error


@pytest.mark.parametrize("room", MAY_IMPORT)
def test_each_room_says_what_it_may_import(room: str) -> None:
    line = next(line for line in (SOURCES / room / "README.md").read_text().splitlines() if line.startswith("May import: "))
    assert set(re.findall(r"`(\w+)`", line)) == MAY_IMPORT[room]


def test_rooms_stay_small() -> None:
    sizes = {room: sum(path.suffix != ".md" for path in (SOURCES / room).iterdir()) for room in MAY_IMPORT}
    assert max(sizes.values()) <= LARGEST, sizes
    assert median(sizes.values()) <= MEDIAN, sizes


@pytest.mark.parametrize(
    "text",
    [
        'import { a } from "./router";',
        'import type {\n  A,\n  B,\n} from "./router";',
        'export { a } from "./router";',
        'import "./router";',
        'const late = await import("./router");',
    ],
)
def test_every_form_of_an_import_is_seen(text: str) -> None:
    file = SOURCES / "browser" / "new.ts"
    assert imports(file, text) == {(SOURCES / "browser" / "router.ts").resolve()}


def test_the_readme_lists_the_rooms_from_top_to_bottom() -> None:
    """Each room imports only from those below it, as its text says."""
    table = (SOURCES / "README.md").read_text().partition("|---|---|")[2].partition("\n\n")[0]
    order = re.findall(r"`(\w+)/`", table)
    assert sorted(order) == sorted(MAY_IMPORT)
    upwards = [f"{one} -> {other}" for one in order for other in MAY_IMPORT[one] if order.index(other) < order.index(one)]
    assert upwards == []


def test_no_arrow_is_left_unused(graph: dict[Path, set[Path]]) -> None:
    used = {(room_of(file), room_of(other)) for file, imported in graph.items() for other in imported}
    assert {(one, other) for one, others in MAY_IMPORT.items() for other in others} <= used


TYPE = re.compile(r"^(?:export )?(?:interface|type|class|enum) (\w+)", re.MULTILINE)


def test_no_two_types_have_one_name(graph: dict[Path, set[Path]]) -> None:
    """But for `Props`, as a component calls its own."""
    found = [(name, file.name) for file in graph for name in TYPE.findall(file.read_text()) if name != "Props"]
    assert len(found) > 100
    count = Counter(name for name, _ in found)
    assert [one for one in found if count[one[0]] > 1] == []


ELEMENT = r"(?:bearing|coupling|disc|pedestal|probe|seal|shaft)"
CUT = re.compile(rf"""\.split\("\."\)|\.startsWith\(["'`]{ELEMENT}\.""")
"""Code that takes a parameter's or an element's name apart, or asks of what kind of element it is."""


def test_names_of_parameters_are_taken_apart_in_one_place(graph: dict[Path, set[Path]]) -> None:
    assert {file.name for file in graph if CUT.search(file.read_text())} == {"names.ts"}
    assert all(map(CUT.search, ('one.startsWith("coupling.")', 'element.split(".")[0]')))


def test_an_arrow_upwards_is_seen() -> None:
    assert forbidden("plots", {"plots", "format", "panels"}) == ["panels"]
