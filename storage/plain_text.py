"""Texts from outside as every database takes them."""


def plain_text(text: str) -> str:
    """Control characters and halves of characters escaped: PostgreSQL takes no NUL, and nothing takes half a character."""
    return "".join(c if c.isprintable() or c == " " else c.encode("unicode_escape").decode() for c in text)
