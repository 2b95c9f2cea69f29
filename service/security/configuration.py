"""Access settings of an application."""

from dataclasses import dataclass

from service.configuration.hosts import is_loopback
from service.configuration.settings import Settings
from service.security.key_set import KeySet
from service.security.open_id import OpenId
from service.security.tokens import Claims, Tokens


@dataclass(frozen=True)
class Security:
    """Access settings.

    required: credentials are needed even where there is neither a key nor an issuer. tls: whether the service itself speaks
    TLS. names_checked: see `AccessRules`. requests, failures: rate per second and burst, see `RateLimit`.
    """

    required: bool = False
    tokens: Tokens | None = None
    open_id: OpenId | None = None
    public_url: str = ""
    tls: bool = False
    names_checked: bool = False
    requests: tuple[float, float] = (100.0, 500.0)
    failures: tuple[float, float] = (0.2, 10.0)

    @classmethod
    def of(cls, settings: Settings) -> "Security":
        """Derive the access settings from the service's settings."""
        tokens = open_id = None
        if settings.oidc_issuer:
            open_id = OpenId(
                issuer=settings.oidc_issuer,
                client_id=settings.oidc_client_id,
                client_secret=settings.oidc_client_secret.get_secret_value(),
                scope=settings.oidc_scope,
                public_url=settings.public_url,
            )
            claims = Claims(
                role=settings.oidc_role_claim,
                plants=settings.oidc_plants_claim,
                name=settings.oidc_name_claim,
                roles=settings.oidc_roles,
            )
            keys = KeySet(settings.oidc_jwks or open_id.keys_url)
            tokens = Tokens(issuer=settings.oidc_issuer, audience=settings.oidc_audience, keys=keys, claims=claims)
        return cls(
            required=settings.authentication == "required",
            tokens=tokens,
            open_id=open_id if settings.oidc_client_id else None,
            public_url=settings.public_url,
            tls=bool(settings.tls_certificate),
            names_checked=is_loopback(settings.host),
            requests=(settings.requests_per_s, settings.requests_burst),
        )
