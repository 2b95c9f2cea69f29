"""Mails, webhooks and Alertmanagers tell what an alert means and what to do, in the same words."""

import json

from service.advice.advice_lines import advice_lines
from service.delivery.alertmanager import Alertmanager
from service.delivery.channel import EventMessage
from service.delivery.cloud_event import cloud_event
from service.delivery.mail import compose_mail
from service.delivery.messages import trial_message
from service.wording.language import ENGLISH, GERMAN
from tests.service.advice.test_advice import AHEAD, GROWING, PART, told
from tests.service.delivery.receivers import settings

ADVICE = told("coupling", "coupling.C1", parts=[PART], progress=GROWING | {"ahead": AHEAD})
EVENT = trial_message().event.model_copy(update={"machine": "pump-7", "message": ADVICE.what, "advice": ADVICE})
MESSAGE = EventMessage(EVENT, "plant-1")


def test_a_mail_says_how_far_how_urgent_and_what_to_do() -> None:
    mail = compose_mail(settings(public_url="https://rundown.example"), "anna@plant.example", MESSAGE).get_content()
    assert mail.startswith(ADVICE.what)
    for one in (ADVICE.how_far[0].words, ADVICE.how_sure.words, ADVICE.how_urgent.words, *ADVICE.check, *ADVICE.confirm):
        assert f"- {one}\n" in mail
    assert "To do at the next stop:\n" in mail
    assert "https://rundown.example/#/alerts/0\n" in mail
    assert "https://rundown.example/#/machines/pump-7" in mail


def test_a_mail_names_the_element_in_words() -> None:
    moved = EventMessage(EVENT.model_copy(update={"element": "coupling.C1"}), "plant-1")
    for language, said in ((ENGLISH, "coupling C1"), (GERMAN, "Kupplung C1")):
        mail = compose_mail(settings(), "anna@plant.example", moved, language)
        assert f" {said}: " in mail["Subject"]
        assert "coupling.C1" not in mail["Subject"]


def test_a_webhook_has_the_same_figures() -> None:
    data = json.loads(cloud_event(MESSAGE))["data"]
    assert data["advice"] == json.loads(ADVICE.model_dump_json())
    assert data["message"] == ADVICE.what


def test_an_alertmanager_has_it_as_its_description() -> None:
    (alert,) = Alertmanager(None, "http://am", (), "")._alerts(MESSAGE)  # type: ignore[arg-type]
    annotations = alert["annotations"]
    assert isinstance(annotations, dict)
    assert annotations["summary"] == ADVICE.what
    assert annotations["description"].splitlines() == advice_lines(ADVICE)
    (silent,) = Alertmanager(None, "http://am", (), "")._alerts(trial_message())  # type: ignore[arg-type]
    assert "description" not in str(silent)


def test_a_mail_is_in_the_language_that_is_set() -> None:
    advice = told("coupling", "coupling.C1", None, GERMAN, parts=[PART], progress=GROWING | {"ahead": AHEAD})
    event = EVENT.model_copy(update={"message": advice.what, "advice": advice, "rule": "coupling", "comment": "Anna kommt"})
    mail = compose_mail(settings(), "anna@plant.example", EventMessage(event, "plant-1"), GERMAN)
    assert mail["Subject"] == "[Warnung] pump-7 Test: Kupplung, normal"
    assert "Maschine   plant-1/pump-7\n" in mail.get_content()
    assert "Kommentar  Anna kommt\n" in mail.get_content()
    assert "Zu tun im Betrieb:\n" in mail.get_content()
    assert trial_message(GERMAN).event.message.startswith("Dies ist ein Test")
