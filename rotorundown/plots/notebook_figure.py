"""Figures of matplotlib that a notebook shows once: as what a cell returns, or at its end if it returns something else."""

from typing import TYPE_CHECKING, Any

from matplotlib import pyplot
from matplotlib.figure import Figure

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell


class NotebookFigure(Figure):
    """A figure that pyplot keeps open until it is shown, so that a cell shows all that it draws, and none of it twice."""

    def _ipython_display_(self) -> None:
        from IPython.core.getipython import get_ipython
        from IPython.display import display

        shell: InteractiveShell | None = get_ipython()
        formatters = {} if shell is None or shell.display_formatter is None else shell.display_formatter.formatters
        shown: dict[str, Any] = {}
        details: dict[str, Any] = {}
        for kind, formatter in formatters.items():
            made = formatter(self)
            if isinstance(made, tuple):
                made, details[kind] = made
            if made is not None:
                shown[kind] = made
        pyplot.close(self)
        display(shown, raw=True, metadata=details)
