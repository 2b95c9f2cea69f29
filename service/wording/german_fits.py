"""Sentences on fits, runs and baselines, in German."""

from collections.abc import Mapping

FITS: Mapping[str, str] = {
    "accepted: {rest}": "angenommen: {rest}",
    "accepted": "angenommen",
    "the stated noise is too large: {rest}": "das angegebene Rauschen ist zu groß: {rest}",
    "phasors scatter over {factor} times less than stated: are the noise and the unit of amplitudes right?": (
        "Zeiger streuen über {factor}-mal weniger als angegeben: stimmen das Rauschen und die Einheit der Amplituden?"
    ),
    "phasors scatter {factor} times less than stated: are the noise and the unit of amplitudes right?": (
        "Zeiger streuen {factor}-mal weniger als angegeben: stimmen das Rauschen und die Einheit der Amplituden?"
    ),
    "no noise to be seen: {rest}": "kein Rauschen zu sehen: {rest}",
    "the model does not fit the data: {rest}": "das Modell passt nicht zu den Daten: {rest}",
    "too much does not fit: {rest}": "zu viel passt nicht: {rest}",
    "not converged, {rest}": "nicht konvergiert, {rest}",
    "χ²/dof {reduced}, expected 1 ± {spread}": "χ²/Freiheitsgrad {reduced}, erwartet 1 ± {spread}",
    "χ²/dof {reduced}, expected 1 ± {spread}, most of it at {channel}": (
        "χ²/Freiheitsgrad {reduced}, erwartet 1 ± {spread}, das meiste davon an {channel}"
    ),
    "noise estimated as {noise} % and {floor} m": "Rauschen geschätzt zu {noise} % und {floor} m",
    "{left} of {usable} phasors left out as outliers": "{left} von {usable} Zeigern als Ausreißer ausgelassen",
    (
        "residuals of neighbouring speeds are alike (correlation {correlation}): the model may be slightly wrong, or the "
        "samples overlap"
    ): (
        "Residuen benachbarter Drehzahlen ähneln sich (Korrelation {correlation}): Das Modell ist womöglich etwas falsch, "
        "oder die Messwerte überlappen"
    ),
    "intervals are widened": "Vertrauensbereiche sind verbreitert",
    "estimates leave open what a diagnosis has named: {errors}": (
        "die Schätzungen lassen offen, was eine Diagnose genannt hat: {errors}"
    ),
    "probe {name} clearly has another gain than the document says: estimates allow for that": (
        "Aufnehmer {name} hat deutlich eine andere Verstärkung, als das Dokument sagt: Die Schätzungen berücksichtigen das"
    ),
    "of the probes {names} one at least clearly has another gain than documented: estimates allow for that": (
        "von den Aufnehmern {names} hat mindestens einer deutlich eine andere Verstärkung als dokumentiert: Die Schätzungen "
        "berücksichtigen das"
    ),
    (
        "the run contradicts the document's calibration: if something has changed since, calibrate again or take "
        "`calibration` out (χ²/dof with it {reduced}"
    ): (
        "der Lauf widerspricht der Kalibrierung des Dokuments: Falls sich seither etwas geändert hat, neu kalibrieren oder "
        "`calibration` herausnehmen (χ²/Freiheitsgrad mit ihr {reduced}"
    ),
    "the run fits the document's calibration badly (χ²/dof with it {reduced}": (
        "der Lauf passt schlecht zur Kalibrierung des Dokuments (χ²/Freiheitsgrad mit ihr {reduced}"
    ),
    (
        "bearings or couplings have changed since the calibration: their coefficients are fitted without it, measuring chains "
        "and materials with it (with all of it χ²/dof {reduced})"
    ): (
        "Lager oder Kupplungen haben sich seit der Kalibrierung geändert: Ihre Koeffizienten sind ohne sie angepasst, "
        "Messketten und Werkstoffe mit ihr (mit allem χ²/Freiheitsgrad {reduced})"
    ),
    "{name} furthest from it, by {errors} standard errors": "{name} am weitesten von ihr, um {errors} Standardfehler",
    "{name} furthest from it, by {errors} standard errors): {rest}": (
        "{name} am weitesten von ihr, um {errors} Standardfehler): {rest}"
    ),
    "the gain of {channel} fits best at {factor} times its calibrated value, turned by {angle}°): {rest}": (
        "die Verstärkung von {channel} passt am besten beim {factor}-Fachen ihres kalibrierten Werts, um {angle}° gedreht): "
        "{rest}"
    ),
    "{count} runs averaged: {rest}": "{count} Läufe gemittelt: {rest}",
    "each accepted": "jeder angenommen",
    "the speed left the speed range": "die Drehzahl verließ den Drehzahlbereich",
    "the speed turned back": "die Drehzahl kehrte um",
    "the speed stood still": "die Drehzahl blieb stehen",
    "a pause in the data": "eine Pause in den Daten",
    "the sense of rotation changed": "die Drehrichtung wechselte",
    "the source fell silent": "die Quelle verstummte",
    "the machine's document was revised": "das Dokument der Maschine wurde geändert",
    "the clock was set back": "die Uhr wurde zurückgestellt",
    "no more samples came": "es kamen keine Messwerte mehr",
    "the baseline has {have} of {wanted} identifications": "der Referenzzustand hat {have} von {wanted} Identifikationen",
    (
        "{count} more are by a release that balances the loads on oil films otherwise, with other stiffnesses of couplings "
        "and pedestals: they are not compared, identify their runs again"
    ): (
        "{count} weitere sind von einer Version, die die Lasten der Ölfilme anders verteilt, mit anderen Steifigkeiten von "
        "Kupplungen und Lagerböcken: sie werden nicht verglichen, ihre Läufe erneut identifizieren"
    ),
    "identification {id} is part of the baseline": "Identifikation {id} gehört zum Referenzzustand",
    "identification {id} does not count: {rest}": "Identifikation {id} zählt nicht: {rest}",
    "not accepted, identified again, dated in the future, or of other speeds than the baseline": (
        "nicht angenommen, erneut identifiziert, in der Zukunft datiert, oder von anderen Drehzahlen als der Referenzzustand"
    ),
    "the noise hides it: more samples near the resonances, or less noise, are needed": (
        "das Rauschen verdeckt es: mehr Messwerte nahe den Resonanzen, oder weniger Rauschen, sind nötig"
    ),
    "where the fit ended a film carries no journal, so that the train has no modes there": (
        "wo die Anpassung endete, trägt ein Ölfilm keinen Zapfen, sodass der Wellenstrang dort keine Moden hat"
    ),
    "the speed range {covered} r/min crosses no mode that moves {element} this way": (
        "der Drehzahlbereich {covered} 1/min überstreicht keine Mode, die {element} so bewegt"
    ),
    "the nearest that does lies at {rpm} r/min": "die nächste, die es tut, liegt bei {rpm} 1/min",
    (
        "what it does cannot be told from what others do, most of all {other} (correlation {correlation}): a wider speed "
        "range, more probes or a fixed value there would help"
    ): (
        "seine Wirkung lässt sich nicht von der anderer unterscheiden, vor allem von {other} (Korrelation {correlation}): "
        "ein weiterer Drehzahlbereich, mehr Aufnehmer oder ein fester Wert dort würden helfen"
    ),
    "not every run determines it": "nicht jeder Lauf bestimmt es",
    "met": "eingehalten",
    "not met": "nicht eingehalten",
    "{left} of {usable} phasors left out as outliers, most of them of {channel}": (
        "{left} von {usable} Zeigern als Ausreißer ausgelassen, die meisten von {channel}"
    ),
    "it turns at {low} to {high} r/min and never enters the document's speed range, {first} to {last} r/min: {rest}": (
        "sie dreht mit {low} bis {high} 1/min und kommt nie in den Drehzahlbereich des Dokuments, {first} bis {last} 1/min: "
        "{rest}"
    ),
    "is the unit of the speeds right?": "stimmt die Einheit der Drehzahlen?",
    "the speed range {covered} r/min crosses no mode that moves {element}": (
        "der Drehzahlbereich {covered} 1/min überstreicht keine Mode, die {element} bewegt"
    ),
    "open": "offen",
}
