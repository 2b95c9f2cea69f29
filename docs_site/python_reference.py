"""The reference of the Python library, from its docstrings by mkdocstrings."""

import rotorundown

HEAD = """# Python library: reference

Every public name of `rotorundown`, from its docstring; [examples](python.md) run all of them.
"""


def python_page() -> str:
    """Return the page: a directive for each public name, functions first."""
    found = {name: getattr(rotorundown, name) for name in rotorundown.__all__}
    order = sorted(found, key=lambda name: (isinstance(found[name], type), name))
    return HEAD + "".join(_directive(found[name].__module__, name) for name in order)


def _directive(module: str, name: str) -> str:
    """Return the directive of a name, whose heading is what users write."""
    return f"\n::: {module}.{name}\n    options:\n      heading: rotorundown.{name}\n      toc_label: {name}\n"
