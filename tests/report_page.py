"""A page of the report as the tests see it."""

import base64
import json
import re
from html.parser import HTMLParser

import numpy as np


class Page(HTMLParser):
    """What a browser would see of a page: text, tables, scripts, links."""

    def __init__(self, text):
        super().__init__()
        self.source = text
        self.scripts = []  # (id, type, text)
        self.links = []
        self.tables = []
        self.parts = []  # (id of the section, text)
        self.handlers = []
        self.deck = ""
        self._where, self._script, self._pre, self._number = "", None, False, False
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        self.handlers += [name for name in attrs if name.startswith("on")]
        self.links += [attrs[name] for name in ("src", "href") if name in attrs]
        self._where = attrs.get("id", "") if tag == "section" else self._where
        if tag == "script":
            self._script = [attrs.get("id", ""), attrs.get("type", ""), ""]
        elif tag == "meta" and "http-equiv" in attrs:
            self.policy = attrs["content"]
        elif tag == "table":
            self.tables.append((self._where, []))
        elif tag == "tr":
            self.tables[-1][1].append([])
        elif tag in ("td", "th"):
            self.tables[-1][1][-1].append("")
        elif tag == "pre":
            self._pre = self._where == "deck"
        elif tag == "span":
            self._number = attrs.get("class") == "linenos"

    def handle_endtag(self, tag):
        if tag == "script":
            self.scripts.append(tuple(self._script))
            self._script = None
        elif tag == "pre":
            self._pre = False
        elif tag == "span":
            self._number = False

    def handle_data(self, data):
        if self._script is not None:
            self._script[2] += data
            return
        if self._pre and not self._number:
            self.deck += data
        if self.tables and self.tables[-1][1] and data.strip():
            row = self.tables[-1][1][-1]
            if row:
                row[-1] += data.strip()
        self.parts.append((self._where, data))

    def text(self, section=None):
        """Text of a section, or of the whole page."""
        parts = [data for where, data in self.parts if section in (None, where)]
        return re.sub(r"\s+", " ", " ".join(parts))

    def table(self, section, index=0):
        """Rows of a table of a section."""
        return [rows for where, rows in self.tables if where == section][index]

    def figure(self, name):
        """The data that plotly gets."""
        (found,) = [text for one, _, text in self.scripts if one == f"data-{name}"]
        return json.loads(found)

    def trace(self, name, index=0):
        """A trace with its arrays."""
        return decode(self.figure(name)["data"][index])


def decode(node):
    """Arrays of plotly, which are in base64."""
    if isinstance(node, dict):
        if set(node) >= {"dtype", "bdata"}:
            return np.frombuffer(base64.b64decode(node["bdata"]), dtype=node["dtype"])
        return {key: decode(value) for key, value in node.items()}
    return [decode(value) for value in node] if isinstance(node, list) else node
