"""Sentences that are stored in English, in German: names in braces are places for what stands there."""

from collections.abc import Mapping

GERMAN_STORED: Mapping[str, str] = {
    # --- fits, runs, baselines
    "accepted: {rest}": "angenommen: {rest}",
    "accepted": "angenommen",
    "the stated noise is too large: {rest}": "das angegebene Rauschen ist zu groß: {rest}",
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
    "the speed range {covered} rpm crosses no mode that moves {element} this way": (
        "der Drehzahlbereich {covered} 1/min überstreicht keine Mode, die {element} so bewegt"
    ),
    "the nearest that does lies at {rpm} rpm": "die nächste, die es tut, liegt bei {rpm} 1/min",
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
    "the speed range {covered} rpm crosses no mode that moves {element}": (
        "der Drehzahlbereich {covered} 1/min überstreicht keine Mode, die {element} bewegt"
    ),
    "open": "offen",
    # --- verdicts on fits
    "noise estimated as {noise} % and {floor} m, at {channels}": (
        "Rauschen geschätzt zu {noise} % und {floor} m, an {channels}"
    ),
    "{channel} {times} times that": "{channel} das {times}-Fache",
    "residuals of neighbouring speeds are alike, correlation {correlation}, at most {most} is noise": (
        "Residuen benachbarter Drehzahlen ähneln sich, Korrelation {correlation}, höchstens {most} ist Rauschen"
    ),
    "residuals of {channel} at neighbouring speeds are alike, correlation {correlation}, at most {most} is noise": (
        "Residuen von {channel} bei benachbarten Drehzahlen ähneln sich, Korrelation {correlation}, höchstens {most} ist "
        "Rauschen"
    ),
    "the best of {starts} starts was reached once only: whether there is a better one is open": (
        "die beste von {starts} Anfangsschätzungen führte nur einmal dorthin: ob es eine bessere Lösung gibt, ist offen"
    ),
    (
        "coefficients do not follow the speed as the document's forms say: they deviate by {size} % (twice the logarithm of "
        "the likelihood ratio {ratio}"
    ): (
        "Koeffizienten folgen der Drehzahl nicht, wie die Formen des Dokuments es sagen: sie weichen um {size} % ab "
        "(doppelter Logarithmus des Likelihood-Quotienten {ratio}"
    ),
    "{limit} at most is noise)": "höchstens {limit} ist Rauschen)",
    (
        "the oil film of {film} deviates from its model by {times} times what the document says (discrepancy): geometry, "
        "oil, supports or coupling are not as described"
    ): (
        "der Ölfilm von {film} weicht {times}-mal so weit von seinem Modell ab, wie das Dokument sagt (discrepancy): "
        "Geometrie, Öl, Abstützung oder Kupplung sind nicht wie beschrieben"
    ),
    (
        "oil films deviate from their model by {times} times what the document says (discrepancy): geometry, oil, supports "
        "or coupling are not as described"
    ): (
        "die Ölfilme weichen {times}-mal so weit von ihrem Modell ab, wie das Dokument sagt (discrepancy): Geometrie, Öl, "
        "Abstützung oder Kupplung sind nicht wie beschrieben"
    ),
    (
        "the oil films' viscosity falls with speed, about as its power {power} ({errors} standard errors): the document "
        "gives one viscosity for every speed"
    ): (
        "die Viskosität der Ölfilme fällt mit der Drehzahl, etwa mit deren Potenz {power} ({errors} Standardfehler): das "
        "Dokument gibt eine Viskosität für alle Drehzahlen an"
    ),
    (
        "the oil films' viscosity rises with speed, about as its power {power} ({errors} standard errors): the document "
        "gives one viscosity for every speed"
    ): (
        "die Viskosität der Ölfilme steigt mit der Drehzahl, etwa mit deren Potenz {power} ({errors} Standardfehler): das "
        "Dokument gibt eine Viskosität für alle Drehzahlen an"
    ),
    (
        "the oil films want {force} to be about {wanted} N, where the document says {stated} N exactly ({errors} standard "
        "errors): state how far it may be off ({spread})"
    ): (
        "die Ölfilme verlangen {force} von etwa {wanted} N, wo das Dokument genau {stated} N nennt ({errors} "
        "Standardfehler): angeben, wie weit der Wert abweichen kann ({spread})"
    ),
    "loads of bearings rest on {force} being {stated} N: the films would not show an error of {error} N in it": (
        "die Lagerlasten beruhen darauf, dass {force} {stated} N beträgt: die Ölfilme würden einen Fehler von {error} N darin "
        "nicht zeigen"
    ),
    "loads of bearings rest on {force} being {stated} N: the films would not show any error in it": (
        "die Lagerlasten beruhen darauf, dass {force} {stated} N beträgt: die Ölfilme würden keinen Fehler darin zeigen"
    ),
    (
        "oil films deviate from their model by about {size} % from one {length} % of the speed range to the next: more than "
        "the document says (discrepancy)"
    ): (
        "die Ölfilme weichen um etwa {size} % von einem Abschnitt von {length} % des Drehzahlbereichs zum nächsten von ihrem "
        "Modell ab: mehr, als das Dokument sagt (discrepancy)"
    ),
    (
        "oil films deviate from their model more sharply over speed than it allows for, by about {size} % from one {length} % "
        "of the speed range to the next: intervals are widened"
    ): (
        "die Ölfilme weichen schärfer über der Drehzahl von ihrem Modell ab, als es zulässt, um etwa {size} % von einem "
        "Abschnitt von {length} % des Drehzahlbereichs zum nächsten: Vertrauensbereiche sind verbreitert"
    ),
    (
        "coefficients deviate by {size} % over speed from the document's forms, beside oil films that deviate themselves: "
        "intervals are widened"
    ): (
        "Koeffizienten weichen über der Drehzahl um {size} % von den Formen des Dokuments ab, neben Ölfilmen, die selbst "
        "abweichen: Vertrauensbereiche sind verbreitert"
    ),
    (
        "the table of {element} seems off by {size} %, more than its scale_spread of {spread} % says: intervals are widened "
        "(state its coefficients, or its spread, as they are)"
    ): (
        "die Tabelle von {element} scheint um {size} % falsch zu sein, mehr, als ihr scale_spread von {spread} % sagt: "
        "Vertrauensbereiche sind verbreitert (ihre Koeffizienten oder scale_spread berichtigen)"
    ),
    (
        "at {speed} r/min a journal would be within a twentieth of the clearance of its bearing: are geometry and oil right? "
        "{load} N on bearing '{id}', whose journal touches first, at rest are {pressure} MPa over diameter and length"
    ): (
        "bei {speed} 1/min käme ein Zapfen seinem Lager auf ein Zwanzigstel des Lagerspiels nahe: stimmen Geometrie und Öl? "
        "{load} N auf Lager '{id}', dessen Zapfen zuerst berührt, sind im Stillstand {pressure} MPa über Durchmesser mal Länge"
    ),
    (
        "at {speed} r/min a journal would be within a twentieth of the clearance of its bearing: are geometry and oil right? "
        "{load} N on bearing '{id}' at rest are {pressure} MPa over diameter and length"
    ): (
        "bei {speed} 1/min käme ein Zapfen seinem Lager auf ein Zwanzigstel des Lagerspiels nahe: stimmen Geometrie und Öl? "
        "{load} N auf Lager '{id}' sind im Stillstand {pressure} MPa über Durchmesser mal Länge"
    ),
    "usual is 0.5 to 3 MPa. Below the speed at which films carry, give valid_above_rpm": (
        "üblich sind 0,5 bis 3 MPa. Unterhalb der Drehzahl, ab der die Filme tragen, valid_above_rpm angeben"
    ),
    (
        "valid_above_rpm of a film is {speed} r/min, and the speed range ends at {end} r/min: at no speed of it all films "
        "carry"
    ): (
        "valid_above_rpm eines Films ist {speed} 1/min, und der Drehzahlbereich endet bei {end} 1/min: bei keiner Drehzahl "
        "darin tragen alle Filme"
    ),
    (
        "on the oil films as they are described the train would whirl from {speed} r/min on, within its speed range up to "
        "{end} r/min: are clearances, oil and preload right?"
    ): (
        "in den Ölfilmen, wie sie beschrieben sind, hätte der Wellenstrang ab {speed} 1/min Ölwirbel (Oil Whirl), innerhalb "
        "seines Drehzahlbereichs bis {end} 1/min: stimmen Lagerspiele, Öl und Vorspannung?"
    ),
    (
        "at {speed} r/min a mode would grow (damping ratio {ratio}), so that the train could not run there: usual is more "
        "than 0.01"
    ): (
        "bei {speed} 1/min würde eine Mode aufklingen (Dämpfungsgrad {ratio}), sodass der Wellenstrang dort nicht laufen "
        "könnte: üblich ist mehr als 0,01"
    ),
    "are damping and cross-coupled stiffness right?": "stimmen Dämpfung und Kreuzsteifigkeit?",
    "a shaft is held neither by two bearings nor by a coupling: nothing carries its weight": (
        "eine Welle wird weder von zwei Lagern noch von einer Kupplung gehalten: nichts trägt ihr Gewicht"
    ),
    "not physically possible: at {speed} rpm, where the machine ran, {what}": (
        "physikalisch nicht möglich: bei {speed} 1/min, wo die Maschine lief, {what}"
    ),
    "a mode of {frequency} cycles per minute grows (damping ratio {ratio})": (
        "klingt eine Mode von {frequency} Schwingungen je Minute auf (Dämpfungsgrad {ratio})"
    ),
    "the shaft leaves its bearings without oscillating": "verlässt die Welle ihre Lager, ohne zu schwingen",
    "with the run-out of coupling {names}, which turns with the shaft, it would be accepted": (
        "mit einem Rundlauffehler der Kupplung {names}, der mit der Welle umläuft, würde es angenommen"
    ),
    "disc {disc} would be {size} mm eccentric: are the amplitudes' units right?": (
        "Scheibe {disc} wäre {size} mm exzentrisch: stimmen die Einheiten der Amplituden?"
    ),
    "the unbalances would be G {grade}, {against}: {meaning}": "die Unwuchten wären G {grade}, {against}: {meaning}",
    "ISO 21940-11 knows grades from G {low} to G {high}": "ISO 21940-11 kennt Stufen von G {low} bis G {high}",
    "the document states G {grade}": "das Dokument gibt G {grade} an",
    "are the amplitudes' units right?": "stimmen die Einheiten der Amplituden?",
    "{left} of {all} phasors left out for their quality ({reasons})": (
        "{left} von {all} Zeigern ihrer Güte wegen ausgelassen ({reasons})"
    ),
    "{count} not-available": "{count} ohne Wert",
    "{count} bad": "{count} schlecht",
    "{count} out-of-range": "{count} außerhalb des Messbereichs",
    "{count} saturated": "{count} übersteuert",
    "{count} frozen": "{count} eingefroren",
    "{count} outlier": "{count} Ausreißer",
    "{count} sweep-rate": "{count} zu rasch durchfahren",
    "{count} sweep-rate-beat": "{count} mit Schwebung hinter einer Resonanz",
    "{count} half-power": "{count} zwischen Halbwertspunkten",
    "{count} not-accepted": "{count} außerhalb der zulässigen Drehzahlen",
    # --- gaps beside a fit
    "with the shaft centreline of {count} channels, χ²/dof {reduced}": (
        "mit der Wellenlage von {count} Kanälen, χ²/Freiheitsgrad {reduced}"
    ),
    "the shaft centreline is left out: it does not fit together with the vibration, χ²/dof {reduced}": (
        "die Wellenlage ist ausgelassen: sie passt nicht mit der Schwingung zusammen, χ²/Freiheitsgrad {reduced}"
    ),
    (
        "the gap of {channel} jumps by {size} µm at {speed} r/min and is left out: the probe, its holder or its cable has "
        "moved"
    ): (
        "der Spalt von {channel} springt bei {speed} 1/min um {size} µm und ist ausgelassen: der Aufnehmer, sein Halter oder "
        "sein Kabel hat sich bewegt"
    ),
    "the gap of {channel} does not move as the journals do, χ²/dof {reduced}": (
        "der Spalt von {channel} bewegt sich nicht wie die Zapfen, χ²/Freiheitsgrad {reduced}"
    ),
    "the gap of {channel} moves the other way than the journals do: gap_grows is {said} in the document, is it {other}?": (
        "der Spalt von {channel} bewegt sich umgekehrt zu den Zapfen: gap_grows ist {said} im Dokument, ist es {other}?"
    ),
    "the gap of {channel} hardly moves, {ratio} times as the journals do: is its input coupled for direct current?": (
        "der Spalt von {channel} bewegt sich kaum, {ratio}-mal so viel wie die Zapfen: lässt sein Eingang Gleichspannung "
        "durch?"
    ),
    "the gap of {channel} moves {ratio} times as the journals do: are its unit and sensitivity right?": (
        "der Spalt von {channel} bewegt sich {ratio}-mal so viel wie die Zapfen: stimmen seine Einheit und Empfindlichkeit?"
    ),
    "it is left out": "er ist ausgelassen",
    # --- wrong conventions
    "the run fits {times} times better with {what}": "der Lauf passt {times}-mal besser mit {what}",
    "the run fits over {times} times better with {what}": "der Lauf passt über {times}-mal besser mit {what}",
    "{what}, or equally well with {others}": "{what}, oder ebenso gut mit {others}",
    "{one} or with {other}": "{one} oder mit {other}",
    "{what}, though something else is wrong too": "{what}, doch ist noch etwas anderes falsch",
    "the opposite sign of the phase: lead sent as lag, or lag as lead": (
        "umgekehrtem Vorzeichen der Phase: Voreilung als Nacheilung gesendet oder umgekehrt"
    ),
    "the opposite sense of rotation": "umgekehrter Drehrichtung",
    "phases in rad that were sent as degrees": "Phasen in rad, die als Grad gesendet wurden",
    "the probes of every pair swapped with each other": "den Aufnehmern jedes Paares untereinander vertauscht",
    "{probes} swapped with each other": "{probes} untereinander vertauscht",
    "0-to-peak amplitudes that were sent as peak-to-peak": "Scheitelwerten, die als Spitze-Spitze-Werte gesendet wurden",
    "peak-to-peak amplitudes that were sent as 0-to-peak": "Spitze-Spitze-Werten, die als Scheitelwerte gesendet wurden",
    "amplitudes in {meant} that were sent as {sent}": "Amplituden in {meant}, die als {sent} gesendet wurden",
    "amplitudes in {meant} that were sent as {sent}?": "Amplituden in {meant}, die als {sent} gesendet wurden?",
    "speeds in {meant} that were sent as {sent}": "Drehzahlen in {meant}, die als {sent} gesendet wurden",
    "speeds in {meant} that were sent as {sent}?": "Drehzahlen in {meant}, die als {sent} gesendet wurden?",
    "it turned at {slowest} to {fastest} r/min, {part} % of {low} to {high} r/min": (
        "sie drehte mit {slowest} bis {fastest} 1/min, {part} % von {low} bis {high} 1/min"
    ),
    "it turned at {slowest} to {fastest} r/min, {part} % of {low} to {high} r/min: {meaning}": (
        "sie drehte mit {slowest} bis {fastest} 1/min, {part} % von {low} bis {high} 1/min: {meaning}"
    ),
    "a run sweeps through it": "ein Lauf durchfährt ihn",
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
    "the data say hardly more of it than what is believed beforehand: ± {size} {unit}": (
        "die Daten sagen kaum mehr darüber, als vorher angenommen wird: ± {size} {unit}"
    ),
    "the baseline was identified with other unknowns: identify its runs again": (
        "der Referenzzustand wurde mit anderen Unbekannten identifiziert: seine Läufe erneut identifizieren"
    ),
    # --- ends of runs
    "it came late": "er kam verspätet",
    "not identified: {samples} samples, {fewest} are needed": "nicht identifiziert: {samples} Messwerte, {fewest} sind nötig",
    "not identified: it covers {part} % of the speed range, {least} % are needed": (
        "nicht identifiziert: er überstreicht {part} % des Drehzahlbereichs, {least} % sind nötig"
    ),
    # --- orbits
    "whether {channels} are swapped cannot be seen: {why}": "ob {channels} vertauscht sind, ist nicht zu sehen: {why}",
    "whether {channel} is swapped cannot be seen: {why}": "ob {channel} vertauscht ist, ist nicht zu sehen: {why}",
    "one probe alone sees no orbit": "ein Aufnehmer allein sieht keine Wellenbahn",
    "the probes look along one line": "die Aufnehmer messen entlang einer Linie",
    "the model's own orbit is forward for {part} % of all unbalances only": (
        "die Wellenbahn des Modells selbst läuft nur für {part} % aller Unwuchten gleichläufig um"
    ),
    "{samples} samples below {speed} rpm, where it is certain": "{samples} Messwerte unter {speed} 1/min, wo es sicher ist",
    "{fewest} are needed": "{fewest} sind nötig",
    "the speeds below {speed} rpm, where it is certain, lie too near to each other": (
        "die Drehzahlen unter {speed} 1/min, wo es sicher ist, liegen zu dicht beieinander"
    ),
    "the orbit is small beside those elsewhere, so it may turn either way": (
        "die Wellenbahn ist klein gegen die anderen und kann daher in beiden Richtungen umlaufen"
    ),
    "the orbit is too flat or too small for the noise": "die Wellenbahn ist zu flach oder zu klein für das Rauschen",
    "the document gives no stiffness of bearing {names}": "das Dokument gibt keine Steifigkeit von Lager {names} an",
    "the document's machine has no critical speed": "die Maschine des Dokuments hat keine kritische Drehzahl",
    "the orbits at all {count} pairs of probes turn backward: the sense of rotation is wrong, or every pair is swapped": (
        "die Wellenbahnen an allen {count} Aufnehmerpaaren laufen gegenläufig um: die Drehrichtung ist falsch, oder jedes "
        "Paar ist vertauscht"
    ),
    "the orbit at {channels} turns backward, not forward: {meaning}": (
        "die Wellenbahn an {channels} läuft gegenläufig um, nicht gleichläufig: {meaning}"
    ),
    "the orbit at {channels} turns backward, not forward, as at {count} of {all} pairs: {meaning}": (
        "die Wellenbahn an {channels} läuft gegenläufig um, nicht gleichläufig, wie an {count} von {all} Paaren: {meaning}"
    ),
    "the orbit at {channels} turns backward, not forward as at the other pairs: {meaning}": (
        "die Wellenbahn an {channels} läuft gegenläufig um, nicht gleichläufig wie an den anderen Paaren: {meaning}"
    ),
    "the channels are swapped, or the sense of rotation is wrong": (
        "die Kanäle sind vertauscht, oder die Drehrichtung ist falsch"
    ),
    "the channels are swapped, or the sense of rotation is wrong and those of the other pairs are swapped": (
        "die Kanäle sind vertauscht, oder die Drehrichtung ist falsch und die der anderen Paare sind vertauscht"
    ),
    "these channels are swapped": "diese Kanäle sind vertauscht",
    # --- field balancing
    "influence coefficients, {error} ({measure})": "Einflusszahlen, {error} ({measure})",
    "influence coefficients taken, no model predicts clearly better: {listed} ({measure})": (
        "Einflusszahlen verwendet, kein Modell sagt deutlich besser voraus: {listed} ({measure})"
    ),
    "{method} taken, which predicts best: {listed} ({measure})": (
        "{method} verwendet, was am besten voraussagt: {listed} ({measure})"
    ),
    "{method} taken as asked: {listed} ({measure})": "{method} verwendet wie verlangt: {listed} ({measure})",
    "{method} taken": "{method} verwendet",
    "{method} taken as asked": "{method} verwendet wie verlangt",
    "influence coefficients": "Einflusszahlen",
    "influence coefficients {error}": "Einflusszahlen {error}",
    "model": "Modell",
    "model {error}": "Modell {error}",
    "corrected model": "berichtigtes Modell",
    "scaled model": "skaliertes Modell",
    "corrected model {error}": "berichtigtes Modell {error}",
    "scaled model {error}": "skaliertes Modell {error}",
    "errors of predicted vectors over what the trial weights changed, runs left out in turn": (
        "Fehler vorausgesagter Zeiger über dem, was die Testmassen änderten, je ein Lauf ausgelassen"
    ),
    "with these trials no run can be left out to compare them with the model": (
        "bei diesen Testläufen lässt sich keiner auslassen, um sie mit dem Modell zu vergleichen"
    ),
    "with these trials no run can be left out to test them": (
        "bei diesen Testläufen lässt sich keiner auslassen, um sie zu prüfen"
    ),
    (
        "{plane} does nearly what other planes together do at the measuring points, only {part} % is its own: weights on it "
        "nearly cancel theirs, and are no better known than their intervals say"
    ): (
        "{plane} wirkt an den Messpunkten fast wie andere Ebenen zusammen, nur {part} % ist ihr eigen: Massen auf ihr heben "
        "sich mit deren fast auf und sind nicht besser bekannt, als ihre Vertrauensbereiche sagen"
    ),
    (
        "{planes} do nearly the same at the measuring points, only {part} % is their own: weights on them nearly cancel, and "
        "are no better known than their intervals say"
    ): (
        "{planes} wirken an den Messpunkten fast gleich, nur {part} % ist ihnen eigen: Massen auf ihnen heben sich fast auf "
        "und sind nicht besser bekannt, als ihre Vertrauensbereiche sagen"
    ),
    (
        "{plane} does nothing at the measuring points that could be told from their scatter: trial weights on it are too "
        "small, or runs contradict each other (was a weight or its angle entered wrongly?)"
    ): (
        "{plane} bewirkt an den Messpunkten nichts, was sich von deren Streuung unterscheiden ließe: Testmassen darauf "
        "sind zu klein, oder Läufe widersprechen einander (wurde eine Masse oder ihr Winkel falsch eingegeben?)"
    ),
    (
        "{plane} cannot be told apart from {others}: only {part} % of what it does at the measuring points is its own. "
        "Weights on both would nearly cancel"
    ): (
        "{plane} lässt sich nicht von {others} unterscheiden: nur {part} % seiner Wirkung an den Messpunkten ist ihm eigen. "
        "Massen auf beiden würden sich fast aufheben"
    ),
    "{others} together": "{others} zusammen",
    "{plane} is left out. Another speed or measuring point may tell them apart": (
        "{plane} ist ausgelassen. Eine andere Drehzahl oder ein anderer Messpunkt könnte sie unterscheiden"
    ),
    (
        "{run} differs from {other} by no more than the error of the vectors: its trial weight is too small, or was entered "
        "in the wrong unit"
    ): (
        "{run} unterscheidet sich von {other} um nicht mehr als den Fehler der Zeiger: die Testmasse ist zu klein oder wurde "
        "in der falschen Einheit eingegeben"
    ),
    "left out, as the runs do not all show them: {points}": "ausgelassen, weil nicht alle Läufe sie zeigen: {points}",
    "{points} and {count} more": "{points} und {count} weitere",
    "{channel} at {speed} r/min": "{channel} bei {speed} 1/min",
    (
        "no trial weight was on {discs}: what their unbalances do counts as if it came from {planes}, in the residual "
        "unbalance, too"
    ): (
        "auf {discs} war keine Testmasse: die Wirkung ihrer Unwuchten zählt, als käme sie von {planes}, auch in der "
        "Restunwucht"
    ),
    (
        "no run was repeated: intervals and promises hold the noise of the vectors, but not how the rotor settles anew at "
        "each start"
    ): (
        "kein Lauf wurde wiederholt: Vertrauensbereiche und Zusagen enthalten das Rauschen der Zeiger, aber nicht, wie sich "
        "der Rotor bei jedem Start neu setzt"
    ),
    "a repeated initial run would tell": "ein wiederholter Urlauf würde es zeigen",
    "run {number}": "Lauf {number}",
    # --- warnings of documents
    "{speed} r/min: few machines are that slow": "{speed} 1/min: so langsam sind wenige Maschinen",
    "was {value} Hz meant, {speed} r/min?": "waren {value} Hz gemeint, {speed} 1/min?",
    "{running} r/min lies below the speed range, {low} to {high} r/min": (
        "{running} 1/min liegt unter dem Drehzahlbereich, {low} bis {high} 1/min"
    ),
    "{density} kg/m³: steel has 7850 kg/m³": "{density} kg/m³: Stahl hat 7850 kg/m³",
    "was {value} g/cm³ meant?": "waren {value} g/cm³ gemeint?",
    "{mass} kg is {times} times the mass of shaft '{shaft}', {own} kg: usual is 0.1 to 5 times": (
        "{mass} kg ist das {times}-Fache der Masse von Welle '{shaft}', {own} kg: üblich ist das 0,1- bis 5-Fache"
    ),
    "was {value} g meant, {mass} kg?": "waren {value} g gemeint, {mass} kg?",
    "{elevation} µm is more than the radial clearance, {clearance} µm: usual are some 10 µm": (
        "{elevation} µm ist mehr als das radiale Lagerspiel, {clearance} µm: üblich sind einige 10 µm"
    ),
    "elevations are in m, over the place at which couplings carry nothing": (
        "Höhenlagen sind in m, über der Lage, bei der Kupplungen nichts tragen"
    ),
    "{allowed} {unit}: growth from cold to hot alone passes it": (
        "{allowed} {unit}: schon was von kalt nach warm wächst, überschreitet das"
    ),
    "{allowed} {unit}: no alarm would come in time": "{allowed} {unit}: kein Alarm käme rechtzeitig",
    "usual is {low} to {high} {unit}": "üblich ist {low} bis {high} {unit}",
    (
        "{clearance} µm is {part} of the radius, {radius} m: usual is 0.001 to 0.002 of it, half the difference of the "
        "diameters"
    ): (
        "{clearance} µm ist das {part}-Fache des Radius, {radius} m: üblich ist das 0,001- bis 0,002-Fache, die halbe "
        "Differenz der Durchmesser"
    ),
    "{value} °C: oil is hardly ever above {hottest} °C there": "{value} °C: Öl ist dort kaum je wärmer als {hottest} °C",
    "the bore of a {profile} bearing without preload is round: usual is 0.3 to 0.6": (
        "die Bohrung eines Lagers der Form {profile} ist ohne Vorspannung rund: üblich ist 0,3 bis 0,6"
    ),
    "was {value} °F meant, {celsius} °C?": "waren {value} °F gemeint, {celsius} °C?",
    "{speed} r/min is not below the end of the speed range, {fastest} r/min: no sample would be left": (
        "{speed} 1/min liegt nicht unter dem Ende des Drehzahlbereichs, {fastest} 1/min: keine Messung bliebe übrig"
    ),
    "{length} m is {part} times the diameter, {diameter} m: usual is 0.3 to 1.2 times": (
        "{length} m ist das {part}-Fache des Durchmessers, {diameter} m: üblich ist das 0,3- bis 1,2-Fache"
    ),
    "{diameter} m, but shaft '{shaft}' is {thick} m thick at station {station} m: the journal is that part of the shaft": (
        "{diameter} m, aber Welle '{shaft}' ist an der Stelle {station} m {thick} m dick: der Zapfen ist dieser Teil der Welle"
    ),
    "{value} {unit}: usual is {least} to {most}": "{value} {unit}: üblich ist {least} bis {most}",
    "was {value} N/µm meant?": "waren {value} N/µm gemeint?",
    "was {value} MN m/rad meant?": "waren {value} MN m/rad gemeint?",
    "the table covers {first} to {last} r/min and is held level beyond its ends, {beyond} r/min": (
        "die Tabelle reicht von {first} bis {last} 1/min und gilt jenseits ihrer Enden unverändert, {beyond} 1/min"
    ),
    "from {low} to {high} and from {start} to {end}": "von {low} bis {high} und von {start} bis {end}",
    "from {low} to {high}": "von {low} bis {high}",
    "{load} N: the table covers loads of {least} to {most} N and is held at its end": (
        "{load} N: die Tabelle reicht für Lasten von {least} bis {most} N und gilt an ihrem Ende unverändert"
    ),
    "{value} N/m: bearings usually have 1e5 to 1e9 N/m": "{value} N/m: Lager haben meist 1e5 bis 1e9 N/m",
    "was N/µm meant?": "war N/µm gemeint?",
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
    # --- calibrations of models
    "{part} % of the phasors unexplained, at most {most} % ({channel})": (
        "{part} % der Zeiger unerklärt, höchstens {most} % ({channel})"
    ),
    "the model does not fit the runs: {rest}": "das Modell passt nicht zu den Läufen: {rest}",
    "are weights, angles and their sense right?": "stimmen Gewichte, Winkel und ihr Zählsinn?",
    "are weights, angles, their sense and the phase's right?": "stimmen Gewichte, Winkel, ihr Zählsinn und der der Phase?",
    "mountings differ by {part} % of what the trial weights do, {rest}": (
        "Montagen unterscheiden sich um {part} % dessen, was die Testgewichte bewirken, {rest}"
    ),
    "and go with these": "und im Gleichklang mit diesen",
    "one disc of one mounting by far more than the others": "eine Scheibe einer Montage weit mehr als die anderen",
    "which chance would do as well without any": "was der Zufall auch ganz ohne sie täte",
    "and there are too few mountings to tell them from these": "und es sind zu wenige Montagen, um beides zu trennen",
    "by chance: heavier weights would calibrate better": "zufällig: schwerere Gewichte würden besser kalibrieren",
    "no trial weight was ever put on disc {id}: what it does rests on the model alone": (
        "auf Scheibe {id} saß nie ein Testgewicht: Was sie bewirkt, beruht allein auf dem Modell"
    ),
    "discs {names} always had weights in the same proportion: only the model tells them apart": (
        "Scheiben {names} trugen Gewichte stets im selben Verhältnis: Nur das Modell trennt sie"
    ),
    "{speeds} cannot determine {terms}: held at the document's values, within {part} %": (
        "aus {speeds} nicht zu bestimmen: {terms}, gehalten bei den Werten des Dokuments, innerhalb {part} %"
    ),
    "{count} speeds": "{count} Drehzahlen",
    "{count} speed": "{count} Drehzahl",
    "{id} {kinds} terms": "{id} Koeffizienten ({kinds})",
    "{id} {kinds} term": "{id} Koeffizient ({kinds})",
    "bearing": "Lager",
    "coupling": "Kupplung",
    "pedestal": "Lagerbock",
    "seal": "Dichtung",
    "disc": "Scheibe",
    "the channels read {factor} times what they should on average, which no usual chain does: {rest}": (
        "die Kanäle zeigen im Mittel das {factor}-Fache des Richtigen, was keine übliche Messkette tut: {rest}"
    ),
    "are the trial weights' units right (such as {units}), and the amplitudes'?": (
        "stimmen die Einheiten der Testgewichte (etwa {units}) und die der Amplituden?"
    ),
    "are the units of the trial weights and of the amplitudes right?": (
        "stimmen die Einheiten der Testgewichte und der Amplituden?"
    ),
    "{unit} given as {other}": "{unit} angegeben als {other}",
    "{which} are {ratio} times as heavy as the others: are units mixed (such as {pairs})?": (
        "{which} sind das {ratio}-Fache der anderen: Sind Einheiten gemischt (etwa {pairs})?"
    ),
    "the weights of {which}": "die Gewichte von {which}",
    "the weights on {which}": "die Gewichte auf {which}",
    "run {id} on {disc}": "Lauf {id} auf {disc}",
    "it fits with the weights of {which}, which were given in {unit}, in {other}": (
        "es passt mit den Gewichten von {which}, die in {unit} angegeben waren, in {other}"
    ),
    "it fits with the weights on {which}, which were given in {unit}, in {other}": (
        "es passt mit den Gewichten auf {which}, die in {unit} angegeben waren, in {other}"
    ),
    "it fits with {which}": "es passt mit {which}",
    "the angles of the weights counted the other way round (`disc_scale`)": (
        "den Winkeln der Gewichte andersherum gezählt (`disc_scale`)"
    ),
    "the opposite sign of the phases (`phase_convention`)": "dem anderen Vorzeichen der Phasen (`phase_convention`)",
    "the runs fit {times} times better with {which} exchanged: are leads, discs and columns the right ones?": (
        "die Läufe passen {times}-mal besser, wenn vertauscht wird: {which}. Sind Leitungen, Scheiben und Spalten die "
        "richtigen?"
    ),
    "over {number}": "über {number}",
    "calibration {id} of the model is in force, as revision {revision} of the document": (
        "Kalibrierung {id} des Modells gilt, als Revision {revision} des Dokuments"
    ),
    # --- elements and lists
    "bearing {id}": "Lager {id}",
    "coupling {id}": "Kupplung {id}",
    "seal {id}": "Dichtung {id}",
    "pedestal {id}": "Lagerbock {id}",
    "disc {id}": "Scheibe {id}",
    "{one} and {other}": "{one} und {other}",
    "{one} or {other}": "{one} oder {other}",
    "{first}, {rest}": "{first}, {rest}",
}
