"""All additions that are tried."""

from tests.additions.bearing_model import BEARING_MODEL
from tests.additions.channel import CHANNEL
from tests.additions.finding import FINDING
from tests.additions.resource import RESOURCE
from tests.additions.train_model import TRAIN_MODEL

ADDITIONS = (FINDING, CHANNEL, BEARING_MODEL, TRAIN_MODEL, RESOURCE)
