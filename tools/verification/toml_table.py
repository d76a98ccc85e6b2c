"""A table of a TOML file, read key by key; what is wrong is said with the place."""

import difflib
from pathlib import Path
from typing import Any


class CaseError(Exception):
    """A case that cannot be used; the text says where and what was expected."""


REQUIRED: Any = object()


class TomlTable:
    """The keys that were asked for are the known ones; `finish` refuses all others."""

    def __init__(self, values: dict[str, Any], path: Path, name: str = "") -> None:
        self._values = values
        self._known: list[str] = []
        self._path = path
        self.name = name  # such as deck 2, empty for the whole file

    def error(self, message: str) -> CaseError:
        """An error at this table."""
        place = f"{self._path}: {self.name}" if self.name else str(self._path)
        return CaseError(f"{place}: {message}")

    def has(self, key: str) -> bool:
        """Whether the table has a key."""
        return key in self._values

    def _get(self, key: str, kinds: tuple[type, ...], words: str, default: Any) -> Any:
        self._known.append(key)
        if key not in self._values:
            if default is REQUIRED:
                raise self.error(f"there is no '{key}': expected {words}")
            return default
        value = self._values[key]
        if not isinstance(value, kinds) or isinstance(value, bool):
            raise self.error(f"'{key}' is {value!r}: expected {words}")
        return value

    def text(self, key: str, default: Any = REQUIRED) -> Any:
        """A text that is not empty."""
        value = self._get(key, (str,), "a text", default)
        if value == "":
            raise self.error(f"'{key}' is empty: expected a text")
        return value

    def choice(self, key: str, choices: tuple[str, ...]) -> str:
        """One of some words."""
        value = self.text(key)
        if value not in choices:
            raise self.error(f"'{key}' is '{value}': expected {' or '.join(choices)}")
        return value

    def integer(self, key: str, default: Any = REQUIRED) -> Any:
        """An integer."""
        return self._get(key, (int,), "an integer", default)

    def number(self, key: str, default: Any = REQUIRED) -> Any:
        """A number, as float."""
        value = self._get(key, (int, float), "a number", default)
        return float(value) if isinstance(value, (int, float)) else value

    def table(self, key: str, default: Any = REQUIRED) -> Any:
        """A table of any keys."""
        return self._get(key, (dict,), "a table", default)

    def numbers_by_name(self, key: str, default: Any = REQUIRED) -> Any:
        """A table of numbers."""
        values = self.table(key, default)
        for name, value in (values or {}).items():
            if not isinstance(value, (int, float)) or isinstance(value, bool):
                raise self.error(f"'{key}' of '{name}' is {value!r}: expected a number")
        return values

    def number_or_by_name(self, key: str, default: float) -> float | dict[str, float]:
        """A number for all, or a table of numbers."""
        if isinstance(self._values.get(key), dict):
            return self.numbers_by_name(key)
        return self.number(key, default)

    def texts(self, key: str, default: Any = REQUIRED) -> Any:
        """A list of texts, not empty."""
        return self._list(key, (str,), "a list of texts", default)

    def numbers(self, key: str) -> list[float]:
        """A list of numbers, not empty."""
        return [float(v) for v in self._list(key, (int, float), "a list of numbers", REQUIRED)]

    def _list(self, key: str, kinds: tuple[type, ...], words: str, default: Any) -> Any:
        values = self._get(key, (list,), words, default)
        if isinstance(values, list):
            good = [isinstance(v, kinds) and not isinstance(v, bool) for v in values]
            if not values or not all(good):
                raise self.error(f"'{key}' is {values!r}: expected {words}")
        return values

    def tables(self, key: str) -> list["TomlTable"]:
        """The tables of [[key]], none when there are none."""
        values = self._get(key, (list,), f"tables [[{key}]]", [])
        if not all(isinstance(value, dict) for value in values):
            raise self.error(f"'{key}' is no list of tables: expected [[{key}]]")
        return [TomlTable(v, self._path, f"{key} {i}") for i, v in enumerate(values, 1)]

    def one_key_of(self, *keys: str) -> str:
        """The one of some keys that the table has."""
        self._known.extend(keys)
        found = [key for key in keys if key in self._values]
        if len(found) != 1:
            raise self.error(f"expected one of {', '.join(keys)}, found {len(found)}")
        return found[0]

    def finish(self) -> None:
        """Refuses keys that nobody asked for."""
        known = list(dict.fromkeys(self._known))
        for key in self._values:
            if key not in known:
                near = difflib.get_close_matches(key, known, n=1)
                hint = f"; did you mean '{near[0]}'?" if near else ""
                raise self.error(f"unknown key '{key}': expected {', '.join(known)}{hint}")
