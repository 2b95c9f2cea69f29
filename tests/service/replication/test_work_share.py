"""Shares of the work: each machine has one lease, and who is alone has all of them."""

from collections import Counter

from service.replication.work_share import DELIVERY, INGEST, SHARDS, Share, WholeShare, lease_of
from storage.database.engine import Database


def test_machines_spread_evenly_over_the_leases_and_stay_with_theirs() -> None:
    names = [f"m{number:04d}" for number in range(3200)]
    found = Counter(map(lease_of, names))
    assert set(found) == set(INGEST)
    assert max(found.values()) < 1.5 * len(names) / SHARDS
    # Another release, or another process, must find the same lease.
    assert [lease_of(one) for one in ("pump-7", "fan", "")] == ["machines-19", "machines-25", "machines-00"]


def test_who_is_alone_owns_and_leads_everything(database: Database) -> None:
    share: Share = WholeShare()
    assert (share.holder, share.changes) == (None, 0)
    assert share.is_owner("pump-7")
    assert share.is_leader(DELIVERY)
    with database.transaction() as session:
        share.require(session, ["pump-7"])  # raises nothing
