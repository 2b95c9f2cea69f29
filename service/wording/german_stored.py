"""Sentences that are stored in English, in German: names in braces are places for what stands there."""

from collections.abc import Mapping

from service.wording.german_access import ACCESS
from service.wording.german_balancing import BALANCING
from service.wording.german_calibrations import CALIBRATIONS
from service.wording.german_data_faults import DATA_FAULTS
from service.wording.german_documents import DOCUMENTS
from service.wording.german_fits import FITS
from service.wording.german_open_values import OPEN_VALUES
from service.wording.german_orbits import ORBITS
from service.wording.german_verdicts import VERDICTS

ELEMENTS_AND_LISTS: Mapping[str, str] = {
    "bearing {id}": "Lager {id}",
    "coupling {id}": "Kupplung {id}",
    "seal {id}": "Dichtung {id}",
    "pedestal {id}": "Lagerbock {id}",
    "disc {id}": "Scheibe {id}",
    "{one} and {other}": "{one} und {other}",
    "{one} or {other}": "{one} oder {other}",
    "{first}, {rest}": "{first}, {rest}",
}
TOPICS = (
    FITS,
    VERDICTS,
    DATA_FAULTS,
    OPEN_VALUES,
    ORBITS,
    BALANCING,
    DOCUMENTS,
    ACCESS,
    CALIBRATIONS,
    ELEMENTS_AND_LISTS,
)
GERMAN_STORED: Mapping[str, str] = {sentence: german for topic in TOPICS for sentence, german in topic.items()}
