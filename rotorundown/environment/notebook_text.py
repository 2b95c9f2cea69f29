"""Text of a result as a notebook shows it."""


def notebook_text(shown: object) -> str:
    """Return the text of a result as HTML; names come from documents, so everything is escaped."""
    import html  # its table of entities is needed in notebooks only

    return f"<pre>{html.escape(str(shown))}</pre>"
