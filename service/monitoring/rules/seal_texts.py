"""Texts of a changed seal: it is found as a bearing is, but the process fluid flows through it, and no oil film carries it."""

from collections.abc import Mapping

from service.wording.finding_texts import FindingTexts
from service.wording.language import Locale
from service.wording.repeated_texts import NEW_BASELINE, NEW_BASELINE_DE, TAKE_RUN_DOWN, TAKE_RUN_DOWN_DE

SEAL_TEXTS: Mapping[Locale, FindingTexts] = {
    "en": FindingTexts(
        what="{judgement}: {size}, {compared}, since {since}",
        check=(
            "Pressure difference, flow and temperature of the fluid at {element}, since {since}: stiffness follows them",
            "Head and efficiency at the same flow, since {since}: a worn seal leaks more",
        ),
        in_operation=(
            TAKE_RUN_DOWN,
            "Take run-downs from the same operating point, and note temperature and pressures of the fluid",
        ),
        at_next_stop=("Open {element}: clearance, rub marks, swirl brakes, fit in the casing", NEW_BASELINE),
        if_danger=("Agree on the earliest stop for {element} with operations; watch vibration and leakage until then",),
        confirm=("A clearance that is not as it was made", "Leakage, head or efficiency that moved with it"),
        not_determined=("Whether {id} has worn, or the pressure difference across it has changed",),
    ),
    "de": FindingTexts(
        what="{judgement}: {size}, {compared}, seit {since}",
        check=(
            "Druckdifferenz, Menge und Temperatur des Prozessmediums an {element}, seit {since}: ihnen folgt die Steifigkeit",
            "Förderhöhe und Wirkungsgrad bei gleicher Menge, seit {since}: eine verschlissene Dichtung lässt mehr durch",
        ),
        in_operation=(
            TAKE_RUN_DOWN_DE,
            "Ausläufe vom gleichen Betriebspunkt aus aufnehmen, Temperatur und Drücke des Mediums notieren",
        ),
        at_next_stop=("{element} öffnen: Spaltweite, Anstreifspuren, Drallbrecher, Sitz im Gehäuse", NEW_BASELINE_DE),
        if_danger=(
            "Mit dem Betrieb den frühesten Stillstand für {element} vereinbaren; bis dahin Schwingung und Leckage beobachten",
        ),
        confirm=(
            "Eine Spaltweite, die nicht ist wie gefertigt",
            "Leckage, Förderhöhe oder Wirkungsgrad, die mitgelaufen sind",
        ),
        not_determined=("Ob {id} verschlissen ist oder sich die Druckdifferenz über {id} geändert hat",),
    ),
}
