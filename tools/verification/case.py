"""A verification case: its folder with decks, and case.toml that says what is judged."""

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from verification.toml_table import CaseError, TomlTable

LABELS = ("quick", "slow")
MOST_SECONDS = 10.0  # of CPU, for a quick deck in the release build


@dataclass(frozen=True)
class Deck:
    """A deck that runs alone."""

    file: str
    label: str  # quick or slow
    exit_code: int  # of a run as it should be

    @property
    def job(self) -> str:
        """Name of its results."""
        return self.file.removesuffix(".inp")


@dataclass(frozen=True)
class Measure:
    """A number that a function in measures.py takes from a finished job."""

    name: str
    function: str
    arguments: dict[str, Any]
    decks: tuple[str, ...]
    exact: float | None
    rtol: float | dict[str, float]  # of all decks, or by deck
    atol: float | dict[str, float]  # likewise
    frozen: dict[str, float] | None  # by deck; None: nothing is frozen

    def tolerance_of(self, deck: str) -> float:
        """How far a deck may be off its exact value."""
        rtol, atol = (v[deck] if isinstance(v, dict) else v for v in (self.rtol, self.atol))
        return atol + rtol * abs(self.exact or 0.0)


@dataclass(frozen=True)
class Study:
    """How fast an error falls with the size of the cells."""

    name: str
    measure: str | None  # error = the measure, less its exact value
    expect: str | None  # error = relative error of this *EXPECT
    decks: tuple[str, ...]
    h: tuple[float, ...]
    order: float  # the least


@dataclass(frozen=True)
class CaseFigure:
    """A picture: drawn by tessera-post, by a function in measures.py, or of studies."""

    file: str
    caption: str
    command: tuple[str, ...] = ()
    function: str = ""
    studies: tuple[str, ...] = ()


@dataclass(frozen=True)
class Case:
    """Everything of a case."""

    folder: Path
    title: str
    summary: str
    decks: tuple[Deck, ...]
    measures: tuple[Measure, ...]
    studies: tuple[Study, ...]
    figures: tuple[CaseFigure, ...]

    @property
    def name(self) -> str:
        """Name of the folder."""
        return self.folder.name

    def decks_to_run(self, with_slow: bool) -> list[Deck]:
        """Decks with the labels that are wanted."""
        return [deck for deck in self.decks if with_slow or deck.label == "quick"]


def case_names(root: Path) -> list[str]:
    """Folders with a case.toml, sorted."""
    return sorted(path.parent.name for path in root.glob("*/case.toml"))


def load_cases(root: Path, names: list[str]) -> list[Case]:
    """The cases of these names, all without names. CaseError when one is not there or wrong."""
    there = case_names(root)
    for name in names:
        if name not in there:
            raise CaseError(f"there is no case '{name}' in {root}: there are {', '.join(there)}")
    cases = [load_case(root / name) for name in names or there]
    check_figure_files(cases)
    return cases


def check_figure_files(cases: list[Case]) -> None:
    """All figures go to one folder."""
    owner: dict[str, str] = {}
    for case in cases:
        for figure in case.figures:
            if figure.file in owner:
                raise CaseError(
                    f"{case.folder / 'case.toml'}: figure '{figure.file}' is there twice, also in"
                    f" case '{owner[figure.file]}'"
                )
            owner[figure.file] = case.name


def load_case(folder: Path) -> Case:
    """Reads and checks case.toml."""
    path = folder / "case.toml"
    try:
        values = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as problem:
        raise CaseError(f"{path}: {problem}") from problem
    table = TomlTable(values, path)
    title, summary = table.text("title"), table.text("summary")
    decks = tuple(read_deck(each, folder) for each in table.tables("deck"))
    measures = tuple(read_measure(each) for each in table.tables("measure"))
    studies = tuple(read_study(each) for each in table.tables("study"))
    figures = tuple(read_figure(each) for each in table.tables("figure"))
    table.finish()
    if not decks:
        raise table.error("there is no [[deck]]: expected one or more")
    if not (folder / "README.md").is_file():
        raise CaseError(f"{folder}: there is no README.md: expected what is verified, and why")
    case = Case(folder, title, summary, decks, measures, studies, figures)
    check_references(case, table)
    return case


