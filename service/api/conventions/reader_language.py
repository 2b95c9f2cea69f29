"""Language of an answer that describes findings: by Accept-Language, else the site's. Errors stay English."""

from typing import cast

from fastapi import Depends, Request, Response

from service.wording.language import Language, asked_language


def reader_language(request: Request) -> Language:
    """Return the language in which a request wants findings described."""
    site = cast(Language, request.app.state.texts.language)
    accepted = request.headers.get("accept-language")
    return asked_language(accepted, site) if accepted else site


def vary_by_language(request: Request, response: Response) -> None:
    """Set the answer's language, and that it varies with the request's Accept-Language (RFC 9110 §8.5, §12.5.5)."""
    response.headers["Content-Language"] = reader_language(request).code
    response.headers["Vary"] = "Accept-Language"


async def _varying(request: Request, response: Response) -> None:
    vary_by_language(request, response)


VARIES_BY_LANGUAGE = Depends(_varying)
"""Dependency of routes whose answers follow the language; asynchronous, as a thread for it would cost more than it does."""
