"""Trust in clients' certificates: trusted are those in a folder, and all that an authority in that folder has signed.

Source: OPC 10000-4, 6.1.3 (determining if a certificate is trusted): times, application URI, key length, issuer, revocation.
"""

import time
from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from pathlib import Path

from asyncua import ua
from asyncua.common.utils import ServiceError
from cryptography import x509
from cryptography.exceptions import InvalidSignature
from cryptography.hazmat.primitives.asymmetric.rsa import RSAPublicKey
from cryptography.hazmat.primitives.serialization import load_pem_private_key

FEWEST_BITS = 2048
"""Shortest key that Basic256Sha256 takes (OPC 10000-7)."""
CACHED_S = 5.0
LISTS = ".crl"


class CertificateUnusable(ValueError):
    """A certificate, key or folder of ours cannot be used; the message says which and why."""


def application_uri(certificate: x509.Certificate) -> str | None:
    """Return the application that a certificate names; None where it names none."""
    try:
        names = certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    except (x509.ExtensionNotFound, ValueError):
        return None
    return next(iter(names.get_values_for_type(x509.UniformResourceIdentifier)), None)


def load_own(certificate: Path, key: Path) -> tuple[x509.Certificate, object]:
    """Return the server's certificate and key. Raises CertificateUnusable."""
    try:
        found = x509.load_pem_x509_certificate(certificate.read_bytes())
        private = load_pem_private_key(key.read_bytes(), None)
    except (OSError, ValueError, TypeError) as error:
        raise CertificateUnusable(f"OPC UA certificate {certificate} and key {key} cannot be read: {error}") from None
    if application_uri(found) is None:
        raise CertificateUnusable(f"OPC UA certificate {certificate} names no application: it needs a URI as subjectAltName")
    if found.not_valid_after_utc < datetime.now(UTC):
        raise CertificateUnusable(f"OPC UA certificate {certificate} expired at {found.not_valid_after_utc:%Y-%m-%d %H:%M}")
    if private.public_key() != found.public_key():
        raise CertificateUnusable(f"OPC UA key {key} is not that of the certificate {certificate}")
    return found, private


class ClientTrust:
    """Trust in clients' certificates by a folder, which is read again when it may have changed."""

    def __init__(self, folder: Path, *, clock: Callable[[], float] = time.monotonic) -> None:
        self._folder = folder
        self._clock = clock
        self._read_at = -CACHED_S
        self._trusted: list[x509.Certificate] = []
        self._revoked: list[x509.CertificateRevocationList] = []
        self.trouble: str | None = None
        """Why the folder could not be read the last time; what it held before goes on to hold."""

    def require(self, encoded: bytes | None, application: str | None) -> None:
        """Check the certificate of a channel. application: what the client says it is. Raises ServiceError."""
        if not encoded:
            raise ServiceError(ua.StatusCodes.BadCertificateInvalid)
        try:
            certificate = x509.load_der_x509_certificate(encoded)
            named = application_uri(certificate)
            key = certificate.public_key()
        except ValueError:
            raise ServiceError(ua.StatusCodes.BadCertificateInvalid) from None
        if not certificate.not_valid_before_utc <= datetime.now(UTC) <= certificate.not_valid_after_utc:
            raise ServiceError(ua.StatusCodes.BadCertificateTimeInvalid)
        if not isinstance(key, RSAPublicKey) or key.key_size < FEWEST_BITS:
            raise ServiceError(ua.StatusCodes.BadCertificatePolicyCheckFailed)
        self.refresh()
        if not self._is_trusted(certificate):
            raise ServiceError(ua.StatusCodes.BadCertificateUntrusted)
        if named is None or named != application:
            raise ServiceError(ua.StatusCodes.BadCertificateUriInvalid)

    def _is_trusted(self, certificate: x509.Certificate) -> bool:
        """Return whether a certificate is in the folder, or signed by an authority in it. Raises ServiceError: revoked."""
        if certificate in self._trusted:
            return True
        issuers = [one for one in self._trusted if _is_authority(one) and _issued(one, certificate)]
        for issuer in issuers:
            for one in self._revoked:
                if (
                    one.issuer == issuer.subject
                    and one.is_signature_valid(issuer.public_key())  # type: ignore[arg-type]
                    and one.get_revoked_certificate_by_serial_number(certificate.serial_number) is not None
                ):
                    raise ServiceError(ua.StatusCodes.BadCertificateRevoked)
        return bool(issuers)

    def refresh(self) -> None:
        """Read the folder again where that was long ago."""
        if self._clock() < self._read_at + CACHED_S:
            return
        self._read_at = self._clock()
        try:
            self._read()
        except CertificateUnusable as error:
            self.trouble = f"{error}; what was trusted before still is, and what was revoked since may be, too"
        else:
            self.trouble = None

    def _read(self) -> None:
        """Read the folder. Raises CertificateUnusable, and then leaves all as it was."""
        trusted, revoked = [], []
        path = self._folder
        try:
            for path in self._files():
                if path.suffix == LISTS:
                    revoked.append(_list(path.read_bytes()))
                else:
                    trusted.append(_certificate(path.read_bytes()))
        except (OSError, ValueError) as error:
            raise CertificateUnusable(f"trusted OPC UA clients: {path} cannot be read: {error}") from None
        self._trusted, self._revoked = trusted, revoked

    def _files(self) -> Iterator[Path]:
        return (one for one in sorted(self._folder.iterdir()) if one.suffix in (".pem", ".der", ".crt", ".cer", LISTS))

    def check_folder(self) -> int:
        """Read the folder now and return how many certificates it holds. Raises CertificateUnusable."""
        self._read()
        self._read_at = self._clock()
        return len(self._trusted)


def _certificate(content: bytes) -> x509.Certificate:
    if content.lstrip().startswith(b"-----"):
        return x509.load_pem_x509_certificate(content)
    return x509.load_der_x509_certificate(content)


def _list(content: bytes) -> x509.CertificateRevocationList:
    return x509.load_pem_x509_crl(content) if content.lstrip().startswith(b"-----") else x509.load_der_x509_crl(content)


def _is_authority(certificate: x509.Certificate) -> bool:
    try:
        basic = certificate.extensions.get_extension_for_class(x509.BasicConstraints).value
    except (x509.ExtensionNotFound, ValueError):
        return False
    in_time = certificate.not_valid_before_utc <= datetime.now(UTC) <= certificate.not_valid_after_utc
    return basic.ca and in_time


def _issued(issuer: x509.Certificate, certificate: x509.Certificate) -> bool:
    try:
        certificate.verify_directly_issued_by(issuer)
    except (ValueError, TypeError, InvalidSignature):
        return False
    return True
