"""Requests that the tests of the API's conventions make."""

from datetime import UTC, datetime, timedelta

from tests.api_in_process import PREFIX, Api
from tests.plant import KEY

NOTE = {"at": "2026-01-01T00:00:00Z", "text": "looked", "by": "anna"}
TIMELINE = f"{PREFIX}/machines/{KEY.machine}/timeline"
ALERT = f"{PREFIX}/alerts/1"
ANNA = {"by": "anna"}
TOMORROW = (datetime.now(UTC) + timedelta(days=1)).isoformat()
IN_FORCE = f"{PREFIX}/machines/{KEY.machine}/slow-roll/in-force"


def without_if_match(api: Api) -> Api:
    del api.http.headers["if-match"]
    return api
