"""Equations of the pages, written in TeX between lines of `$$`, as MathML: browsers draw it without any script or font."""

import re

from latex2mathml.converter import convert


def with_equations(text: str) -> str:
    """Return a page with its equations as MathML. Raises ValueError for one that is not closed."""
    parts = re.split(r"(?m)^\$\$\n(.*?)\n\$\$$", text, flags=re.DOTALL)
    if re.search(r"(?m)^\$\$$", "".join(parts[::2])):
        raise ValueError("an equation is not closed: `$$` stands on a line of its own before and behind it")
    parts[1::2] = [f'<div class="equation">{convert(one, display="block")}</div>' for one in parts[1::2]]
    return "".join(parts)
