"""The OPC UA server itself: its endpoint, its sessions and its address space, over the library `asyncua`."""

import asyncio
import logging
import time
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, TypeVar

from asyncua import ua
from asyncua.common.connection import TransportLimits
from asyncua.common.utils import ServiceError
from asyncua.crypto.permission_rules import User
from asyncua.server.internal_server import InternalServer
from asyncua.server.internal_session import InternalSession

from rotorundown.environment.release import VERSION
from service.advice.site_texts import SiteTexts
from service.configuration.settings import Settings
from service.opcua.alert_conditions import AlertConditions
from service.opcua.alert_reading import AlertReading
from service.opcua.browsing import Browsing
from service.opcua.capabilities import set_capabilities
from service.opcua.client_requests import LARGEST_CHUNK, ListeningServer
from service.opcua.client_session import ClientSession
from service.opcua.client_trust import ClientTrust, application_uri, load_own
from service.opcua.client_users import ClientUser, ClientUsers
from service.opcua.condition_methods import ConditionMethods
from service.opcua.issued_tokens import text_of, token_policy
from service.opcua.machine_nodes import MachineNodes
from service.opcua.names import NAMESPACE, NodeNames
from service.opcua.node_tree import NodeTree
from service.opcua.own_subscriptions import MOST_QUEUED
from service.opcua.plant_reader import PlantChanges, PlantReader
from service.opcua.trend_history import TrendHistory
from service.opcua.unshown import Unshown, alert_name, machine_name
from service.security.authentication import Authentication
from service.security.configuration import Security
from service.security.principal import Principal
from storage.database.engine import Database

logger = logging.getLogger(__name__)
T = TypeVar("T")

APPLICATION = "urn:rundown:opcua"
"""URI of the application where no certificate names it."""
POLICIES = [
    ua.SecurityPolicyType.Basic256Sha256_SignAndEncrypt,
    ua.SecurityPolicyType.Aes128Sha256RsaOaep_SignAndEncrypt,
    ua.SecurityPolicyType.Aes256Sha256RsaPss_SignAndEncrypt,
]
"""Security policies that are offered where there is a certificate; all of them encrypt, as API keys pass."""
MOST_CONNECTIONS, MOST_ALL_SUBSCRIPTIONS = 100, 200
LARGEST_MESSAGE = 4 * 2**20
"""Largest message in either direction [B]: ten thousand references have half of it."""
SESSIONS_S = 3.0
"""Time between looks whether sessions' keys and certificates still hold [s]."""


