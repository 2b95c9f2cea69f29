"""German texts of findings: the same as those declared with each finding in English, with the same places."""

from collections.abc import Mapping

from service.wording.finding_texts import FindingTexts

BALANCE_LATER = (
    "Maschinen an Kupplung {id} vorher nicht auswuchten: Ausgleichsmassen würden die Ursache verdecken und nicht beheben "
    "(gängige Praxis)"
)
NEW_BASELINE = "Nach der Arbeit eine Wartung in die Chronik der Maschine eintragen: ein neuer Referenzzustand beginnt"
TAKE_RUN_DOWN = "Bei nächster Gelegenheit einen Auslauf aufnehmen: er zeigt, ob die Änderung wächst"
STATED_FILMS = "Ob es {id} selbst ist oder die Last darauf, wo das Dokument den Ölfilm nicht durch Geometrie und Öl beschreibt"

GERMAN_FINDINGS: Mapping[str, FindingTexts] = {
    "misalignment": FindingTexts(
        what="Kupplung {id} {judgement}: {size}, {compared}, seit {since}",
        check=(
            "Metall- und Öltemperaturen der Lager neben Kupplung {id}, Last und Prozesstemperatur, seit {since}",
            "2×, Wellenbahn und Wellenlage an den Aufnehmern neben Kupplung {id}, gegenüber einem Lauf vor dem {since}",
            "Rohrleitungen, Fußschrauben (Kippfuß) und Fundament auf beiden Seiten von Kupplung {id}",
        ),
        in_operation=(
            TAKE_RUN_DOWN,
            "Schwingung und Temperaturen der Lager neben Kupplung {id} in jeder Schicht beobachten",
        ),
        at_next_stop=(
            "Ausrichtung an Kupplung {id} messen, bevor etwas gelöst wird, und mit diesen Zahlen vergleichen",
            "Schrauben, Elemente oder Zähne und Fett von Kupplung {id} ansehen; neu ausrichten, wo sie falsch steht",
            BALANCE_LATER,
            NEW_BASELINE,
        ),
        if_danger=(
            "Mit dem Betrieb den frühesten Stillstand für Kupplung {id} vereinbaren; nicht wieder anfahren, bevor sie "
            "angesehen ist",
        ),
        confirm=(
            "Eine mit Laser oder Messuhren gemessene Ausrichtung, die in gleicher Richtung falsch ist",
            "2×, das gewachsen ist, oder auseinandergelaufene Lagertemperaturen neben Kupplung {id} (gängige Praxis)",
        ),
        not_determined=("Welche der beiden Maschinen sich bewegt hat, oder ob die Kupplung selbst verschlissen ist",),
    ),
    "bearing": FindingTexts(
        what="{judgement}: {size}, {compared}, seit {since}",
        check=(
            "Ölvorlauftemperatur, Druck und Menge sowie Metalltemperatur von {element} seit {since}",
            "Wellenlage in {element}, gegenüber einem Lauf vor dem {since}",
        ),
        in_operation=("Öltemperatur und Last über einen Auslauf konstant halten, damit sich nur {element} ändern kann",),
        at_next_stop=(
            "{element} öffnen: Lagerspiel, Tragbild, Weißmetall, Segmente und Stützpunkte, Sitz im Gehäuse",
            NEW_BASELINE,
        ),
        if_danger=(
            "Mit dem Betrieb den frühesten Stillstand für {element} vereinbaren; bis dahin seine Metalltemperatur beobachten",
        ),
        confirm=(
            "Ein Lagerspiel oder ein Tragbild, das nicht ist wie gefertigt",
            "Eine Metalltemperatur, die mitgelaufen ist",
        ),
        not_determined=(STATED_FILMS,),
    ),
    "coupling": FindingTexts(
        what="Kupplung {id} hat sich für sich geändert: {size}, {compared}, seit {since}",
        check=("Drehmoment und Temperatur an Kupplung {id} seit {since}", "2× und Phase über Kupplung {id} hinweg"),
        in_operation=(TAKE_RUN_DOWN,),
        at_next_stop=(
            "Elemente, Schrauben, Zähne, Nabensitze und Fett von Kupplung {id} ansehen",
            "Ausrichtung an Kupplung {id} messen, unter der sie gelitten haben kann",
            NEW_BASELINE,
        ),
        if_danger=(
            "Mit dem Betrieb den frühesten Stillstand für Kupplung {id} vereinbaren: eine brechende Kupplung wird "
            "fortgeschleudert",
        ),
        confirm=("Gerissene, verschlissene oder lose Teile von Kupplung {id}",),
        not_determined=("Welches Teil von Kupplung {id} es ist",),
    ),
    "pedestal": FindingTexts(
        what="Lagerbock {id} hat sich für sich geändert: {size}, {compared}, seit {since}",
        check=(
            "Fußschrauben, Verguss und Risse von Lagerbock {id}",
            "Zug der Rohrleitungen an Lagerbock {id}, warm und kalt",
        ),
        in_operation=(
            "Schwingung von Lagerbock {id} über seine Fugen hinweg vergleichen, Schraube für Schraube (gängige Praxis)",
        ),
        at_next_stop=(
            "Festziehen oder instand setzen, was an Lagerbock {id} lose ist, dann die Ausrichtung daneben prüfen",
            NEW_BASELINE,
        ),
        if_danger=("Mit dem Betrieb den frühesten Stillstand für Lagerbock {id} vereinbaren",),
        confirm=("Eine lose Schraube, oder eine Fuge, über die hinweg die Schwingung springt",),
        not_determined=("Welche Schraube, welche Fuge oder welcher Riss es ist",),
    ),
    "settlement": FindingTexts(
        what="Lager {id} steht {size}, {compared}, seit {since}",
        check=("Fundament und Unterlagen unter Lager {id}", "Metalltemperaturen von Lager {id} und seinen Nachbarn"),
        in_operation=("Last und Temperatur von Lager {id} mit denen seiner Nachbarn vergleichen",),
        at_next_stop=("Höhe von Lager {id} messen und Unterlagen anpassen", NEW_BASELINE),
        if_danger=("Mit dem Betrieb den frühesten Stillstand für Lager {id} vereinbaren",),
        confirm=("Ein Nivellement der Lagergehäuse, das in gleicher Richtung abweicht",),
        not_determined=("Höhen, die zugleich eine Änderung der Ausrichtung einer Kupplung sind",),
    ),
    "wear": FindingTexts(
        what="Lager {id} ist verschlissen: sein radiales Lagerspiel ist {size}, {compared}, seit {since}",
        check=("Partikel und Metall im Öl von Lager {id}", "Metalltemperatur und Wellenlage von Lager {id}"),
        in_operation=("Ölproben nehmen, und Ausläufe bei gleicher Öltemperatur: sie zeigen, wie schnell es verschleißt",),
        at_next_stop=(
            "Lagerspiel von Lager {id} messen; Lagerschalen seiner Größe vorher bereitlegen",
            NEW_BASELINE,
        ),
        if_danger=("Mit dem Betrieb den frühesten Stillstand für Lager {id} vereinbaren, neue Schalen bereithalten",),
        confirm=("Ein mit Bleidraht oder Anhebemessung bestimmtes Lagerspiel, das ebenso gewachsen ist",),
        not_determined=("Wo in der Bohrung es verschlissen ist, und warum",),
    ),
    "oil": FindingTexts(
        what="Das Öl in den Lagern hat eine andere Viskosität, {size}: Sorte und Temperatur ansehen, {compared}, seit {since}",
        check=("Sorte auf dem letzten Lieferschein, Öltemperatur im Vorlauf, Wasser oder Kraftstoff im Öl",),
        in_operation=("Kühler so einstellen, dass das Öl seine übliche Temperatur hat; eine Probe auf Viskosität nehmen",),
        at_next_stop=("Öl wechseln, wo die Probe es verlangt", NEW_BASELINE),
        confirm=("Eine Probe, deren Viskosität bei 40 °C um ebenso viel abweicht",),
        not_determined=("Ob Sorte, Temperatur oder Wasser die Ursache ist",),
    ),
    "process_force": FindingTexts(
        what="Die statische Kraft {id} hat sich geändert: {size}, {compared}, seit {since}",
        check=("Leistung, Ventile und Drücke seit {since}: woher die statische Kraft {id} kommt",),
        in_operation=("Einen Auslauf bei üblicher Leistung aufnehmen: er zeigt, ob die statische Kraft {id} ihr folgt",),
        at_next_stop=("Ventile, Düsen, Zähne oder Rohre ansehen, von denen die statische Kraft {id} kommt", NEW_BASELINE),
        confirm=("Eine Leistung oder ein Druck, die sich mit ihr geändert haben",),
        not_determined=("Was die statische Kraft {id} ändert", "Eine Kraft, für die im Dokument keine statische Kraft steht"),
    ),
    "light_load": FindingTexts(
        what="Lager {id} trägt kaum noch Last: weniger als ein Zehntel der früheren, sodass Ölwirbel (Oil Whirl) auftreten "
        "können, {compared}, seit {since}",
        check=("Schwingung unter der Drehfrequenz an Lager {id}, im Spektrum eines anderen Geräts",),
        in_operation=("Öl innerhalb seiner Grenzen warm halten: ein dünnerer Film wird später instabil (gängige Praxis)",),
        at_next_stop=("Ausrichtung neben Lager {id} und seine Höhe messen",),
        confirm=("Niedrige Metalltemperatur an Lager {id}", "Schwingung bei etwas weniger als der halben Drehfrequenz"),
        not_determined=("Um wie viel Lager {id} entlastet ist",),
    ),
    "heavy_load": FindingTexts(
        what="Lager {id} trägt mehr als 5 MPa seiner Fläche, das Höchste, was Weißmetall verträgt (ISO 7902-3), {compared}, "
        "seit {since}",
        check=("Metalltemperatur von Lager {id} jetzt, und ihr Alarmgrenzwert",),
        in_operation=("Last verringern, wo der Betrieb es kann; Metalltemperatur von Lager {id} in jeder Schicht beobachten",),
        at_next_stop=("Ausrichtung neben Lager {id} und seine Höhe messen; sein Weißmetall ansehen",),
        confirm=("Hohe Metalltemperatur an Lager {id}",),
        not_determined=("Um wie viel Lager {id} darüber liegt",),
    ),
    "low_stability": FindingTexts(
        what="Die Maschine ist nahe am Ölwirbel in ihren Schmierfilmen: bei Betriebsdrehzahl hat ihre am wenigsten gedämpfte "
        "Eigenform ein logarithmisches Dekrement unter 0,1 (API 617), und weniger als die Hälfte dessen, was sie mit solchem "
        "Öl hatte, {compared}, seit {since}",
        check=(
            "Schwingung unter der Drehfrequenz, im Spektrum eines anderen Geräts",
            "Was sich daneben geändert hat: eine Ausrichtung, ein Lagerspiel, das Öl und seine Temperatur",
        ),
        in_operation=("Öltemperatur in ihren Grenzen halten, und die Drehzahl nicht erhöhen, solange dies besteht",),
        at_next_stop=("Ausrichtung, Lagerspiele und Höhen der Lager messen, die am wenigsten tragen", NEW_BASELINE),
        confirm=("Schwingung bei etwas weniger als der halben Drehfrequenz",),
        not_determined=("In welchem Lager es beginnt",),
    ),
    "unbalance": FindingTexts(
        what="Die Unwucht von Scheibe {id} hat sich geändert um {size}, {compared}, seit {since}",
        check=(
            "Ob sich 1× an den Aufnehmern bei Scheibe {id} auf einmal oder langsam geändert hat: ein verlorenes Teil, oder "
            "Ablagerungen und Erosion",
            "Was sich am {since} geändert hat: ein Anfahren, eine Abschaltung, eine Wäsche, eine Last, eine Temperatur",
        ),
        in_operation=(
            "Kam sie auf einmal, wie ein verlorenes Teil behandeln, bis das Gegenteil gezeigt ist (gängige Praxis)",
        ),
        at_next_stop=(
            "An Scheibe {id} nach verlorenen Teilen, Ablagerungen und Anstreifspuren suchen",
            "Im Betriebszustand auswuchten, wo nichts gefunden wird",
            NEW_BASELINE,
        ),
        if_danger=("Mit dem Betrieb einen Stillstand vereinbaren; kam sie auf einmal, vor dem nächsten Anfahren",),
        confirm=(
            "Ein fehlendes Teil oder eine Ablagerung beim Winkel der Änderung",
            "1×, das fällt, wenn Scheibe {id} gereinigt oder ausgewuchtet ist",
        ),
        not_determined=("Was die Ursache ist: ein Verlust, Ablagerungen oder eine Verformung der Scheibe",),
    ),
    "rotating_coupling": FindingTexts(
        what="Der Rundlauf von Kupplung {id} hat sich geändert, {size}: die Abweichung dreht mit der Welle, bei jeder "
        "Drehzahl, {compared}, seit {since}",
        check=(
            "Was am {since} an Kupplung {id} getan wurde: Naben neu aufgezogen, Schrauben, Zwischenstück oder Markierungen, "
            "die nicht zusammenpassen",
        ),
        in_operation=(TAKE_RUN_DOWN,),
        at_next_stop=(
            "Rund- und Planlauf beider Naben von Kupplung {id} mit Messuhren messen, während die Welle gedreht wird",
            "An Kupplung {id} nach schief sitzender Nabe, falschen Schraubenlängen und Schmutz in der Zentrierung suchen",
            BALANCE_LATER,
            NEW_BASELINE,
        ),
        if_danger=("Mit dem Betrieb den frühesten Stillstand für Kupplung {id} vereinbaren",),
        confirm=("Ein Rund- oder Planlauf von Kupplung {id}, der beim gleichen Winkel abweicht",),
        not_determined=("Welche der beiden Naben von Kupplung {id} es ist",),
    ),
    "bow": FindingTexts(
        what="Die Krümmung, oder der Runout an allen Aufnehmern, von Welle {id} hat sich geändert um {size}, {compared}, "
        "seit {since}",
        check=("Slow-Roll von Welle {id}, kalt und warm, und wie sie vor dem Anfahren stand",),
        in_operation=(
            "Welle {id} langsam drehen lassen, bis ihr Slow-Roll ruhig ist, vor dem nächsten Anfahren (gängige Praxis)",
        ),
        at_next_stop=("Rundlauf von Welle {id} mit einer Messuhr über ihre Länge messen",),
        confirm=(
            "Ein Rundlauf nach Messuhr, der ebenso groß ist",
            "Ein Slow-Roll, der fällt, während Welle {id} langsam dreht",
        ),
        not_determined=("Ob Welle {id} bleibend oder nur durch Wärme krumm ist",),
    ),
    "run_out": FindingTexts(
        what="Der Runout an Aufnehmer {id} hat sich geändert um {size}, {compared}, seit {since}",
        check=("Wellenoberfläche unter Aufnehmer {id}: Kratzer, Rost, Magnetismus",),
        in_operation=("Slow-Roll-Vektoren beim nächsten Auslauf neu aufnehmen und abziehen",),
        at_next_stop=("Messspur unter Aufnehmer {id} reinigen oder glätten; seinen Halter ansehen",),
        confirm=("Ein Slow-Roll an Aufnehmer {id}, der sich geändert hat, während seine Nachbarn gleich blieben",),
        not_determined=("Ob Oberfläche, Magnetismus oder Halter die Ursache ist",),
    ),
    "sensor": FindingTexts(
        what="Aufnehmer {id} {size}, {compared}, seit {since}",
        check=(
            "Spaltspannung, Stecker, Kabel und Oszillator (Driver) von Aufnehmer {id}",
            "Einstellungen des Kanals {id} im Gerät",
        ),
        in_operation=("Nicht auf das allein handeln, was Kanal {id} sagt; ihn nach den Regeln des Werks aus Alarmen nehmen",),
        at_next_stop=("Aufnehmer {id} mit eigenem Kabel und Oszillator kalibrieren, oder sie ersetzen",),
        confirm=("Eine Kalibrierkurve von Aufnehmer {id}, die um ebenso viel abweicht",),
        not_determined=("Welcher Teil der Messkette es ist: Aufnehmer, Kabel, Oszillator oder Eingang",),
    ),
    "misfit": FindingTexts(
        what="Keine Anpassung erklärt die neuesten Läufe der Maschine: ihr Modell gilt nicht mehr, oder ihre Daten sind "
        "falsch, {compared}, seit {since}",
        check=(
            "Residuen der neuesten Identifikation: ein Kanal, ein Drehzahlbereich, oder überall",
            "Was am {since} an der Maschine, ihren Geräten oder ihrem Dokument geändert wurde",
        ),
        in_operation=(
            "1× mit einem Lauf vor dem {since} nach Augenmaß vergleichen und die Maschine nach ihren "
            "Schwingungsgrenzwerten beurteilen",
        ),
        at_next_stop=("Zuerst die Geräte ansehen, dann Abstützungen und Kupplungen",),
        confirm=("Eine Anpassung, die wieder angenommen wird, sobald Kanal oder Dokument berichtigt ist",),
        not_determined=("Ob Maschine, Geräte oder Dokument die Ursache ist",),
    ),
    "outliers": FindingTexts(
        what="Viele einzelne Zeiger der neuesten Läufe passen nicht und sind ausgelassen: Kabel, Verbindungen und Störungen "
        "ansehen, {compared}, seit {since}",
        check=(
            "Kabel, Schirme, Stecker und Keyphasor",
            "Schweißarbeiten, Umrichter oder Funk nahe den Kabeln zu dieser Zeit",
        ),
        in_operation=("Güte des Kanals auf der Seite des Laufs beobachten",),
        at_next_stop=("Kabel und Erdung instand setzen; Spalt und Oberfläche der Keyphasor-Marke ansehen",),
        confirm=("Zeiger, die wieder passen, sobald ein Kabel oder eine Verbindung instand gesetzt ist",),
        not_determined=("Welches Kabel oder welche Störquelle es ist",),
    ),
    "rate_of_change": FindingTexts(
        what="{parameter} driftet um {size} über die letzten {runs} Läufe",
        check=("Ob Last, Temperatur oder Öl mitdriften: dann nimmt eine Betriebsbedingung im Dokument das heraus",),
        in_operation=("Öfter Ausläufe aufnehmen, solange es driftet",),
        at_next_stop=("{element} ansehen",),
        if_danger=("Mit dem Betrieb einen Stillstand für {element} vereinbaren, bevor der Grenzwert erreicht ist",),
        confirm=("Eine Drift, die in den nächsten Läufen bei gleicher Last und Temperatur weitergeht",),
        not_determined=("Was die Drift verursacht: die Diagnose sagt es, sobald sie sicher ist",),
    ),
}
