"""Keys and tokens: what they open, until when, who they say did it, and how often they may ask."""

import asyncio
import json
import threading
import time
from pathlib import Path

import pytest
from cryptography.hazmat.primitives.asymmetric import ec, rsa
from pydantic import BaseModel, create_model
from sqlalchemy import select

from service.api.alerts import schemas
from service.api.machines import limit_schemas, timeline_schemas
from service.resilience.rate_limit import RateLimit
from service.security import api_keys, authentication
from service.security.authentication import COOKIE, IDENTITY_CACHE_S, Authentication, Credentials, Unauthenticated
from service.security.configuration import Security
from service.security.key_set import KEPT_S, RETRY_S, STALE_S, KeySet, KeysUnavailable, _parsed
from service.security.principal import Author
from service.security.role import Role
from service.security.tokens import Claims, TokenRefused, Tokens
from storage.clock import now
from storage.database.engine import Database
from storage.operation import api_keys as keys
from storage.tables.machines import TimelineRow
from storage.tables.operation import ApiKeyRow
from tests.api_in_process import PREFIX, Api, problem, value
from tests.plant import KEY
from tests.service.security.conftest import PATIENT, Clock, Filled, bearer, opened_api
from tests.service.security.issuer import AUDIENCE, Issuer, public

ME = f"{PREFIX}/me"
NOTE = {"at": "2026-01-01T00:00:00Z", "text": "looked", "by": "somebody else"}


def made(database: Database, role: Role = Role.VIEWER, days: float = 1.0) -> str:
    with database.transaction() as session:
        return api_keys.create(session, name="anna", role=role, plants=None, days=days)[1]


