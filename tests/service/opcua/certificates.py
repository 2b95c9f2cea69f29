"""An authority for certificates of OPC UA applications."""

from datetime import UTC, datetime, timedelta
from pathlib import Path

from cryptography import x509
from cryptography.hazmat.primitives import hashes
from cryptography.hazmat.primitives.asymmetric import rsa
from cryptography.hazmat.primitives.serialization import Encoding, NoEncryption, PrivateFormat
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

DAY = timedelta(days=1)


class Authority:
    """An authority whose own certificate lies in a folder of what is trusted."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self.trusted = folder / "trusted"
        self.trusted.mkdir()
        self._key = rsa.generate_private_key(public_exponent=65537, key_size=2048)
        self._name = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, f"authority in {folder.name}")])
        builder = self._builder(self._name, self._key.public_key(), datetime.now(UTC) - DAY, datetime.now(UTC) + DAY)
        builder = builder.add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
        self.certificate = builder.sign(self._key, hashes.SHA256())
        (self.trusted / "authority.pem").write_bytes(self.certificate.public_bytes(Encoding.PEM))

    def issue(
        self, name: str, application: str, *, ends: timedelta = DAY, key_size: int = 2048, foreign: bool = False
    ) -> tuple[Path, Path]:
        """Issue a certificate; its file and its key's. ends: from now on; foreign: signed by itself, and not trusted."""
        key = rsa.generate_private_key(public_exponent=65537, key_size=key_size)
        subject = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, name)])
        until = datetime.now(UTC) + ends
        builder = self._builder(subject, key.public_key(), min(datetime.now(UTC), until) - DAY, until, own=foreign)
        names = [x509.UniformResourceIdentifier(application), x509.DNSName("localhost")]
        builder = builder.add_extension(x509.SubjectAlternativeName(names), critical=False)
        builder = builder.add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
        usages = dict.fromkeys(
            ("digital_signature", "content_commitment", "key_encipherment", "data_encipherment", "key_cert_sign"), True
        ) | dict.fromkeys(("key_agreement", "crl_sign", "encipher_only", "decipher_only"), False)
        builder = builder.add_extension(x509.KeyUsage(**usages), critical=True)
        both = [ExtendedKeyUsageOID.CLIENT_AUTH, ExtendedKeyUsageOID.SERVER_AUTH]
        builder = builder.add_extension(x509.ExtendedKeyUsage(both), critical=False)
        certificate = builder.sign(key if foreign else self._key, hashes.SHA256())
        files = self._folder / f"{name}.pem", self._folder / f"{name}.key"
        files[0].write_bytes(certificate.public_bytes(Encoding.PEM))
        files[1].write_bytes(key.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption()))
        files[1].chmod(0o600)
        return files

    def revoke(self, file: Path) -> None:
        """Put a list into the folder that holds a certificate as revoked."""
        certificate = x509.load_pem_x509_certificate(file.read_bytes())
        moment = datetime.now(UTC)
        one = x509.RevokedCertificateBuilder().serial_number(certificate.serial_number).revocation_date(moment).build()
        builder = x509.CertificateRevocationListBuilder().issuer_name(self._name).last_update(moment).next_update(moment + DAY)
        held = builder.add_revoked_certificate(one).sign(self._key, hashes.SHA256())
        (self.trusted / "authority.crl").write_bytes(held.public_bytes(Encoding.DER))

    def _builder(
        self, subject: x509.Name, key: rsa.RSAPublicKey, since: datetime, until: datetime, *, own: bool = False
    ) -> x509.CertificateBuilder:
        builder = x509.CertificateBuilder().subject_name(subject).issuer_name(subject if own else self._name)
        builder = builder.public_key(key).serial_number(x509.random_serial_number())
        return builder.not_valid_before(since).not_valid_after(until)
