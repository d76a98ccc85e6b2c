"""A Pygments lexer for input decks, and the deck as HTML with line numbers."""

import re
from typing import ClassVar

from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexer import RegexLexer, bygroups, include
from pygments.token import (
    Comment,
    Keyword,
    Name,
    Number,
    Operator,
    Punctuation,
    String,
    Text,
    Whitespace,
)

NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?(?=[\s,]|$)"
EXPECT = re.compile(rb"^[ \t]*\*[ \t]*EXPECT\b", re.IGNORECASE | re.MULTILINE)


class DeckLexer(RegexLexer):
    """Keyword lines, parameters, values, comments and quoted strings of a deck."""

    name = "Tessera deck"
    aliases = ("tessera",)
    filenames = ("*.inp",)
    flags = re.IGNORECASE | re.MULTILINE

    tokens: ClassVar[dict[str, list[object]]] = {
        "root": [
            (r"\ufeff", Whitespace),
            include("comment"),
            (r"^[ \t]*\*[ \t]*HEADING\b", Keyword, ("heading", "keyword")),
            (r"^[ \t]*\*[^,\n]*?(?=[ \t]*(?:,|$|[ \t]\*\*))", Keyword, "keyword"),
            include("value"),
            (r"\n", Whitespace),
        ],
        "comment": [
            (r"^[ \t]*\*\*.*$", Comment.Single),
            (r"(?<=[ \t])\*\*.*$", Comment.Single),
            (r"[ \t]+", Whitespace),
        ],
        "heading": [
            (r"^[ \t]*\*\*.*$", Comment.Single),
            (r"^(?=[ \t]*\*)", Text, "#pop"),
            (r"[^\n]+", Text),
            (r"\n", Whitespace),
        ],
        "keyword": [
            include("comment"),
            (r",[ \t]*\n", Punctuation),
            (r"\n", Whitespace, "#pop"),
            (r"(=)([ \t]*)", bygroups(Operator, Whitespace), "values"),
            (r",", Punctuation),
            (r"[^,=\n\"\s](?:[^,=\n\"]*[^,=\n\"\s])?", Name.Attribute),
            (r".", Text),
        ],
        "values": [
            include("comment"),
            (rf",(?=[ \t]*{NUMBER})", Punctuation),  # a vector; a flag or a parameter else
            (r"(?=[,\n])", Whitespace, "#pop"),
            include("value"),
        ],
        "value": [
            (r'"[^"\n]*"?', String.Double),
            (NUMBER, Number),
            (r",", Punctuation),
            (r"[^,\n\"\s](?:(?! \*\*)[^,\n\"])*", Name.Constant),
            (r".", Text),
        ],
    }


def deck_html(text: str) -> str:
    """The deck as HTML, with line numbers that are not copied; everything in it is escaped."""
    formatter = HtmlFormatter(linenos="inline", cssclass="deck", nobackground=True)
    return highlight(text, DeckLexer(stripnl=False, ensurenl=False), formatter)


def n_expectations(deck: bytes) -> int:
    """Number of *EXPECT in a deck."""
    return len(EXPECT.findall(deck))
