"""Verdicts on fits and on what a document says, in German."""

from collections.abc import Mapping

VERDICTS: Mapping[str, str] = {
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
        "{kind} contradict the document, {name} most ({factor} times what it says, {away} times as far as it may be off): "
        "intervals are widened"
    ): (
        "{kind} widersprechen dem Dokument, am meisten {name} (das {factor}-Fache dessen, was es sagt, {away}-mal so weit "
        "daneben, wie es zulässt): Vertrauensbereiche sind verbreitert"
    ),
    "{kind} contradict the document, {name} most ({away} times as far as it may be off): intervals are widened": (
        "{kind} widersprechen dem Dokument, am meisten {name} ({away}-mal so weit daneben, wie es zulässt): "
        "Vertrauensbereiche sind verbreitert"
    ),
    "radial clearances": "radiale Spiele",
    "viscosities": "Viskositäten",
    "ratios of viscosities": "Verhältnisse von Viskositäten",
    "falls of the viscosity with speed": "Abfälle der Viskosität mit der Drehzahl",
    "stiffnesses of pedestals": "Steifigkeiten von Lagerböcken",
    "dampings of pedestals": "Dämpfungen von Lagerböcken",
    "masses of pedestals": "Massen von Lagerböcken",
    "stiffnesses of couplings": "Steifigkeiten von Kupplungen",
    "dampings of couplings": "Dämpfungen von Kupplungen",
    "are the clearances radial ones, and is the bearings' geometry right?": (
        "sind die Spiele radiale, und stimmt die Geometrie der Lager?"
    ),
    "are the oil, its temperature and the bearings' geometry right?": (
        "stimmen das Öl, seine Temperatur und die Geometrie der Lager?"
    ),
    (
        "coefficients deviate by {size} % over speed from the document's forms, beside oil films that deviate themselves: "
        "intervals are widened"
    ): (
        "Koeffizienten weichen über der Drehzahl um {size} % von den Formen des Dokuments ab, neben Ölfilmen, die selbst "
        "abweichen: Vertrauensbereiche sind verbreitert"
    ),
    (
        "the data want {quantity} of the table of {element} to be off by {size} % beside its factors ({errors} standard "
        "errors): state the table's coefficients as they are"
    ): (
        "die Daten verlangen {quantity} der Tabelle von {element} um {size} % neben ihren Faktoren verändert ({errors} "
        "Standardfehler): die Koeffizienten der Tabelle angeben, wie sie sind"
    ),
    (
        "the data want {quantity} of the table of {element} to be off by {size} % beside its factors ({errors} standard "
        "errors): intervals are widened"
    ): (
        "die Daten verlangen {quantity} der Tabelle von {element} um {size} % neben ihren Faktoren verändert ({errors} "
        "Standardfehler): Vertrauensbereiche sind verbreitert"
    ),
    (
        "the data want {quantity} of the exact table of {element} to be off by {size} % ({errors} standard errors): state the "
        "table's coefficients as they are, or its scale_spread"
    ): (
        "die Daten verlangen {quantity} der exakten Tabelle von {element} um {size} % verändert ({errors} Standardfehler): "
        "die Koeffizienten der Tabelle angeben, wie sie sind, oder ihr scale_spread"
    ),
    (
        "the data want {quantity} of the exact table of {element} to be off by {size} % ({errors} standard errors): intervals "
        "are widened"
    ): (
        "die Daten verlangen {quantity} der exakten Tabelle von {element} um {size} % verändert ({errors} Standardfehler): "
        "Vertrauensbereiche sind verbreitert"
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
    "not physically possible: at {speed} r/min, where the machine ran, {what}": (
        "physikalisch nicht möglich: bei {speed} 1/min, wo die Maschine lief, {what}"
    ),
    "a mode of {frequency} cycles per minute grows (damping ratio {ratio})": (
        "klingt eine Mode von {frequency} Schwingungen je Minute auf (Dämpfungsgrad {ratio})"
    ),
    "the shaft leaves its bearings without oscillating": "verlässt die Welle ihre Lager, ohne zu schwingen",
    "with another gain and run-out of probe {name} it would be accepted": (
        "mit einer anderen Verstärkung und einem anderen Rundlauffehler des Aufnehmers {name} würde es angenommen"
    ),
    "with other gains and run-outs of the probes {one} and {other} it would be accepted": (
        "mit anderen Verstärkungen und Rundlauffehlern der Aufnehmer {one} und {other} würde es angenommen"
    ),
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
}
