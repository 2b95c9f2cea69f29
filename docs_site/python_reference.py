"""The reference of the Python library, from its docstrings by mkdocstrings."""

import rotorundown

HEAD = """# Python library: reference

Every public name of `rotorundown`, from its docstring; [examples](python.md) run all of them.
"""


def python_page() -> str:
    """Return the page: a directive for each public name, functions first."""
    found = {name: getattr(rotorundown, name) for name in rotorundown.__all__}
    order = sorted(found, key=lambda name: (isinstance(found[name], type), name))
    return HEAD + "\n".join(f"\n::: {found[name].__module__}.{name}\n" for name in order)
