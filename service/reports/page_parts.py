"""Parts of a report's pages as HTML: headings, tables, lists, figures, and the style sheet that they share."""

import html
import re
import unicodedata
from collections.abc import Iterable, Sequence
from datetime import datetime

from service.wording.language import Language

STYLE = """
@page { size: A4; margin: 15mm 14mm 16mm 14mm;
  @bottom-left { content: string(machine); font: 8px "DejaVu Sans", sans-serif; color: #666 }
  @bottom-right { content: "PAGE " counter(page) " OF " counter(pages); font: 8px "DejaVu Sans", sans-serif; color: #666 } }
body { font: 10px/1.4 "DejaVu Sans", sans-serif; color: #111; margin: 0 }
h1 { font-size: 20px; margin: 0 0 2px; string-set: machine attr(data-name) }
h2 { font-size: 14px; margin: 14px 0 4px; border-bottom: 1px solid #bbb; break-after: avoid }
h3 { font-size: 11px; margin: 8px 0 2px; break-after: avoid }
p { margin: 2px 0 } ul { margin: 2px 0; padding-left: 16px } .muted { color: #666 }
section { break-inside: auto } .panel, figure, tr, li { break-inside: avoid }
.panel { border: 1px solid #c9ced6; border-left: 4px solid #8aa4c0; padding: 6px 10px; margin: 6px 0 }
.panel.danger { border-left-color: #b3261e } .panel.alert { border-left-color: #9a5b00 }
.panel.calm { border-left-color: #2e7d32 } .key { break-after: avoid }
.figures { orphans: 1; widows: 1 }
.lead { font-size: 13px; font-weight: bold } .by { font-size: 11px; font-weight: bold }
figure { display: inline-block; margin: 2px 4px 6px 0; vertical-align: top } figcaption { font-size: 9px; font-weight: bold }
figure svg { display: block } table { border-collapse: collapse; width: 100% }
thead { display: table-header-group } th, td { text-align: left; vertical-align: top; padding: 2px 6px 2px 0; font-size: 9px;
  border-bottom: 1px solid #e3e6ea; white-space: nowrap }
td.long { white-space: pre-line; overflow-wrap: break-word }
.next { break-before: page }
"""


def style(language: Language) -> str:
    """Return the style sheet, whose page numbers have words."""
    return STYLE.replace("PAGE", language.translate("report.page")).replace("OF", language.translate("report.of"))


LONG_WORDS = 20
"""Characters of a cell, and of a word in it, from which on it may be broken."""
_LONG_WORD = re.compile(rf"\S{{{LONG_WORDS}}}(?=\S)")


def escaped(words: str) -> str:
    """Return words as text of HTML. Characters that no document may hold are left out."""
    return html.escape("".join(one for one in words if unicodedata.category(one)[0] != "C" or one in "\n\t"))


def shown_time(at: datetime | None) -> str:
    """Return a time in the one form that all of a report has."""
    return "–" if at is None else f"{at:%Y-%m-%d %H:%M}"


def shown_day(at: datetime) -> str:
    """Return a day in that form."""
    return f"{at:%Y-%m-%d}"


def listed(texts: Iterable[str]) -> str:
    """Return a list; nothing for no texts."""
    items = "".join(f"<li>{escaped(one)}</li>" for one in texts)
    return f"<ul>{items}</ul>" if items else ""


def headed(title: str, texts: Sequence[str]) -> str:
    """Return a list below its heading; nothing for no texts."""
    return f"<h3>{escaped(title)}</h3>{listed(texts)}" if texts else ""


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table whose rows are not torn; its head is repeated on each page."""
    head = "".join(f"<th>{escaped(one)}</th>" for one in heads)
    body = "".join("<tr>" + "".join(_cell(cell) for cell in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _cell(words: str) -> str:
    if len(words) <= LONG_WORDS:
        return f"<td>{escaped(words)}</td>"
    # Where every character may end a line, the printer tries them all: a second for a cell of some 1,000.
    parts = _LONG_WORD.sub("\\g<0>\0", words.replace("\0", "")).split("\0")
    return f'<td class="long">{"<wbr>".join(map(escaped, parts))}</td>'


def captioned(caption: str, drawing: str) -> str:
    """Return a drawing below its caption, which stay together."""
    return f"<figure><figcaption>{escaped(caption)}</figcaption>{drawing}</figure>"


def section(title: str, content: str) -> str:
    """Return a part of the report; nothing without content. The heading stays with what comes first."""
    return f"<section><h2>{escaped(title)}</h2>{content}</section>" if content else ""


def muted(words: str) -> str:
    """Return a remark."""
    return f'<p class="muted">{escaped(words)}</p>'


def figures(key: str, drawn: str) -> str:
    """Return drawings below what their colours mean, which stays with the first of them."""
    return f'<p class="muted key">{escaped(key)}</p><div class="figures">{drawn}</div>'
