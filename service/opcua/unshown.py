"""Names what clients do not see although it is stored, or see without its text, in health until it is right."""

import logging
from collections.abc import Awaitable

from service.advice.advice import FAULTS_OF_CONTENT
from service.opcua.node_tree import NodeRefused

logger = logging.getLogger(__name__)

MOST_NAMED = 5
"""Most names in one message; of others it says how many they are."""


class Unshown:
    """Names that the server cannot show, in the order of discovery."""

    def __init__(self) -> None:
        self._names: dict[str, None] = {}

    @property
    def trouble(self) -> str | None:
        """Return a message that names what is not shown; None where everything is."""
        names = list(self._names)
        if not names:
            return None
        more = f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else ""
        return f"OPC UA clients are not shown {', '.join(names[:MOST_NAMED])}{more}: the log says why"

    def note(self, name: str) -> bool:
        """Note that something is not shown; return whether that is new."""
        is_new = name not in self._names
        self._names[name] = None
        return is_new

    def forget(self, name: str) -> None:
        """Note that something is as it should be."""
        self._names.pop(name, None)

    async def show(self, name: str, showing: Awaitable[None]) -> bool:
        """Wait until something is shown, and return whether it is; what cannot be is logged once and holds up nothing else."""
        try:
            await showing
        except (NodeRefused, *FAULTS_OF_CONTENT):
            if self.note(name):
                logger.exception("%s is not shown over OPC UA", name)
            return False
        self.forget(name)
        return True


def alert_name(alert: int) -> str:
    """Return the name of an alert."""
    return f"alert {alert}"


def machine_name(machine: str) -> str:
    """Return the name of a machine."""
    return f"machine '{machine}'"