class ClientServer(InternalServer):
    """The library's server, whose sessions are ours."""

    def __init__(self, users: ClientUsers, trust: ClientTrust | None, history: TrendHistory) -> None:
        super().__init__(user_manager=users)
        self._users = users
        self._token_policy: ua.UserTokenPolicy | None = None
        self.names = NodeNames(0)
        self._trust = trust
        self._history = history
        self._browsing = Browsing(self.aspace)
        self.max_connections = MOST_CONNECTIONS
        self.max_subscriptions = MOST_ALL_SUBSCRIPTIONS
        self.max_monitored_item_queue_size = MOST_QUEUED
        self.max_unacked_messages_per_subscription = 100
        self.allow_remote_admin = False
        self.supported_tokens: tuple[type[ua.UserIdentityToken], ...] = (ua.AnonymousIdentityToken, ua.UserNameIdentityToken)

    def offer(self, policy: ua.UserTokenPolicy | None) -> None:
        """Allow logins by an issuer's tokens, at endpoints that encrypt."""
        self._token_policy = policy
        if policy is not None:
            # An issued token is checked in the place of a password.
            self.supported_tokens = (*self.supported_tokens, ua.IssuedIdentityToken)

    def add_endpoint(self, endpoint: ua.EndpointDescription) -> None:
        """Add an endpoint, with all ways to log in."""
        if self._token_policy is not None and endpoint.SecurityMode == ua.MessageSecurityMode.SignAndEncrypt:
            endpoint.UserIdentityTokens.append(self._token_policy)
        super().add_endpoint(endpoint)

    async def prepare(self, params: ua.ActivateSessionParameters) -> None:
        """Fetch what checking an issued token needs, while others' requests are answered."""
        await asyncio.to_thread(self._users.prepare, text_of(params.UserIdentityToken))

    def create_session(
        self,
        name: str,
        user: User | None = None,
        external: bool = False,
    ) -> InternalSession:
        """Create a session of a client."""
        session = ClientSession(self, self.aspace, self.subscription_service, name, user=user or User(), external=external)
        session.visible, session.require_trusted = self.visible, self.require_trusted
        session.history, session.browsing = self._history, self._browsing
        return session

    def visible(self, who: Principal, node: ua.NodeId) -> bool:
        """Return whether a principal may see a node."""
        plant = self.names.plant_of(node)
        return plant is None or who.sees(plant)

    def require_trusted(self, certificate: bytes | None, application: str | None) -> None:
        """Check the certificate of a channel; one without security has none, where that is offered. Raises ServiceError."""
        if certificate and self._trust is not None:
            self._trust.require(certificate, application)

    def register_server(self, server: Any, conf: Any = None) -> None:
        """Refuse to register: this is no discovery server."""
        del server, conf
        raise ServiceError(ua.StatusCodes.BadServiceUnsupported)

    @property
    def client_sessions(self) -> list[ClientSession]:
        """Return the clients' sessions that are active."""
        return [one for one in self._external_sessions.values() if isinstance(one, ClientSession) and one.is_activated()]

    def session_of(self, number: ua.NodeId) -> ClientSession | None:
        """Return the active session of a client by its id."""
        return next((one for one in self.client_sessions if one.session_id == number), None)


