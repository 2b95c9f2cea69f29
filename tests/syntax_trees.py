"""Syntax trees of source files, parsed and walked in a fraction of the time that `ast.parse` and `ast.walk` take.

Parsing makes a thousand objects a file, none of which is garbage; and what the tests look for are statements, of which there
are far fewer than expressions.
"""

import ast
import gc
from collections import deque
from collections.abc import Iterator

PARTS = ("body", "orelse", "finalbody", "handlers", "cases")
"""Fields of a statement that hold others."""


def parsed(source: str) -> ast.Module:
    """Return the tree of a source."""
    collects = gc.isenabled()
    gc.disable()
    try:
        return ast.parse(source)
    finally:
        if collects:
            gc.enable()


def statements(tree: ast.AST) -> Iterator[ast.AST]:
    """Yield a tree's root and all its statements at any depth, in the order of `ast.walk`."""
    waiting = deque([tree])
    while waiting:
        node = waiting.popleft()
        yield node
        for part in PARTS:
            found = getattr(node, part, ())
            if isinstance(found, list):
                waiting.extend(found)