def read_deck(table: TomlTable, folder: Path) -> Deck:
    """One [[deck]]."""
    file = table.text("file")
    if not file.endswith(".inp") or not (folder / file).is_file():
        raise table.error(f"'file' is '{file}': expected a deck *.inp of this folder")
    deck = Deck(file, table.choice("label", LABELS), table.integer("exit", 0))
    table.finish()
    return deck


def read_measure(table: TomlTable) -> Measure:
    """One [[measure]]."""
    measure = Measure(
        name=table.text("name"),
        function=table.text("function"),
        arguments=table.table("arguments", {}),
        decks=tuple(table.texts("decks")),
        exact=table.number("exact", None),
        rtol=table.number_or_by_name("rtol", 0.0),
        atol=table.number_or_by_name("atol", 0.0),
        frozen=table.numbers_by_name("frozen", None),
    )
    table.finish()
    has_tolerance = table.has("rtol") or table.has("atol")
    if has_tolerance != (measure.exact is not None):
        raise table.error("expected 'exact' together with 'rtol' or 'atol'")
    return measure


def read_study(table: TomlTable) -> Study:
    """One [[study]]."""
    name = table.text("name")
    kind = table.one_key_of("measure", "expect")
    what = table.text(kind)
    decks, h = tuple(table.texts("decks")), tuple(table.numbers("h"))
    study = Study(
        name,
        what if kind == "measure" else None,
        what if kind == "expect" else None,
        decks,
        h,
        table.number("order"),
    )
    table.finish()
    if len(decks) < 2 or len(h) != len(decks):
        raise table.error("expected two decks or more and as many 'h'")
    if min(h) <= 0.0 or len(set(h)) < len(h):
        raise table.error("'h': expected sizes above 0, all different")
    return study


def read_figure(table: TomlTable) -> CaseFigure:
    """One [[figure]]."""
    file, caption = table.text("file"), table.text("caption")
    if not file.endswith(".png") or "/" in file:
        raise table.error(f"'file' is '{file}': expected the name of a PNG file")
    kind = table.one_key_of("command", "function", "studies")
    value = table.text(kind) if kind == "function" else tuple(table.texts(kind))
    table.finish()
    return CaseFigure(file, caption, **{kind: value})


def check_references(case: Case, table: TomlTable) -> None:
    """Names must be there once, and what is referred to must be there."""
    files = [deck.file for deck in case.decks]
    check_names(table, "deck", files)
    for path in sorted(case.folder.glob("*.inp")):
        if path.name not in files:
            raise table.error(f"no [[deck]] is '{path.name}': expected all decks of the folder")
    check_names(table, "measure", [measure.name for measure in case.measures])
    check_names(table, "study", [study.name for study in case.studies])
    for item in (*case.measures, *case.studies):
        kind = type(item).__name__.lower()
        check_known(table, f"{kind} '{item.name}'", "deck", item.decks, files)
    for measure in case.measures:
        frozen = tuple(measure.frozen or {})
        check_known(table, f"'frozen' of '{measure.name}'", "deck", frozen, list(measure.decks))
        for key, values in (("rtol", measure.rtol), ("atol", measure.atol)):
            if isinstance(values, dict) and set(values) != set(measure.decks):
                raise table.error(
                    f"'{key}' of '{measure.name}': expected one for each of its decks"
                )
    for study in case.studies:
        if study.measure is not None:
            known = [measure.name for measure in case.measures]
            check_known(table, f"study '{study.name}'", "measure", (study.measure,), known)
            of_measure = next(m for m in case.measures if m.name == study.measure)
            place = f"study '{study.name}'"
            check_known(table, place, "deck of the measure", study.decks, list(of_measure.decks))
    for figure in case.figures:
        known = [study.name for study in case.studies]
        check_known(table, f"figure '{figure.file}'", "study", figure.studies, known)


def check_names(table: TomlTable, kind: str, names: list[str]) -> None:
    """No name twice."""
    for name in names:
        if names.count(name) > 1:
            raise table.error(f"{kind} '{name}' is there twice")


def check_known(
    table: TomlTable, place: str, kind: str, names: tuple[str, ...], known: list[str]
) -> None:
    """All names are among the known ones."""
    for name in names:
        if name not in known:
            there = ", ".join(known) or "none"
            raise table.error(f"{place}: there is no {kind} '{name}': there are {there}")