class PlantServer:
    """The server over a store. All its methods run on one event loop."""

    def __init__(self, database: Database, settings: Settings, texts: SiteTexts | None = None) -> None:
        self._settings = settings
        security = Security.of(settings)
        self._users = ClientUsers(Authentication(database, tokens=security.tokens, required=security.required))
        trust = ClientTrust(Path(settings.opcua_trusted)) if settings.opcua_trusted else None
        self._trust = trust
        self._core = ClientServer(self._users, trust, TrendHistory(database))
        self._core.offer(token_policy(settings))
        self._server = ListeningServer(iserver=self._core)
        self._unshown = Unshown()
        self._waiting: dict[int, AlertReading] = {}  # alerts that could not be shown
        self._reader = PlantReader(database, texts, self._unshown)
        self._database = database
        self._checked_at = 0.0
        self._certificate_ends: datetime | None = None
        self._machines: MachineNodes | None = None
        self._conditions: AlertConditions | None = None

    @property
    def sessions(self) -> int:
        """Count the clients."""
        return len(self._core.client_sessions)

    @property
    def monitored_items(self) -> int:
        """Count what clients watch."""
        subscriptions = self._core.subscription_service.subscriptions.values()
        return sum(len(one.monitored_item_srv._monitored_items) for one in subscriptions)

    @property
    def certificate_has_expired(self) -> bool:
        """Return whether its certificate was good when it started, and is no longer."""
        return self._certificate_ends is not None and self._certificate_ends < datetime.now(UTC)

    @property
    def trouble(self) -> str | None:
        """Return what is wrong while it serves; None where nothing does."""
        of_trust = None if self._trust is None else self._trust.trouble
        return "; ".join(one for one in (of_trust, self._unshown.trouble) if one) or None

    async def start(self) -> None:
        """Show what is stored, then listen. Raises CertificateUnusable, OSError, DBAPIError."""
        await self._users.refresh()
        self._use_certificate()
        await self._server.init()
        await self._describe()
        await set_capabilities(self._core)
        index = await self._server.register_namespace(NAMESPACE)
        self._core.names = NodeNames(index)
        tree = NodeTree(self._core, self._core.names)
        self._machines = MachineNodes(tree)
        self._machines.add_root()
        self._conditions = AlertConditions(self._core, tree, self._machines, self._core.session_of)
        ConditionMethods(self._database, self._conditions).link(self._core)
        standing = await _in_thread(self._reader.open_alerts)
        await self._show(await _in_thread(self._reader.read_changes))
        for alert in standing:
            await self._show_alert(alert, report=False)
        await self._server.start()

    async def update(self) -> None:
        """Update the nodes after the store, and end sessions whose rights have ended. Raises DBAPIError."""
        await self._show(await _in_thread(self._reader.read_changes))
        if time.monotonic() >= self._checked_at + SESSIONS_S:
            self._checked_at = time.monotonic()
            await self._users.refresh()
            if self._trust is not None:
                await _in_thread(self._trust.refresh)
            for session in self._core.client_sessions:
                if not await self._may_go_on(session):
                    logger.warning("OPC UA session of %s is ended: its key or certificate holds no longer", session.user.name)
                    await session.close_session(True)

    async def close(self) -> None:
        """Stop listening, and end all sessions."""
        for session in self._core.client_sessions:
            await session.close_session(True)
        await self._server.stop()

    async def _may_go_on(self, session: ClientSession) -> bool:
        try:
            self._core.require_trusted(session.certificate, session.application)
        except ServiceError:
            return False
        return isinstance(session.user, ClientUser) and await _in_thread(self._users.still_valid, session.user)

    async def _show(self, news: PlantChanges) -> None:
        machines = self._machines
        assert machines is not None
        for reading in news.machines:
            await self._unshown.show(machine_name(reading.id), machines.show(reading))
            await _others_first()
        for machine, standing in news.standings.items():
            await self._unshown.show(f"the state of {machine_name(machine)}", machines.show_standing(machine, standing))
        for alert in [*(self._waiting.values() if news.machines else ()), *news.alerts]:
            await self._show_alert(alert)

    async def _show_alert(self, alert: AlertReading, *, report: bool = True) -> None:
        """Show an alert; one that cannot be shown is tried again when machines have changed."""
        assert self._conditions is not None
        name = alert_name(alert.id)
        self._waiting.pop(alert.id, None)
        if not await self._unshown.show(name, self._conditions.show(alert, report=report)):
            self._waiting[alert.id] = alert
        elif alert.is_open and not alert.has_text:
            self._unshown.note(f"the text of {name}")
        else:
            self._unshown.forget(f"the text of {name}")

    def _use_certificate(self) -> None:
        settings, server = self._settings, self._server
        policies = [ua.SecurityPolicyType.NoSecurity] if settings.opcua_allow_unencrypted else []
        if settings.opcua_certificate:
            found, key = load_own(Path(settings.opcua_certificate), Path(settings.opcua_key))
            self._core.certificate, self._core.private_key = found, key
            self._certificate_ends = found.not_valid_after_utc
            policies = [*POLICIES, *policies]
            assert self._trust is not None
            self._trust.check_folder()
            server._application_uri = application_uri(found) or APPLICATION
        else:
            server._application_uri = APPLICATION
        server.set_security_policy(policies)
        host, port = settings.opcua_address
        server.set_endpoint(f"opc.tcp://{f'[{host}]' if ':' in host else host}:{port}/")
        server.name, server.product_uri, server.manufacturer_name = "Rundown", "urn:rundown", "Rundown"
        server.application_type = ua.ApplicationType.Server
        server.limits = TransportLimits(
            max_recv_buffer=LARGEST_CHUNK,
            max_send_buffer=LARGEST_CHUNK,
            max_chunk_count=LARGEST_MESSAGE // LARGEST_CHUNK + 1,
            max_message_size=LARGEST_MESSAGE,
        )

    async def _describe(self) -> None:
        built = datetime(2026, 1, 1, tzinfo=UTC)
        await self._server.set_build_info("urn:rundown", "Rundown", "Rundown", VERSION, VERSION, built)


async def _in_thread(function: Callable[..., T], *arguments: object) -> T:
    return await asyncio.to_thread(function, *arguments)


async def _others_first() -> None:
    """Let clients be answered between two machines."""
    await asyncio.sleep(0)
