"""Explains the patterns of fields in words: error messages show no regular expressions."""

from collections.abc import Mapping

from estimator.field_types import PATTERNS
from service.secrets.references import FILE_NAME, VARIABLE, VARIABLE_PREFIX

WORDS: Mapping[str, str] = {
    **PATTERNS,
    r"^[^\x00-\x1f]*$": "a name is one line without control characters",
    r"^[^\x00]*[^\x00\s][^\x00]*$": "it must say something: more than blanks, and without NUL",
    r"^[!-~]+$": "a header's value has visible ASCII characters only",
    r"^([0-9a-f]{64})?$": "it is a SHA-256 sum of 64 digits from 0 to 9 and a to f, or blank",
    r"^(none|in_force|[0-9]{1,9})$": "it is 'none', 'in_force' or the number of a version",
    r"^[^/+#]+$": "it is one level of a topic: no '/', '+' or '#'",
    r"^\w+\.\S{1,200}$": "it is a kind, a dot and a name, such as bearing.B1 or bearing.B1.kxx",
    r"^\w+\.\S+$": "a parameter is a kind, a dot and a name, such as bearing.B1.kxx or critical_speed.1",
    FILE_NAME: "it is the name of a file: letters, digits, '.', '_' and '-', at most 100, not a '.' first",
    VARIABLE: f"it is a variable of capital letters, digits and '_' that begins with {VARIABLE_PREFIX}",
}
"""Explanations by pattern."""
