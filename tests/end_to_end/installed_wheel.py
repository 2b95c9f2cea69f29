"""Builds the wheel as users get it, from a source distribution of the tracked files, and installs it elsewhere."""

import os
import shutil
import subprocess
import sys
import sysconfig
import venv
from collections.abc import Mapping
from pathlib import Path

from tests.paths import ROOT

BUILD_SDIST = "import sys; from setuptools.build_meta import build_sdist; print(build_sdist(sys.argv[1]))"
TIMEOUT_S = 600


def build_wheel(folder: Path) -> Path:
    """Return the wheel, built from the source distribution in folder/dist; the build's own needs come from the registry."""
    source, dist = folder / "source", folder / "dist"
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    for name in filter(None, listed.split("\0")):
        if (ROOT / name).is_file():
            (source / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, source / name)
    dist.mkdir()
    builder = make_environment(folder / "builder")
    run([builder, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "setuptools>=77"])
    run([builder, "-c", BUILD_SDIST, dist], folder=source)
    (archive,) = dist.glob("rotorundown-*.tar.gz")
    run([builder, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation", "--wheel-dir", dist, archive])
    (wheel,) = dist.glob("rotorundown-*.whl")
    return wheel


def make_environment(folder: Path, *, lent: bool = False) -> Path:
    """Make a fresh environment, and return its Python. lent: third-party packages are those of the running one."""
    venv.create(folder, with_pip=True, symlinks=True)
    python = folder / "bin" / "python"
    if lent:
        site = run([python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))"]).strip()
        # A path file adds a folder without obeying the path files in it: the checkout is not found through it.
        Path(site, "lent.pth").write_text(f"{sysconfig.get_path('purelib')}\n")
    return python


def run(command: list[str | Path], *, folder: Path | None = None, environment: Mapping[str, str] | None = None) -> str:
    """Run a command that does not find the checkout by PYTHONPATH; returns its output. Raises CalledProcessError."""
    clean = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PYTHONHOME")}
    done = subprocess.run(
        [str(one) for one in command],
        cwd=folder,
        env=clean | dict(environment or {}),
        stdout=subprocess.PIPE,
        stderr=sys.stderr,
        text=True,
        check=True,
        timeout=TIMEOUT_S,
    )
    return done.stdout
