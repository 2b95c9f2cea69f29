"""Settings of the plant's MQTT broker."""

from importlib.util import find_spec
from typing import Annotated, Literal, Self
from urllib.parse import urlsplit

from pydantic import Field, SecretStr, model_validator
from pydantic_settings import BaseSettings

from service.configuration.hosts import is_loopback
from service.secrets.files import read_secret, require_private

PORTS = {"mqtt": 1883, "mqtts": 8883}
"""Ports of the two kinds of URLs, where these name none."""


class MqttSettings(BaseSettings):
    """Settings of the broker; without `mqtt_url` nothing of it is imported or started."""

    mqtt_url: str = Field(
        default="", description="the plant's MQTT broker, mqtts://HOST:8883 or mqtt://HOST:1883; none by default"
    )
    mqtt_user: str = Field(default="", description="user at the broker, if it wants one")
    mqtt_password: SecretStr = Field(default=SecretStr(""), description="the user's password")
    mqtt_password_file: str = Field(default="", description="file that holds it")
    mqtt_tls_ca: str = Field(default="", description="file of the authority that signed the broker's certificate")
    mqtt_tls_certificate: str = Field(default="", description="file of the service's own certificate, if the broker wants one")
    mqtt_tls_key: str = Field(default="", description="file of its key, which others must not be able to read")
    mqtt_client_id: Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,40}$")] = Field(
        default="rundown", description="name of this service at the broker, which keeps what comes for it meanwhile"
    )
    mqtt_topic_prefix: Annotated[str, Field(pattern=r"^[A-Za-z0-9_.-]+(/[A-Za-z0-9_.-]+)*$", max_length=100)] = Field(
        default="rundown/v1", description="what all topics of Rundown begin with"
    )
    mqtt_qos: Annotated[int, Field(ge=0, le=1)] = Field(default=1, description="quality of service, 0 or 1")
    mqtt_samples: Literal["taken", "left"] = Field(
        default="taken", description="taken: samples are taken from the broker; left: alerts and trends only go out"
    )

    @model_validator(mode="after")
    def _complete_broker(self) -> Self:
        if self.mqtt_password_file:
            self.mqtt_password = SecretStr(read_secret(self.mqtt_password_file))
        if self.mqtt_tls_key:
            require_private(self.mqtt_tls_key)
        if bool(self.mqtt_tls_certificate) != bool(self.mqtt_tls_key):
            raise ValueError("mqtt_tls_certificate and mqtt_tls_key: both, or neither")
        if self.mqtt_url:
            self._require_broker()
        return self

    def _require_broker(self) -> None:
        """Raise ValueError for a broker's URL that cannot be used."""
        try:
            host, _ = self.mqtt_broker
        except ValueError as error:
            raise ValueError(f"mqtt_url: {error}") from None
        if not self.mqtt_encrypted and not is_loopback(host) and self.mqtt_password.get_secret_value():
            raise ValueError("mqtt_url: a password goes over mqtts:// only, or to loopback: others could read it on its way")
        if find_spec("aiomqtt") is None:
            raise ValueError("mqtt_url needs the extra rotorundown[mqtt], which is not installed here")

    @property
    def mqtt_encrypted(self) -> bool:
        """Return whether the broker is spoken to over TLS."""
        return self.mqtt_url.startswith("mqtts:")

    @property
    def mqtt_broker(self) -> tuple[str, int]:
        """Return host and port of the broker. Raises ValueError for a URL that is not one of a broker."""
        parts = urlsplit(self.mqtt_url)
        if parts.scheme not in PORTS or not parts.hostname or parts.path not in ("", "/") or parts.query:
            raise ValueError("it must be mqtts://HOST:PORT or mqtt://HOST:PORT")
        if parts.username is not None:
            raise ValueError("user and password stand in settings of their own, mqtt_user and mqtt_password_file")
        return parts.hostname, parts.port or PORTS[parts.scheme]
