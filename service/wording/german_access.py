"""Sentences on logins and subscriptions, in German."""

from collections.abc import Mapping

ACCESS: Mapping[str, str] = {
    # --- logins
    "this API key is not known, has expired or was revoked: ask an administrator for one": (
        "dieser API-Schlüssel ist nicht bekannt, abgelaufen oder widerrufen: einen Administrator um einen bitten"
    ),
    "this is no API key, and tokens are not taken here: no issuer is configured": (
        "das ist kein API-Schlüssel, und Token werden hier nicht angenommen: kein Aussteller ist eingerichtet"
    ),
    "the token is not valid: {why}": "das Token ist nicht gültig: {why}",
    "get a new one from the issuer": "ein neues beim Aussteller holen",
    "this login was not begun here, or too long ago: begin again": (
        "diese Anmeldung wurde nicht hier begonnen, oder vor zu langer Zeit: neu beginnen"
    ),
    "another issuer answered": "ein anderer Aussteller hat geantwortet",
    "the issuer refused: {answer}": "der Aussteller hat abgelehnt: {answer}",
    "it gave no code": "er gab keinen Code",
    "the issuer gave no ID token for the code": "der Aussteller gab kein ID-Token für den Code",
    "the issuer's {name} is not an https URL": "{name} des Ausstellers ist keine https-Adresse",
    "the issuer calls itself '{said}', not '{known}'": "der Aussteller nennt sich '{said}', nicht '{known}'",
    "the issuer's configuration cannot be read: {error}": (
        "die Konfiguration des Ausstellers lässt sich nicht lesen: {error}"
    ),
    "the issuer's keys are unavailable: they are fetched again every {seconds} s": (
        "die Schlüssel des Ausstellers sind nicht zu haben: sie werden alle {seconds} s neu geholt"
    ),
    "signed with a key that the issuer does not publish": (
        "mit einem Schlüssel unterschrieben, den der Aussteller nicht veröffentlicht"
    ),
    "made for another login": "für eine andere Anmeldung gemacht",
    # --- subscriptions
    "by request": "auf Wunsch",
    "the receiver answered {answer}": "der Empfänger antwortete {answer}",
}
