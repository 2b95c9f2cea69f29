"""The findings that are reported to people: all declarations, in the order in which they are shown.

Each finding is declared once, in the module of its group: alert rule and limits, names and texts in each language. There is
one declaration for each of the estimator's `FINDING_KINDS`, which `finding_catalogue.py` requires and looks up.
"""

from service.monitoring.rules.coupling_and_bearing_findings import COUPLING_AND_BEARING_FINDINGS
from service.monitoring.rules.finding_rule import FindingRule
from service.monitoring.rules.measurement_findings import MEASUREMENT_FINDINGS
from service.monitoring.rules.oil_film_findings import OIL_FILM_FINDINGS
from service.monitoring.rules.rotor_findings import ROTOR_FINDINGS

FINDING_RULES: tuple[FindingRule, ...] = (
    *COUPLING_AND_BEARING_FINDINGS,
    *OIL_FILM_FINDINGS,
    *ROTOR_FINDINGS,
    *MEASUREMENT_FINDINGS,
)
