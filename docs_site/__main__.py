"""Builds the site: `python -m docs_site [FOLDER] [--short]`; FOLDER is build/site by default, opened without a server."""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

from docs_site.source import write_source

ROOT = Path(__file__).parents[1]


def main() -> int:
    """Write the site's source and build it; status 1 for a broken link, a missing page or a wrong anchor."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, nargs="?", default=ROOT / "build" / "site")
    parser.add_argument("--short", action="store_true", help="notebooks in the short form in which the tests run them")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="rundown-site-") as folder:
        configuration = write_source(Path(folder), short=options.short)
        built = build(configuration, options.folder.resolve())
    if built.returncode == 0:
        print(f"built: {options.folder / 'index.html'}")
    else:
        print(built.stderr, file=sys.stderr)
    return built.returncode


def build(configuration: Path, folder: Path) -> subprocess.CompletedProcess[str]:
    """Build the site from its written source into a folder, and return how that ended, with what it said."""
    # Not with --quiet: what is not said is not counted, and no broken link would fail.
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--config-file", str(configuration)]
    return subprocess.run([*command, "--site-dir", str(folder)], check=False, capture_output=True, text=True)


if __name__ == "__main__":
    sys.exit(main())
