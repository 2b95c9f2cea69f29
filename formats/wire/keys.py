"""Keys of messages: `rundown/v1/<plant>/<machine>/…`, always of the same depth."""

import re

from msgspec import Struct

from formats.wire.rejection import Rejected

IDENTIFIER = re.compile(r"[A-Za-z0-9_-]{1,64}\Z")
"""Pattern of plants, machines and sources: zenoh itself would allow spaces and newlines."""

ALL_SAMPLES = "rundown/v1/*/*/samples"
ALL_LIVE = "rundown/v1/live/*/*"
ALL_RECEIVED = "rundown/v1/*/*/received"
ALL_SUBMIT = "rundown/v1/*/*/submit"


class Key(Struct, frozen=True):
    """Key of one machine on the network."""

    plant: str
    machine: str

    @classmethod
    def parse(cls, key: str) -> "Key":
        """Parse a full key expression. Raises Rejected."""
        parts = key.split("/")
        if len(parts) != 5 or parts[:2] != ["rundown", "v1"] or not all(IDENTIFIER.match(p) for p in parts[2:4]):
            raise Rejected("key_mismatch", f"'{key[:200]}' is not rundown/v1/<plant>/<machine>/samples")
        return cls(parts[2], parts[3])

    @property
    def samples(self) -> str:
        """Return the key on which batches are published."""
        return f"rundown/v1/{self.plant}/{self.machine}/samples"

    @property
    def log(self) -> str:
        """Return the key on which a source replies to replay queries."""
        return f"rundown/v1/{self.plant}/{self.machine}/log"

    @property
    def status(self) -> str:
        """Return the key on which a source reports its status."""
        return f"rundown/v1/{self.plant}/{self.machine}/status"

    @property
    def received(self) -> str:
        """Return the key on which the service reports how far it has received the machine's sources."""
        return f"rundown/v1/{self.plant}/{self.machine}/received"

    @property
    def submit(self) -> str:
        """Return the key on which a replica forwards samples received over HTTP to the replica that stores them."""
        return f"rundown/v1/{self.plant}/{self.machine}/submit"

    @property
    def live(self) -> str:
        """Return the liveliness token of the machine's source."""
        return f"rundown/v1/live/{self.plant}/{self.machine}"
