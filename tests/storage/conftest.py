"""Every test of the store that asks for a database is run on both kinds, whatever is asked for elsewhere.

All that follows from the kind is made anew here: the session's own fixtures are those of the kind that was asked for.
"""

import pytest

from tests.conftest import Stores
from tests.databases import KINDS, Databases, Kind


@pytest.fixture(params=KINDS)
def kind(request: pytest.FixtureRequest) -> Kind:
    """Return which kind of database is tested."""
    found: Kind = request.param
    return found


@pytest.fixture
def databases(kind: Kind, stores: Stores) -> Databases:
    """Return where databases come from."""
    return stores.databases(kind)


@pytest.fixture
def empty_template(kind: Kind, stores: Stores) -> str:
    """URL of a database whose schema is up to date."""
    return stores.empty(kind)


@pytest.fixture
def plant_template(kind: Kind, stores: Stores) -> str:
    """The same with the machine of `tests.plant`."""
    return stores.plant(kind)
