"""Trust in clients' certificates, beyond what a well-behaved client can be made to try."""

from pathlib import Path

import pytest
from asyncua import ua
from asyncua.common.utils import ServiceError
from cryptography import x509
from cryptography.hazmat.primitives.serialization import Encoding

from service.opcua.client_trust import CertificateUnusable, ClientTrust, load_own
from tests.service.opcua.certificates import Authority

CLIENT = "urn:client"


@pytest.fixture
def authority(tmp_path: Path) -> Authority:
    return Authority(tmp_path)


def encoded(file: Path) -> bytes:
    return x509.load_pem_x509_certificate(file.read_bytes()).public_bytes(Encoding.DER)


def code(trust: ClientTrust, certificate: bytes | None, application: str | None = CLIENT) -> int:
    with pytest.raises(ServiceError) as error:
        trust.require(certificate, application)
    return int(error.value.code)


def test_a_certificate_of_the_authority_is_trusted_for_its_own_application_only(authority: Authority) -> None:
    trust = ClientTrust(authority.trusted)
    certificate = encoded(authority.issue("client", CLIENT)[0])
    trust.require(certificate, CLIENT)
    assert code(trust, certificate, "urn:other") == ua.StatusCodes.BadCertificateUriInvalid
    assert code(trust, certificate, None) == ua.StatusCodes.BadCertificateUriInvalid


def test_what_is_no_certificate_or_too_short_a_key_is_refused(authority: Authority) -> None:
    trust = ClientTrust(authority.trusted)
    assert code(trust, None) == ua.StatusCodes.BadCertificateInvalid
    assert code(trust, b"\x30\x03abc") == ua.StatusCodes.BadCertificateInvalid
    short = encoded(authority.issue("short", CLIENT, key_size=1024)[0])
    assert code(trust, short) == ua.StatusCodes.BadCertificatePolicyCheckFailed


def test_one_that_signs_itself_is_trusted_when_it_lies_in_the_folder(authority: Authority) -> None:
    trust = ClientTrust(authority.trusted, clock=iter(range(0, 10_000, 100)).__next__)
    file = authority.issue("alone", CLIENT, foreign=True)[0]
    assert code(trust, encoded(file)) == ua.StatusCodes.BadCertificateUntrusted
    (authority.trusted / "alone.der").write_bytes(encoded(file))
    trust.require(encoded(file), CLIENT)


def test_an_own_key_that_is_another_certificates_is_said(authority: Authority) -> None:
    certificate, _ = authority.issue("one", "urn:one")
    _, key = authority.issue("two", "urn:two")
    with pytest.raises(CertificateUnusable, match="is not that of the certificate"):
        load_own(certificate, key)


def test_a_folder_with_what_is_no_certificate_is_said(authority: Authority) -> None:
    (authority.trusted / "rubbish.pem").write_text("-----BEGIN RUBBISH-----")
    with pytest.raises(CertificateUnusable, match="cannot be read"):
        ClientTrust(authority.trusted).check_folder()


def test_rubbish_that_comes_later_leaves_trust_as_it_was_until_it_is_gone(authority: Authority) -> None:
    trust = ClientTrust(authority.trusted, clock=iter(range(0, 10_000, 100)).__next__)
    client, revoked = (authority.issue(name, CLIENT)[0] for name in ("client", "revoked"))
    authority.revoke(revoked)
    trust.require(encoded(client), CLIENT)
    assert trust.trouble is None
    rubbish = authority.trusted / "half-copied.pem"
    rubbish.write_text("-----BEGIN CERTIFICATE-----\nMIIC")
    trust.require(encoded(client), CLIENT)
    assert code(trust, encoded(revoked)) == ua.StatusCodes.BadCertificateRevoked
    assert trust.trouble is not None
    assert "half-copied.pem cannot be read" in trust.trouble
    rubbish.unlink()
    trust.require(encoded(client), CLIENT)
    assert trust.trouble is None
