"""Logins by a token that an issuer has signed (OpenID Connect), as over HTTP: offered where an issuer is configured.

Source: OPC 10000-4, 7.40.6 (IssuedIdentityToken); OPC 10000-6, 6.5.3.2 (JSON Web Tokens and their token policy). A token
passes over encrypted channels only.
"""

import json

from asyncua import ua
from asyncua.common.utils import ServiceError

from service.configuration.settings import Settings

JWT_TOKEN = "http://opcfoundation.org/UA/UserToken#JWT"
OAUTH2 = "http://opcfoundation.org/UA/Authorization#OAuth2"
NO_SECURITY = "http://opcfoundation.org/UA/SecurityPolicy#None"
POLICY = "issued"


def token_policy(settings: Settings) -> ua.UserTokenPolicy | None:
    """Return the policy that an endpoint offers; None where no issuer is configured."""
    if not settings.oidc_issuer:
        return None
    said = {
        "ua:resourceId": settings.oidc_audience,
        "ua:authorityUrl": settings.oidc_issuer,
        "ua:authorityProfileUri": OAUTH2,
        "ua:scopes": settings.oidc_scope.split(),
    }
    return ua.UserTokenPolicy(
        PolicyId=POLICY,
        TokenType=ua.UserTokenType.IssuedToken,
        IssuedTokenType=JWT_TOKEN,
        IssuerEndpointUrl=json.dumps(said),
        SecurityPolicyUri=NO_SECURITY,  # the channel is encrypted already
    )


def as_password(params: ua.ActivateSessionParameters, *, encrypted: bool) -> None:
    """Put an issued token where the library looks for a password: one without a user name.

    encrypted: whether the channel is. Raises ServiceError where it is not, for a token that is encrypted by itself, which the
    policy does not offer, and for a client's own password without a user name, which would pass for a token.
    """
    token = params.UserIdentityToken
    if isinstance(token, ua.UserNameIdentityToken) and token.UserName is None:
        raise ServiceError(ua.StatusCodes.BadIdentityTokenRejected)
    if not isinstance(token, ua.IssuedIdentityToken):
        return
    if not encrypted or not token.TokenData or token.EncryptionAlgorithm:
        raise ServiceError(ua.StatusCodes.BadIdentityTokenRejected)
    params.UserIdentityToken = ua.UserNameIdentityToken(
        PolicyId=token.PolicyId, UserName=None, Password=token.TokenData, EncryptionAlgorithm=None
    )


def text_of(token: object) -> str:
    """Return the text of a token that is not encrypted by itself; empty for anything else."""
    if not isinstance(token, ua.IssuedIdentityToken) or token.EncryptionAlgorithm or not token.TokenData:
        return ""
    return bytes(token.TokenData).decode("ascii", "replace")
