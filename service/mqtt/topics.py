"""Topics: the keys of the zenoh network behind a prefix, `<prefix>/<plant>/<machine>/…`."""

import re
from dataclasses import dataclass

from formats.wire import IDENTIFIER, Key, Rejected

_OTHER = re.compile(r"[^A-Za-z0-9_.-]")


@dataclass(frozen=True)
class Topics:
    """Topics behind a prefix."""

    prefix: str

    @property
    def all_samples(self) -> str:
        """Return the filter of all batches."""
        return f"{self.prefix}/+/+/samples"

    def machine_of(self, topic: str) -> Key:
        """Return plant and machine of a batch's topic. Raises Rejected."""
        parts = topic.removeprefix(f"{self.prefix}/").split("/")
        if len(parts) != 3 or parts[2] != "samples" or not all(IDENTIFIER.match(one) for one in parts[:2]):
            raise Rejected("key_mismatch", f"'{topic[:200]}' is not {self.prefix}/<plant>/<machine>/samples")
        return Key(parts[0], parts[1])

    def alert(self, plant: str, machine: str, *, rule: str, element: str) -> str:
        """Return the topic of a rule's alerts on an element: one topic for all of them in turn."""
        return f"{self.prefix}/{plant}/{machine}/alerts/{_level(rule)}/{_level(element)}"

    def trends(self, plant: str, machine: str) -> str:
        """Return the topic of what was identified last."""
        return f"{self.prefix}/{plant}/{machine}/trends"

    def status(self, client_id: str) -> str:
        """Return the topic on which the broker states whether the service is connected."""
        return f"{self.prefix}/status/{client_id}"


def _level(name: str) -> str:
    """Return a name as one level of a topic, without wildcards; an empty one as `-`."""
    return _OTHER.sub("_", name) or "-"
