"""Writes what an installation of the service consists of, as a software bill of materials (CycloneDX): `make sbom`.

The service is installed into a fresh environment from the wheel, whose packages are then listed, without those that only
install others.

    python -m benchmarks.sbom [FILE]
"""

import argparse
import json
import sys
import tempfile
from pathlib import Path

from rotorundown.environment.release import VERSION
from tests.end_to_end.installed_wheel import build_wheel, make_environment, run
from tests.paths import ROOT

FILE = ROOT / "build" / "rotorundown.cdx.json"


def bill_of_materials(folder: Path) -> dict[str, object]:
    """Return the bill of an installation made in a folder."""
    wheel = build_wheel(folder)
    python = make_environment(folder / "service")
    run([python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", f"{wheel}[service]"])
    run([python, "-m", "pip", "uninstall", "--quiet", "--yes", "setuptools", "pip"])
    listed = folder / "listed.json"
    about: list[str | Path] = ["--pyproject", ROOT / "pyproject.toml", "--output-file", listed]
    run([Path(sys.executable).with_name("cyclonedx-py"), "environment", *about, python])
    bill: dict[str, object] = json.loads(listed.read_text(encoding="utf-8"))
    return with_version(bill)


def with_version(bill: dict[str, object]) -> dict[str, object]:
    """Return a bill whose main component has its version, which pyproject.toml does not hold itself."""
    metadata = bill["metadata"]
    assert isinstance(metadata, dict)
    return bill | {"metadata": metadata | {"component": metadata["component"] | {"version": VERSION}}}


def main() -> int:
    """Write the bill, and say what is in it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path, nargs="?", default=FILE)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="rundown-sbom-") as folder:
        bill = bill_of_materials(Path(folder))
    options.file.parent.mkdir(parents=True, exist_ok=True)
    options.file.write_text(json.dumps(bill, indent=1) + "\n", encoding="utf-8")
    components = bill["components"]
    assert isinstance(components, list)
    print(f"{options.file}: rotorundown {VERSION} and {len(components)} packages")
    return 0


if __name__ == "__main__":
    sys.exit(main())
