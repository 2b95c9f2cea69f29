"""Logins by an issuer's tokens, with a real issuer: what it signed is taken over encrypted channels, nothing else."""

import asyncio
import json
import time
from collections.abc import Iterator
from typing import Any

import pytest
from asyncua import ua
from asyncua.client.client import Client
from asyncua.ua.uaerrors import UaError

from service.configuration.settings import Settings
from service.opcua.issued_tokens import JWT_TOKEN, as_password
from service.opcua.serving import OPENING, OpcUaServing
from storage.database.engine import Database
from storage.operation import audit
from tests.plant import KEY, wait_until
from tests.ports import free_port
from tests.service.opcua.certificates import Authority
from tests.service.opcua.test_machines_and_alarms import ALERT, MACHINE
from tests.service.security.issuer import AUDIENCE, Issuer
from tests.service.security.two_plants import HIDDEN, HIDDEN_PLANT, fill

CLIENT = "urn:second-stack:client"


class TokenClient(Client):  # type: ignore[misc]
    """A client of the library's that logs in by a token, as OPC 10000-4, 7.40.6 says."""

    token = ""

    def _add_anonymous_auth(self, params: ua.ActivateSessionParameters) -> None:
        policy = self.server_policy(ua.UserTokenType.IssuedToken)
        params.UserIdentityToken = ua.IssuedIdentityToken(PolicyId=policy.PolicyId, TokenData=self.token.encode())


@pytest.fixture(scope="module")
def issuer() -> Iterator[Issuer]:
    with Issuer() as one:
        yield one


@pytest.fixture(scope="module")
def serving(
    store: Database, issuer: Issuer, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[tuple[OpcUaServing, Authority]]:
    fill(store)
    authority = Authority(tmp_path_factory.mktemp("pki"))
    certificate, key = authority.issue("server", "urn:rundown:test")
    settings = Settings(
        opcua_listen=f"opc.tcp://127.0.0.1:{free_port()}",
        opcua_certificate=str(certificate),
        opcua_key=str(key),
        opcua_trusted=str(authority.trusted),
        opcua_allow_unencrypted=True,
        oidc_issuer=issuer.url,
        oidc_audience=AUDIENCE,
        oidc_jwks=f"{issuer.url}/keys",
    )
    one = OpcUaServing(store, settings)
    one.start()
    try:
        wait_until(lambda: one.trouble != OPENING)
        assert one.trouble is None, one.trouble
        yield one, authority
    finally:
        one.stop()


async def client(serving: tuple[OpcUaServing, Authority], token: str, *, encrypted: bool = True) -> TokenClient:
    one = TokenClient(serving[0]._settings.opcua_listen, timeout=10)
    one.token, one.application_uri = token, CLIENT
    if encrypted:
        certificate, key = serving[1].issue("client", CLIENT)
        pem = key.rename(key.with_suffix(".key.pem"))
        await one.set_security_string(f"Basic256Sha256,SignAndEncrypt,{certificate},{pem}")
    await one.connect()
    return one


def test_a_token_says_who_somebody_is_and_what_they_may(
    serving: tuple[OpcUaServing, Authority], issuer: Issuer, store: Database
) -> None:
    async def attempt() -> None:
        token = issuer.token(sub="olga", name="Olga", rundown_role="operator", rundown_plants=[KEY.plant])
        one = await client(serving, token)
        assert await one.get_node(f"{MACHINE}/Name").read_value() == "Pump 7"
        with pytest.raises(UaError):
            await one.get_node(f"ns=2;s={HIDDEN_PLANT}/{HIDDEN}/Name").read_value()
        event = await one.get_node(f"{ALERT}/EventId").read_value()
        words = ua.LocalizedText("seen", "en")
        await one.get_node(ALERT).call_method(ua.NodeId(9111), event, ua.Variant(words, ua.VariantType.LocalizedText))
        await one.disconnect()

    asyncio.run(attempt())
    with store.reading() as session:
        entry = audit.newest(session, limit=1)[0]
    assert (entry.operation, entry.outcome) == ("acknowledge_alert", "done")
    assert entry.who.startswith("Olga (olga)")


@pytest.mark.parametrize(
    "wrong",
    [
        {"aud": "another"},
        {"exp": int(time.time()) - 3600},
        {"rundown_role": "source"},
        {"rundown_role": None},
        {"iss": "https://elsewhere.example"},
    ],
)
def test_what_the_issuer_did_not_sign_for_this_is_refused(
    serving: tuple[OpcUaServing, Authority], issuer: Issuer, wrong: dict[str, Any]
) -> None:
    claims: dict[str, Any] = {"sub": "olga", "rundown_role": "operator", "rundown_plants": ["*"]} | wrong
    with pytest.raises(UaError):
        asyncio.run(client(serving, issuer.token(**claims)))
    with pytest.raises(UaError):
        asyncio.run(client(serving, "a.b.c"))


def test_a_session_ends_with_its_token(serving: tuple[OpcUaServing, Authority], issuer: Issuer) -> None:
    async def attempt() -> None:
        # Clocks may differ by 30 s.
        soon = int(time.time()) - 26
        one = await client(serving, issuer.token(sub="olga", rundown_role="viewer", rundown_plants=["*"], exp=soon))
        line = one.uaclient.protocol
        assert line is not None
        assert await one.get_node(f"{MACHINE}/Name").read_value() == "Pump 7"
        for _ in range(150):
            try:
                await one.get_node(f"{MACHINE}/Name").read_value()
            except (UaError, ConnectionError, TimeoutError):
                line.disconnect_socket()  # the client itself closes nothing once it has found the session's end
                one.disconnect_socket()
                await asyncio.sleep(0.1)
                return
            await asyncio.sleep(0.1)
        pytest.fail("the session goes on")

    asyncio.run(attempt())


def test_tokens_are_offered_where_the_channel_is_encrypted_only(serving: tuple[OpcUaServing, Authority]) -> None:
    async def offered() -> list[ua.EndpointDescription]:
        return list(await Client(serving[0]._settings.opcua_listen).connect_and_get_server_endpoints())

    for endpoint in asyncio.run(offered()):
        found = [one for one in endpoint.UserIdentityTokens if one.TokenType == ua.UserTokenType.IssuedToken]
        if endpoint.SecurityMode == ua.MessageSecurityMode.SignAndEncrypt:
            (policy,) = found
            assert policy.IssuedTokenType == JWT_TOKEN
            assert json.loads(policy.IssuerEndpointUrl)["ua:authorityUrl"] == serving[0]._settings.oidc_issuer
        else:
            assert not found
    params = ua.ActivateSessionParameters(UserIdentityToken=ua.IssuedIdentityToken(TokenData=b"a.b.c"))
    with pytest.raises(ua.uaerrors.UaError):
        as_password(params, encrypted=False)


@pytest.mark.parametrize(
    "token",
    [
        ua.UserNameIdentityToken(UserName=None, Password=b"a.b.c"),
        ua.IssuedIdentityToken(TokenData=b"a.b.c", EncryptionAlgorithm="http://www.w3.org/2001/04/xmlenc#rsa-oaep"),
    ],
)
def test_what_would_pass_for_a_token_beside_the_policy_is_refused(
    token: ua.UserNameIdentityToken | ua.IssuedIdentityToken,
) -> None:
    with pytest.raises(ua.uaerrors.UaError):
        as_password(ua.ActivateSessionParameters(UserIdentityToken=token), encrypted=True)