def test_a_database_that_hangs_keeps_nobody_waiting_where_there_is_no_key_yet(
    database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(authentication, "PATIENCE_S", 0.1)
    clock, answers, looks = Clock(), threading.Event(), list[int]()
    one = Authentication(database, clock=clock)

    def hanging() -> bool:
        looks.append(1)
        return answers.wait(60.0)

    async def ask() -> list[bool]:
        found = []
        for _ in range(3):
            clock.now += 2 * IDENTITY_CACHE_S
            found.append(await asyncio.wait_for(one.on(), 20.0))
        assert len(looks) == 1, "one thread waits, not one for each request"
        answers.set()
        clock.now += 2 * IDENTITY_CACHE_S
        return [*found, await asyncio.wait_for(one.on(), 20.0)]

    monkeypatch.setattr(one, "_any_keys_exist", hanging)
    try:
        assert asyncio.run(ask()) == [False, False, False, True]
    finally:
        answers.set()


def test_only_the_hash_of_a_key_is_kept(store: Database) -> None:
    text = made(store)
    assert len(text.split("_", 2)[2]) == 43  # 256 bits
    with store.reading() as session:
        row = keys.get(session, text.split("_")[1])
        assert text not in str(vars(row))
        assert row.hash == api_keys.key_hash(text)


async def _ask(authentication: Authentication, text: str) -> str:
    return (await authentication.principal(Credentials(text, None))).name


def test_a_revoked_key_opens_nothing_within_seconds(store: Database) -> None:
    clock = Clock()
    authentication = Authentication(store, clock=clock)
    text = made(store)
    assert asyncio.run(_ask(authentication, text)) == "anna"
    with store.transaction() as session:
        api_keys.revoke(session, text.split("_")[1])
    clock.now += IDENTITY_CACHE_S + 0.1
    with pytest.raises(Unauthenticated, match="revoked"):
        asyncio.run(_ask(authentication, text))


def test_a_rotated_key_is_good_for_the_overlap(store: Database) -> None:
    authentication = Authentication(store)
    old = made(store, Role.OPERATOR)
    prefix = old.split("_")[1]
    with store.transaction() as session:
        row, new = api_keys.rotate(session, prefix, overlap_days=1.0, days=30)
        assert (row.name, row.role) == ("anna", "operator")
    assert authentication.key(old).role is authentication.key(new).role is Role.OPERATOR
    with store.transaction() as session:
        keys.expire_by(keys.get(session, prefix), now())
    with pytest.raises(Unauthenticated):
        authentication.key(old)
    assert authentication.key(new).name == "anna"
    with store.transaction() as session, pytest.raises(ValueError, match="create a new one"):
        api_keys.rotate(session, prefix, overlap_days=1.0, days=30)


def test_a_revoked_key_gets_no_answer_that_was_kept_for_it(api: Api, store: Database) -> None:
    clock = Clock()
    clock.now = time.monotonic()
    api.app.state.authentication._clock = clock
    text = made(store)
    answers = [api.ask("GET", f"{PREFIX}/machines", headers=bearer(text)) for _ in range(3)]
    assert {one.status_code for one in answers} == {200}
    with store.transaction() as session:
        api_keys.revoke(session, text.split("_")[1])
    clock.now += IDENTITY_CACHE_S + 0.1
    problem(api.ask("GET", f"{PREFIX}/machines", headers=bearer(text)), 401)
    problem(api.ask("GET", f"{PREFIX}/machines", headers=bearer(text) | {"if-none-match": "*"}), 401)


def test_when_a_key_was_last_used_is_written_now_and_then(store: Database) -> None:
    authentication = Authentication(store)
    text = made(store)
    authentication.key(text)
    with store.reading() as session:
        first = session.scalars(select(ApiKeyRow.last_used_at).where(ApiKeyRow.prefix == text.split("_")[1])).one()
    assert first is not None
    assert abs(first - now()) < 60e9
    authentication.key(text)
    with store.reading() as session:
        assert keys.get(session, text.split("_")[1]).last_used_at == first


def test_without_keys_and_issuer_everything_is_as_before_and_the_first_key_ends_that(plant: Database) -> None:
    clock = Clock()
    api = opened_api(plant, Security(requests=PATIENT))
    clock.now = time.monotonic()
    api.app.state.authentication._clock = clock
    assert value(api.ask("GET", ME)) == {"name": "", "role": "admin", "plants": None, "kind": "open", "token": None}
    path = f"{PREFIX}/machines/{KEY.machine}/timeline"
    assert value(api.ask("POST", path, json=NOTE), 201)["by"] == "somebody else"
    text = made(plant)
    clock.now += IDENTITY_CACHE_S + 0.1
    problem(api.ask("GET", ME), 401)
    assert value(api.ask("GET", ME, headers=bearer(text)))["name"] == "anna"
    with plant.transaction() as session:
        api_keys.revoke(session, text.split("_")[1])
    clock.now += IDENTITY_CACHE_S + 0.1
    problem(api.ask("GET", ME), 401)
    api.http.close()


def test_who_does_something_is_who_asks(api: Api, filled: Filled, issuer: Issuer) -> None:
    path = f"{PREFIX}/machines/{KEY.machine}/timeline"
    value(api.ask("POST", path, json=NOTE, headers=bearer(filled.keys["analyst"])), 201)
    value(api.ask("POST", path, json=NOTE, headers=bearer(issuer.token(rundown_role="analyst", name="Berta"))), 201)
    with api.database.reading() as session:
        names = session.scalars(select(TimelineRow.by).order_by(TimelineRow.id.desc()).limit(2)).all()
    assert names == ["Berta (anna)", "analyst 2"]


def test_every_body_that_says_who_does_it_is_filled_in() -> None:
    """A new model with `by` in a request must use Author."""
    asked = [
        one
        for module in (schemas, limit_schemas, timeline_schemas)
        for one in vars(module).values()
        if isinstance(one, type)
        and issubclass(one, BaseModel)
        and "by" in one.model_fields
        and not one.__name__.endswith("Out")
    ]
    expected = create_model("Probe", by=(Author, ...)).model_fields["by"].metadata
    assert len(asked) >= 7
    for one in asked:
        assert one.model_fields["by"].metadata == expected, one


def test_an_idempotency_key_is_its_principals_own(api: Api, filled: Filled) -> None:
    path = f"{PREFIX}/machines/{KEY.machine}/timeline"
    headers = {"Idempotency-Key": "one"}
    first = api.ask("POST", path, json=NOTE, headers=headers | bearer(filled.keys["analyst"]))
    again = api.ask("POST", path, json=NOTE, headers=headers | bearer(filled.keys["analyst"]))
    other = api.ask("POST", path, json=NOTE, headers=headers | bearer(filled.keys["operator"]))
    assert first.json()["id"] == again.json()["id"] != other.json()["id"]
    problem(api.ask("POST", path, json=NOTE, headers=headers), 401)
    problem(api.ask("POST", path, json=NOTE, headers=headers | bearer(filled.keys["hidden"])), 404)


def test_too_many_requests_are_asked_to_wait(store: Database, filled: Filled) -> None:
    api = opened_api(store, Security(requests=(0.5, 3.0), failures=(0.5, 2.0)))
    codes = [api.ask("GET", ME, headers=bearer(filled.keys["viewer"])).status_code for _ in range(4)]
    assert codes == [200, 200, 200, 429]
    refused = api.ask("GET", ME, headers=bearer(filled.keys["viewer"]))
    assert 1 <= int(refused.headers["retry-after"]) <= 2
    assert "ask again in" in problem(refused, 429)["detail"]
    assert value(api.ask("GET", ME, headers=bearer(filled.keys["admin"])))["role"] == "admin"
    codes = [api.ask("GET", ME, headers=bearer("rundown_abcdef12_" + "A" * 43)).status_code for _ in range(3)]
    assert codes == [401, 401, 429]
    api.http.close()


def test_who_brings_nothing_or_an_old_session_uses_up_nobodys_guesses(store: Database, filled: Filled) -> None:
    api = opened_api(store, Security(requests=(0.001, 8.0), failures=(0.001, 1.0)))
    old = {"cookie": f"{COOKIE}={'A' * 43}"}
    codes = [api.ask("GET", f"{PREFIX}/machines", headers=one).status_code for one in [{}, old] * 4]
    assert codes == [401] * 8
    problem(api.ask("GET", f"{PREFIX}/machines"), 429)
    problem(api.ask("GET", f"{PREFIX}/machines", headers=old), 429)
    problem(api.ask("GET", ME, headers=bearer("rundown_abcdef12_" + "A" * 43)), 401)
    assert value(api.ask("GET", ME, headers=bearer(filled.keys["admin"])))["role"] == "admin"
    api.http.close()


def test_a_bucket_fills_up_again() -> None:
    clock = Clock()
    rate = RateLimit(per_s=2.0, burst=3.0, clock=clock)
    assert [rate.take("a") for _ in range(3)] == [0.0, 0.0, 0.0]
    assert rate.take("a") == pytest.approx(0.5)
    assert rate.take("b") == 0.0
    clock.now += 0.5
    assert rate.take("a") == 0.0
    clock.now += 1000.0
    assert [rate.take("a") for _ in range(4)][-1] > 0.0


# --- the issuer's keys ----------------------------------------------------------------------------------------------


def test_an_unknown_key_makes_the_service_ask_once_in_a_while(issuer: Issuer) -> None:
    clock, before = Clock(), issuer.asked
    found = KeySet(f"{issuer.url}/keys", clock=clock)
    assert found.find("r1") is not None
    for number in range(20):
        assert found.find(f"made-up-{number}") is None
    assert issuer.asked == before + 1  # it was asked a moment ago
    clock.now += RETRY_S + 1
    for number in range(20):
        assert found.find(f"made-up-{number}") is None
    assert issuer.asked == before + 2
    clock.now += KEPT_S + 1
    assert found.find("e1") is not None
    assert issuer.asked == before + 3


def test_a_new_key_of_the_issuer_is_found(issuer: Issuer) -> None:
    clock = Clock()
    issuer.published = ["r1"]
    try:
        found = KeySet(f"{issuer.url}/keys", clock=clock)
        assert found.find("e1") is None
        issuer.published = ["r1", "e1"]
        clock.now += RETRY_S + 1
        assert found.find("e1") is not None
    finally:
        issuer.published = ["r1", "e1"]


def test_keys_outlast_an_issuer_that_is_away_but_not_for_ever(tmp_path: Path, issuer: Issuer) -> None:
    clock = Clock()
    file = tmp_path / "keys.json"
    file.write_text(json.dumps(issuer.key_set()))
    found = KeySet(str(file), clock=clock)
    assert found.find("r1") is not None
    file.unlink()
    clock.now += STALE_S - 1
    assert found.find("r1") is not None
    clock.now += RETRY_S + 2
    with pytest.raises(KeysUnavailable):
        found.find("r1")


def test_a_service_whose_issuer_is_away_says_so(store: Database, filled: Filled, issuer: Issuer) -> None:
    gone = Tokens(issuer=issuer.url, audience=AUDIENCE, keys=KeySet("/nowhere/keys.json"), claims=Claims())
    api = opened_api(store, Security(tokens=gone, requests=PATIENT, failures=PATIENT))
    assert "are unavailable" in problem(api.ask("GET", ME, headers=bearer(issuer.token())), 503)["detail"]
    assert api.ask("GET", ME, headers=bearer(filled.keys["viewer"])).status_code == 200
    api.http.close()


def test_claims_may_be_called_and_nested_as_the_issuer_has_them(issuer: Issuer) -> None:
    claims = Claims(role="realm_access.roles", plants="sites", name="email", roles={"vib-engineer": "analyst"})
    tokens = Tokens(issuer=issuer.url, audience=AUDIENCE, keys=KeySet(f"{issuer.url}/keys"), claims=claims)
    text = issuer.token(
        realm_access={"roles": ["offline", "vib-engineer", "viewer"]}, sites=["a", "b"], email="a@plant.example"
    )
    who = tokens.principal(text)
    assert (who.name, who.role, who.plants) == ("a@plant.example (anna)", Role.ANALYST, frozenset({"a", "b"}))
    bare = tokens.principal(issuer.token(rundown_role="admin"))
    assert (bare.role, bare.plants) == (None, frozenset())
    with pytest.raises(TokenRefused, match="characters"):
        tokens.principal("a" * 10_000)


def test_weak_and_foreign_keys_are_passed_over(issuer: Issuer) -> None:
    weak = public("weak", rsa.generate_private_key(public_exponent=65537, key_size=1024))
    curve = public("curve", ec.generate_private_key(ec.SECP256K1()))
    secret = {"kty": "oct", "k": "AAAA", "kid": "secret"}
    encryption = public("enc", issuer.keys["r1"]) | {"use": "enc"}
    unknown = {"kty": "EC", "crv": "brainpoolP256r1", "x": "AAAA", "y": "AAAA", "kid": "unknown"}
    half = {name: value for name, value in public("half", issuer.keys["e1"]).items() if name != "y"}
    certificate = {"kty": "RSA", "x5c": ["AAAA"], "kid": "certificate"}
    assert list(
        _parsed({"keys": [weak, curve, secret, encryption, unknown, half, certificate, *issuer.key_set()["keys"]]})
    ) == ["r1", "e1"]


def test_looking_somebody_up_takes_little_time(store: Database, filled: Filled) -> None:
    authentication = Authentication(store)

    async def per_look_up() -> float:
        given = Credentials(filled.keys["viewer"], None)
        await authentication.principal(given)
        took = []
        for _ in range(20):
            began = time.perf_counter()
            for _ in range(100):
                await authentication.principal(given)
            took.append((time.perf_counter() - began) / 100)
        return min(took)

    assert asyncio.run(per_look_up()) < 0.0003
