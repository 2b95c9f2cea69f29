"""Computes a step of somebody's work in a process of models, in its turn among others, and only while its client waits.

Those who ask for it take turns beside those who ask for models, also where they are the same: a correction does not wait
behind the models of a page.
"""

from collections.abc import Callable, Hashable
from typing import TypeVar

from anyio import from_thread
from fastapi import Request

from service.api.cache.computed_cache import ComputedCache
from service.api.cache.model_process import ModelProcess
from service.api.conventions.dependencies import principal

T = TypeVar("T")


def compute_in_worker(request: Request, key: Hashable, work: Callable[[ModelProcess], T]) -> T:
    """Return what `work` makes of the process, cached or now, in its turn. Raises ComputationsBusy, and what `work` raises.

    key: everything that the result depends on. work: reads what is needed, and has it computed.
    """
    cache: ComputedCache = request.app.state.computed_cache
    process: ModelProcess = request.app.state.model_process
    caller = "step", *caller_of(request)
    return cache.compute_queued(key, lambda: work(process), long=True, caller=caller, wanted=lambda: not has_gone(request))


def caller_of(request: Request) -> tuple[Hashable, ...]:
    """Return who asks, for turns between callers."""
    return principal(request).identity, request.client.host if request.client else None


def has_gone(request: Request) -> bool:
    """Check whether the client of a request, which is served by a thread, has gone."""
    return from_thread.run(request.is_disconnected)
