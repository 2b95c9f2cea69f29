"""Units of values as OPC UA states them.

Source: OPC 10000-8, 5.6.3 (EUInformation), whose numbers are the UNECE common codes of Recommendation 20, three bytes of
ASCII. Units without a code have the number -1, as that part asks, and their text.
"""

from asyncua import ua

UNECE = "http://www.opcfoundation.org/UA/units/un/cefact"
WITHOUT_CODE = -1

CODES = {
    "N/m": "4P",
    "kg": "KGM",
    "kg m": "M94",
    "m": "MTR",
    "N": "NEW",
    "N m": "NU",
    "rad": "C81",
    "rad/s": "2A",
    "Pa s": "C65",
    "N s/m": "C58",
    "N m/rad": "M93",
    "deg": "DD",
    "r/min": "RPM",
    "1": "C62",
}
"""Common code of each SI unit of the estimator that has one."""


def engineering_unit(unit: str) -> ua.EUInformation:
    """Return a unit as a structure. unit: as the estimator writes it, such as "N s/m"."""
    text = "" if unit == "1" else unit
    code = CODES.get(unit)
    number = WITHOUT_CODE if code is None else int.from_bytes(code.encode("ascii"), "big")
    described = ua.LocalizedText(unit if unit != "1" else "one: a ratio")
    return ua.EUInformation(NamespaceUri=UNECE, UnitId=number, DisplayName=ua.LocalizedText(text), Description=described)
