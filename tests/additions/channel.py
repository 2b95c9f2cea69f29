"""Adds the delivery channel "logbook": the service's own log."""

from tests.additions.addition import LANGUAGE_TESTS, Addition
from tests.additions.package_copy import PackageCopy

MODULE = '''"""Writes alert events to the service's log."""

from service.delivery.channel import DeliveryOutcome, EventMessage
from service.delivery.channel_kind import ChannelKind


class Logbook:
    """Channel to the log."""

    async def send(self, message: EventMessage) -> DeliveryOutcome:
        """Write an event."""
        return DeliveryOutcome("delivered", message.event.message)


LOGBOOK = ChannelKind(
    "logbook", {"en": "Logbook", "de": "Betriebsbuch"}, "none", None, lambda row, connections: Logbook()
)
'''

IMPORT = "from service.delivery.logbook import LOGBOOK\n"

CHECK = """
from service.commands.page_declarations import documents
from service.delivery.channels import open_channel
from storage.database.engine import Database
from storage.tables.alerting import SubscriptionRow
from tests.api_in_process import Api
api = Api(Database("sqlite:///subscriptions.db"))
api("POST", "/subscriptions", 201, json={"kind": "logbook", "name": "a"})
assert [one["kind"] for one in api.value("/subscriptions")] == ["logbook"]
assert type(open_channel(SubscriptionRow(kind="logbook"), None)).__name__ == "Logbook"
assert '"Logbook"' in documents()["channels.ts"]
assert '"Betriebsbuch"' in documents()["channels.ts"]
"""


def _add(copy: PackageCopy) -> None:
    copy.write("service/delivery/logbook.py", MODULE)
    copy.insert("service/delivery/channels.py", "CHANNEL_KINDS: tuple[ChannelKind, ...] = (", "LOGBOOK, ")
    copy.insert("service/delivery/channels.py", "from service.delivery.mail import EMAIL\n", IMPORT)


CHANNEL = Addition("channel", most_files=2, add=_add, check=CHECK, tests=LANGUAGE_TESTS)
