"""A copy of the packages to write into, and to run."""

import contextlib
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from tests.paths import PACKAGES, ROOT

PAGE = "dashboard/src"


class PackageCopy:
    """A copy of the packages and the page in a folder.

    runs: whether Python runs it; what is compiled is copied then. touched: the files that were written since `forget`.
    """

    def __init__(self, folder: Path, *, runs: bool = True) -> None:
        self.folder = folder
        self.touched: set[str] = set()
        for package in PACKAGES:
            # What is compiled holds for the copies as well, but not what another process is writing just now.
            left_out = shutil.ignore_patterns("*.pyc.*" if runs else "__pycache__")
            shutil.copytree(ROOT / package, folder / package, ignore=left_out)
        shutil.copytree(ROOT / PAGE, folder / PAGE)

    def forget(self) -> None:
        """Begin to count the touched files anew."""
        self.touched.clear()

    def write(self, file: str, text: str) -> None:
        """Write a new file."""
        assert not (self.folder / file).exists(), file
        (self.folder / file).write_text(text)
        self.touched.add(file)

    def insert(self, file: str, behind: str, text: str) -> None:
        """Insert a text behind another, which the file holds once."""
        self._replace(file, behind, behind + text)
        self.touched.add(file)

    def append(self, file: str, text: str) -> None:
        """Append a text to a file."""
        path = self.folder / file
        path.write_text(path.read_text() + text)
        self.touched.add(file)

    @contextlib.contextmanager
    def altered(self, file: str, said: str, instead: str) -> Iterator[None]:
        """Replace what a file says once, for a while."""
        before = (self.folder / file).read_text()
        self._replace(file, said, instead)
        try:
            yield
        finally:
            (self.folder / file).write_text(before)

    def bring(self, file: str) -> None:
        """Copy a file of tests."""
        (self.folder / file).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / file, self.folder / file)

    def run(self, script: str) -> str:
        """Run a script on the copy; return what it printed."""
        environment = {**os.environ, "PYTHONPATH": f"{self.folder}{os.pathsep}{ROOT}", "PYTHONDONTWRITEBYTECODE": ""}
        done = subprocess.run(
            [sys.executable, "-c", script], cwd=self.folder, env=environment, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    def _replace(self, file: str, said: str, instead: str) -> None:
        path = self.folder / file
        content = path.read_text()
        assert content.count(said) == 1, f"{file} holds {said!r} {content.count(said)} times"
        path.write_text(content.replace(said, instead))
