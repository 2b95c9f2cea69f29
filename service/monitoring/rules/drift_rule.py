"""Rule for parameters that drift too fast, whatever the diagnosis: limits, name and texts."""

from service.monitoring.rules.finding_rule import AlertRule, FindingRule
from service.monitoring.rules.limit_rule import Level, Rule
from service.wording.finding_texts import FindingTexts
from service.wording.finding_words import rate_words

RATE_OF_CHANGE = AlertRule(
    "rate_of_change",
    # Seasons drift by 0.25 % a week at their steepest.
    limits=Rule(alert=Level(rate_per_cent_per_week=0.5), danger=Level(rate_per_cent_per_week=2)),
    quantities=("rate_per_cent_per_week",),
    elements=("bearing", "seal", "pedestal", "coupling", "disc"),
    mended_by_balancing=("disc",),
)
"""Alert rule of drifts; `service.monitoring.assessment.rate_of_change` finds them."""

RATE_RULE = FindingRule(
    "rate_of_change",
    RATE_OF_CHANGE,
    {"de": "Änderungsrate"},
    {
        "en": FindingTexts(
            what="{parameter} drifts by {size} over the last {runs} runs",
            check=(
                "Whether load, temperature or oil drift with it: then an operating condition in the document takes that out",
            ),
            in_operation=("Take run-downs more often while it drifts",),
            at_next_stop=("Look at {element}",),
            if_danger=("Agree with operations on a stop for {element} before its limit is reached",),
            confirm=("A drift that goes on in the next runs, under the same load and temperature",),
            not_determined=("What causes the drift: the diagnosis says so once it is sure",),
        ),
        "de": FindingTexts(
            what="{parameter} driftet um {size} über die letzten {runs} Läufe",
            check=("Ob Last, Temperatur oder Öl mitdriften: dann nimmt eine Betriebsbedingung im Dokument das heraus",),
            in_operation=("Öfter Ausläufe aufnehmen, solange es driftet",),
            at_next_stop=("{element} ansehen",),
            if_danger=("Mit dem Betrieb einen Stillstand für {element} vereinbaren, bevor der Grenzwert erreicht ist",),
            confirm=("Eine Drift, die in den nächsten Läufen bei gleicher Last und Temperatur weitergeht",),
            not_determined=("Was die Drift verursacht: die Diagnose sagt es, sobald sie sicher ist",),
        ),
    },
    rate_words,
    places=("parameter",),
)
"""Declaration of how drifts are reported."""
