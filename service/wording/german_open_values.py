"""Reasons why an estimate has no value, and a run no identification, in German."""

from collections.abc import Mapping

OPEN_VALUES: Mapping[str, str] = {
    # --- why an estimate has no value
    "kept at its nominal value {value} {unit}": "auf seinem Nennwert {value} {unit} gehalten",
    "tied to {other}": "an {other} gebunden",
    "as the document gives it over speed, which is taken as exact": (
        "wie das Dokument es über der Drehzahl angibt, was als genau gilt"
    ),
    "the data leave it open far beyond its standard error": "die Daten lassen es weit über seinen Standardfehler hinaus offen",
    "the data leave it open far beyond its standard error: {why}": (
        "die Daten lassen es weit über seinen Standardfehler hinaus offen: {why}"
    ),
    "the data leave it uncertain by {spread} % of its value (its standard error": (
        "die Daten lassen es um {spread} % seines Wertes unsicher (sein Standardfehler"
    ),
    "the data leave it uncertain by {spread} % of what is expected of it (its standard error": (
        "die Daten lassen es um {spread} % des Erwarteten unsicher (sein Standardfehler"
    ),
    "the data leave it uncertain by {spread} % of the direct terms of its element (its standard error": (
        "die Daten lassen es um {spread} % der direkten Terme seines Elements unsicher (sein Standardfehler"
    ),
    "{limit} % at most)": "höchstens {limit} %)",
    "{limit} % at most): {why}": "höchstens {limit} %): {why}",
    "the data leave it uncertain by {spread} kg m, more than the largest unbalance found": (
        "die Daten lassen sie um {spread} kg m unsicher, mehr als die größte gefundene Unwucht"
    ),
    "the data leave it uncertain by {spread} kg m, more than the largest unbalance found: {why}": (
        "die Daten lassen sie um {spread} kg m unsicher, mehr als die größte gefundene Unwucht: {why}"
    ),
    "only the form over speed that the document assumes determines it, and no data show whether that is true": (
        "nur die Form über der Drehzahl, die das Dokument annimmt, bestimmt es, und keine Daten zeigen, ob sie stimmt"
    ),
    "single runs leave the coupling's stiffness open, by which its load follows: ± {part} %": (
        "einzelne Läufe lassen die Steifigkeit der Kupplung offen, über die seine Last folgt: ± {part} %"
    ),
    "the data say hardly more of it than what is believed beforehand: ± {size} {unit}": (
        "die Daten sagen kaum mehr darüber, als vorher angenommen wird: ± {size} {unit}"
    ),
    "the baseline was identified with other unknowns: identify its runs again": (
        "der Referenzzustand wurde mit anderen Unbekannten identifiziert: seine Läufe erneut identifizieren"
    ),
    # --- ends of runs
    "made by {by}": "angelegt von {by}",
    "identified on request only: dwells at constant speed are for calibrations and balancings": (
        "nur auf Anforderung identifiziert: Haltedrehzahlen sind für Kalibrierungen und zum Auswuchten da"
    ),
    "it came late": "er kam verspätet",
    "not identified: {samples} samples, {fewest} are needed": "nicht identifiziert: {samples} Messwerte, {fewest} sind nötig",
    "not identified: it covers {part} % of the speed range, {least} % are needed": (
        "nicht identifiziert: er überstreicht {part} % des Drehzahlbereichs, {least} % sind nötig"
    ),
}
