"""Every route of the application with its requirement: the application does not start with a route that declares none."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from fastapi import FastAPI
from fastapi.routing import iter_route_contexts

from service.security.browser_origin import SAFE_METHODS
from service.security.requirement import Requirement, strictest
from service.security.role import Role


class Undeclared(RuntimeError):
    """A route declares neither its role nor the plant of its parameters."""


@dataclass(frozen=True)
class ApiOperation:
    """A route. scoped: names of its path's parameters that belong to a plant."""

    name: str
    path: str
    methods: frozenset[str]
    pattern: re.Pattern[str]
    requirement: Requirement
    scoped: tuple[str, ...]


class Operations:
    """All operations of an application. public: paths of public files, which cannot declare a requirement."""

    def __init__(
        self, app: FastAPI, *, public: Mapping[str, Requirement], scoped: frozenset[str], free: frozenset[str]
    ) -> None:
        """Collect the operations. scoped, free: path parameters with and without a plant. Raises Undeclared."""
        self._all = tuple(_operations(app, public, scoped, free))
        methods = {method for one in self._all for method in one.methods}
        self._by_method = {method: [one for one in self._all if method in one.methods] for method in methods}

    def __iter__(self) -> Iterator[ApiOperation]:
        return iter(self._all)

    def find(self, method: str, path: str) -> tuple[ApiOperation, Mapping[str, str]] | None:
        """Return the operation of a request with its path's parameters; the first that matches, as in routing."""
        for one in self._by_method.get(method, ()):
            if match := one.pattern.match(path):
                return one, match.groupdict()
        return None


def _operations(
    app: FastAPI, public: Mapping[str, Requirement], scoped: frozenset[str], free: frozenset[str]
) -> Iterator[ApiOperation]:
    for context in iter_route_contexts(app.routes):
        route: Any = context
        path = str(getattr(route, "path", "") or "")
        methods = frozenset(getattr(route, "methods", None) or {"GET", "HEAD"})
        requirement = _requirement(route, path, methods, public)
        pattern = getattr(route, "path_regex", None)
        if pattern is None:
            raise Undeclared(f"route {path or route} has no pattern: it cannot be guarded")
        names = tuple(pattern.groupindex)
        unknown = [name for name in names if name not in scoped | free]
        if unknown:
            raise Undeclared(f"route {path}: say in ROWS of service.api.application which plant {{{unknown[0]}}} belongs to")
        yield ApiOperation(
            name=str(getattr(route, "operation_id", None) or getattr(route, "name", None) or path),
            path=path,
            methods=methods,
            pattern=pattern,
            requirement=requirement,
            scoped=tuple(name for name in names if name in scoped),
        )


def _requirement(route: Any, path: str, methods: frozenset[str], public: Mapping[str, Requirement]) -> Requirement:
    """Return what a route requires. Raises Undeclared."""
    found = strictest(getattr(route, "dependencies", None)) or public.get(path)
    if found is None:
        raise Undeclared(
            f"route {path or route} does not say which role it needs: give it one of service.security.requirement"
        )
    if found.role is Role.VIEWER and not methods <= SAFE_METHODS:
        raise Undeclared(f"route {path}: {', '.join(methods)} changes something, and viewers change nothing")
    return found
