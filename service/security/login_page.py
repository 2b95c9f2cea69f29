"""The login page in the language of who logs in: that of `?locale`, else of Accept-Language, else the site's."""

import html
from typing import cast
from urllib.parse import urlencode

from fastapi import Request
from fastapi.responses import HTMLResponse, Response

from service.security.configuration import Security
from service.wording.language import LANGUAGES, Language, asked_language
from service.wording.stored_sentences import in_language

POLICY = "default-src 'none'; style-src 'self'; img-src 'self'; form-action 'self'; base-uri 'none'; frame-ancestors 'none'"
REFERRER = {"Referrer-Policy": "same-origin"}
"""Without a referrer browsers send the form with Origin: null."""
PAGE = """<!doctype html>
<html lang="{code}">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{log_in} · Rundown</title>
<link rel="icon" href="/icon.svg">
<link rel="stylesheet" href="/login.css">
</head>
<body>
<main>
<h1>Rundown</h1>
{trouble}
<form method="post" action="/login{query}">
<label for="key">{key}</label>
<input id="key" name="key" type="password" autocomplete="current-password" required autofocus>
<button type="submit">{log_in}</button>
</form>
{issuer}
</main>
</body>
</html>
"""


def login_page(
    request: Request, trouble: str | None = None, status: int = 200, *, error: object = "", name: str = ""
) -> Response:
    """Return the page with what went wrong, by its key. error: a reason in English; name: name of the person concerned."""
    language = _language(request)
    said = (
        "" if trouble is None else language.translate(f"login.{trouble}", reason=in_language(str(error), language), name=name)
    )
    with_issuer = cast(Security, request.app.state.security).open_id is not None
    words = html.escape(language.translate("login.with_issuer"))
    page = PAGE.format(
        code=language.code,
        log_in=html.escape(language.translate("login.log_in")),
        key=html.escape(language.translate("login.key")),
        query=f"?{urlencode({'locale': language.code})}" if "locale" in request.query_params else "",
        trouble=f'<p role="alert">{html.escape(said)}</p>' if said else "",
        issuer=f'<p><a class="button" href="/login/issuer">{words}</a></p>' if with_issuer else "",
    )
    headers = {"Content-Security-Policy": POLICY, "Vary": "Accept-Language"} | REFERRER
    return HTMLResponse(page, status, headers)


def _language(request: Request) -> Language:
    """Return the language of the page: the one chosen on Rundown's own page comes in the address."""
    chosen = next((one for one in LANGUAGES if one.code == request.query_params.get("locale")), None)
    default = cast(Language, request.app.state.texts.language)
    return chosen or asked_language(request.headers.get("accept-language", ""), default)
