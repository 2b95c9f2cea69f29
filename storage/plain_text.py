"""Texts from outside as every database takes them."""

import re


def plain_text(text: str) -> str:
    """Control characters and halves of characters escaped: PostgreSQL takes no NUL, and nothing takes half a character."""
    return "".join(c if c.isprintable() or c == " " else c.encode("unicode_escape").decode() for c in text)


def plain_lines(text: str) -> str:
    """The same of each of its lines."""
    return "\n".join(map(plain_text, text.split("\n")))


def nul_escaped(text: str) -> str:
    """A text that holds NUL with `\\x00` for it and its backslashes doubled, so that `nul_back` can tell; another as it is."""
    return text.replace("\\", "\\\\").replace("\0", "\\x00") if "\0" in text else text


def nul_back(text: str) -> str:
    """What `nul_escaped` was given, if that changed it."""
    return re.sub(r"\\(\\|x00)", lambda found: "\\" if found[1] == "\\" else "\0", text) if "\\x00" in text else text
