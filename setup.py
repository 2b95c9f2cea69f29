"""What pyproject.toml cannot say: machines and recordings of `examples/` go into the wheel as `rotorundown/examples/`."""

from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

EXAMPLES = Path("examples")
PLACE = Path("rotorundown", "examples")


class BuildWithExamples(build_py):
    """Build the packages, and the examples beside them."""

    def run(self) -> None:
        """Build; an editable install finds the examples in the checkout."""
        super().run()
        if self.editable_mode:
            return
        for source, target in self._examples().items():
            self.mkpath(str(target.parent))
            self.copy_file(str(source), str(target))

    def get_outputs(self, include_bytecode: bool = True) -> list[str]:
        """Name what is built."""
        outputs: list[str] = super().get_outputs(include_bytecode)
        return outputs if self.editable_mode else [*outputs, *map(str, self._examples().values())]

    def _examples(self) -> dict[Path, Path]:
        files = [*EXAMPLES.glob("*.yaml"), *EXAMPLES.glob("recordings/*")]
        return {file: Path(self.build_lib) / PLACE / file.relative_to(EXAMPLES) for file in sorted(files)}


setup(cmdclass={"build_py": BuildWithExamples})
