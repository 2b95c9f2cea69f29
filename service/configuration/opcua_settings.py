"""The settings of the OPC UA server; without an endpoint there is none."""

import re
from typing import Self

from pydantic import Field, model_validator
from pydantic_settings import BaseSettings

from service.secrets.files import require_private

ENDPOINT = re.compile(r"opc\.tcp://(?P<host>\[[0-9a-fA-F:.]+\]|[^\s/:\[\]]+):(?P<port>\d{1,5})")
"""Form of the endpoint: the library's parsing would take much that listens somewhere else than it seems to."""
LARGEST_PORT = 65535


class OpcUaSettings(BaseSettings):
    """Settings of the OPC UA server; `Settings` holds them with all others."""

    opcua_listen: str = Field(
        default="", description="endpoint of the OPC UA server, such as opc.tcp://127.0.0.1:4840; none by default"
    )
    opcua_certificate: str = Field(
        default="", description="file of its certificate (PEM), which names its application URI as a subjectAltName"
    )
    opcua_key: str = Field(default="", description="file of its key, which others must not be able to read")
    opcua_trusted: str = Field(
        default="", description="folder of the clients' certificates, or their authorities', that are trusted (PEM or DER)"
    )
    opcua_allow_unencrypted: bool = Field(
        default=False, description="offer the security policy None as well: everything, API keys too, is then readable"
    )

    @property
    def opcua_address(self) -> tuple[str, int]:
        """Return host and port of the OPC UA server; an empty host and 0 where there is none."""
        match = ENDPOINT.fullmatch(self.opcua_listen)
        return ("", 0) if match is None else (match["host"].strip("[]"), int(match["port"]))

    @model_validator(mode="after")
    def _complete_opcua(self) -> Self:
        files = bool(self.opcua_certificate), bool(self.opcua_key), bool(self.opcua_trusted)
        if len(set(files)) != 1:
            raise ValueError("opcua_certificate, opcua_key and opcua_trusted: all three, or none")
        if not self.opcua_listen:
            return self
        if ENDPOINT.fullmatch(self.opcua_listen) is None or self.opcua_address[1] > LARGEST_PORT:
            raise ValueError("opcua_listen: an endpoint is opc.tcp://HOST:PORT, such as opc.tcp://0.0.0.0:4840")
        if not self.opcua_certificate and not self.opcua_allow_unencrypted:
            raise ValueError(
                "opcua_listen needs opcua_certificate, opcua_key and opcua_trusted, or opcua_allow_unencrypted, "
                "which says that everything may be read on the way"
            )
        if self.opcua_key:
            require_private(self.opcua_key)
        return self
