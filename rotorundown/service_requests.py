"""Requests to a running service over HTTP, with the standard library alone."""

import json
import urllib.error
import urllib.parse
import urllib.request
from collections.abc import Iterator, Mapping
from http.client import HTTPException, HTTPResponse
from typing import Any

from estimator.errors import Invalid

PREFIX = "/api/v1"
TIMEOUT_S = 60.0
LONGEST_REASON = 300
"""Most characters that are shown of an answer that is not the service's own."""


class WrongAddress(Invalid):
    """Raised for what is no address of a service."""


class ServiceError(RuntimeError):
    """Raised when a service refuses a request, or does not answer; the message says why.

    Attributes:
        status: Status of HTTP; None without an answer.
    """

    def __init__(self, message: str, status: int | None = None) -> None:
        super().__init__(message)
        self.status = status


class _NoRedirects(urllib.request.HTTPRedirectHandler):
    """Follows no redirection: a key must not be sent elsewhere."""

    def redirect_request(self, *_args: Any, **_kwargs: Any) -> None:
        return None


class Requests:
    """Requests to the service at an address. key: an API key or a token, where the service asks for one."""

    def __init__(self, url: str, key: str | None) -> None:
        url = str(url)
        parts = urllib.parse.urlsplit(url)
        if parts.scheme not in ("http", "https") or not parts.netloc:
            raise WrongAddress(f"'{url}' is no address of a service: it is written as http://localhost:8080")
        self.url = url.rstrip("/")
        self._headers = {"Accept": "application/json"} | ({} if key is None else {"Authorization": f"Bearer {key}"})
        self._opener = urllib.request.build_opener(_NoRedirects)

    def read(self, path: str, asked: Mapping[str, Any] | None = None) -> Any:
        """Return the decoded answer to a question. Raises ServiceError."""
        return self._read(f"{self.url}{PREFIX}{path}{_query(asked)}")[0]

    def pages(self, path: str, asked: Mapping[str, Any] | None = None) -> Iterator[Any]:
        """Yield the pages of a list, each as the service gives it. Raises ServiceError."""
        following: str | None = f"{self.url}{PREFIX}{path}{_query(asked)}"
        while following is not None:
            page, following = self._read(following)
            yield page

    def _read(self, url: str) -> tuple[Any, str | None]:
        """Return an answer and the address of the next page."""
        request = urllib.request.Request(url, headers=self._headers)
        try:
            with self._opener.open(request, timeout=TIMEOUT_S) as answer:
                return json.loads(answer.read()), self._next(answer)
        except urllib.error.HTTPError as error:
            raise ServiceError(_refusal(error), error.code) from None
        except (OSError, HTTPException) as error:
            raise ServiceError(f"{self.url} does not answer: {getattr(error, 'reason', error)}") from None
        except ValueError:
            raise ServiceError(f"{self.url} answers something else than JSON: is it the address of the service?") from None

    def _next(self, answer: HTTPResponse) -> str | None:
        for link in answer.headers.get_all("Link") or ():
            target, _, rest = link.strip().removeprefix("<").partition(">")
            if 'rel="next"' in rest or "rel=next" in rest:
                path = urllib.parse.urlsplit(target)
                return f"{self.url}{path.path}?{path.query}"
        return None


def _query(asked: Mapping[str, Any] | None) -> str:
    given = {name: value for name, value in (asked or {}).items() if value is not None}
    return f"?{urllib.parse.urlencode(given, doseq=True)}" if given else ""


def _refusal(error: urllib.error.HTTPError) -> str:
    """Return what the service says is wrong: problem details (RFC 9457), or the beginning of another answer."""
    body = error.read()
    try:
        problem = json.loads(body)
        fields = "; ".join(f"{one['field']}: {one['message']}" for one in problem.get("errors", ()))
        return f"{error.code} {problem['title']}: {problem['detail']}{f' ({fields})' if fields else ''}"
    except (ValueError, KeyError, TypeError, AttributeError):
        page = "html" in error.headers.get("Content-Type", "")
        text = "a web page: is it the address of the service?" if page else _first_line(body)
        return f"{error.code} {error.reason}{f': {text}' if text else ''}"


def _first_line(body: bytes) -> str:
    lines = body[:LONGEST_REASON].decode(errors="replace").split("\n")
    return next((line.strip() for line in lines if line.strip()), "")
