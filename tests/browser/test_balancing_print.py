"""The printed page of a balancing, of four planes and eight channels and with a check run, is one page in every language."""

import re

import pytest
from playwright.sync_api import Browser

from estimator.balancing.balancing_check import check_balancing
from estimator.balancing.field_balancing import balance_from_trials
from estimator.machine.document import parse_machine
from service.balancing.printed_page import printed_page
from service.wording.language import ENGLISH, GERMAN, Language
from tests.estimator.balancing.test_field_balancing import DISCS, document, run_of, runs


@pytest.mark.parametrize("language", [ENGLISH, GERMAN], ids=["en", "de"])
def test_a_balancing_is_printed_on_one_page(browser: Browser, language: Language) -> None:
    said = document()
    initial, trials = runs(said)
    found = balance_from_trials(parse_machine(said), initial, trials)
    check = check_balancing(found, run_of(said, "check", dict(zip(DISCS, found.unbalance.tolist(), strict=True)), seed=9))
    page = browser.new_page()
    page.set_content(printed_page(found, check, language))
    assert page.locator("figure").count() == len(found.machine.channels) == 8
    assert len(re.findall(rb"/Type\s*/Page\b(?!s)", page.pdf(prefer_css_page_size=True))) == 1
    page.close()
