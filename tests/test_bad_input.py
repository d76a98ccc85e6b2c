"""Bad input: the exact message and exit code of broken decks, meshes and command lines."""

import json
import os
import re
import subprocess

import pytest
from bad_input_cases import CASES, PLANE
from conftest import ROOT

PLACE = re.compile(r"^[^\s:][^:]*:\d+:\d+: (error|warning): ")
WITHOUT_PLACE = re.compile(r"^(tessera: |[^\s:][^:]*: )?error: ")
DETAIL = re.compile(r"^  (worst place|likely cause|last attempt): ")
EXCERPT = re.compile(r"^( {0,4}\d+|     ) \| ")


def assert_clean(stderr):
    """No trace of a crash, and every line is a message with its place, or belongs to one."""
    for word in ("Backtrace", "Fortran runtime error", "At line", "SIGSEGV", "SIGFPE"):
        assert word not in stderr
    previous = ""
    for line in stderr.splitlines():
        if EXCERPT.match(line):
            assert PLACE.match(previous) or EXCERPT.match(previous), stderr
        elif DETAIL.match(line):
            assert WITHOUT_PLACE.match(previous) or DETAIL.match(previous), stderr
        elif not line.startswith(("tessera --help", "EXPECT ")):
            assert PLACE.match(line) or WITHOUT_PLACE.match(line), stderr
        previous = line


# --- decks and meshes ----------------------------------------------------------------------------


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_broken_input_gets_its_message(case, run_tessera, tmp_path):
    for name, content in case.files.items():
        if name.endswith("/"):
            (tmp_path / name).mkdir()
        else:
            (tmp_path / name).write_text(content, encoding="utf-8")
    run = run_tessera(case.deck().encode("utf-8", "surrogateescape"), *case.arguments, timeout=60)
    assert run.stderr == case.stderr
    assert run.code == case.code
    assert_clean(run.stderr)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_message_says_what_was_expected(case):
    """Of the message as it stands in the table; a run that fails later says what happened."""
    messages = [line for line in case.stderr.splitlines() if "error: " in line]
    for message in messages:
        hint = case.stderr.split(message, 1)[1].splitlines()[1:3]
        told = "expected" in message or any("did you mean" in line for line in hint)
        assert told or "No such file" in message or "Is a directory" in message or case.code == 4


def test_cases_are_many_and_different():
    assert len(CASES) >= 180
    assert len(KEYWORDS) >= 30
    assert len({case.name for case in CASES}) == len(CASES)


@pytest.mark.parametrize(
    "data",
    [
        PLANE.encode(),
        PLANE.replace("\n", "\r\n").encode(),
        b"\xef\xbb\xbf" + PLANE.encode(),
        PLANE.replace(", ", "\t,\t").encode(),
        PLANE.rstrip("\n").encode(),
        PLANE.lower().encode(),
        PLANE.replace("square", "Würfel").encode(),
    ],
    ids=["as it is", "CRLF", "byte-order mark", "tabs", "no last line feed", "lower case", "UTF-8"],
)
def test_harmless_forms_run(data, run_tessera):
    run = run_tessera(data, "-q")
    assert (run.code, run.stderr) == (0, "")


# --- the schema: every keyword, parameter and field ----------------------------------------------


def schema():
    """The schema as data; without the program the tests that need it are collected empty."""
    program = os.environ.get("TESSERA_EXE", ROOT / "build" / "debug" / "bin" / "tessera")
    try:
        run = subprocess.run([program, "--schema"], capture_output=True, text=True, check=True)
    except OSError:
        return []
    return json.loads(run.stdout)["keywords"]


KEYWORDS = schema()
PARAMETERS = [(keyword, rule) for keyword in KEYWORDS for rule in keyword["parameters"]]
LINES = [(k, line) for k in KEYWORDS for line in k["data"]["lines"] if line["fields"]]
FIELDS = [(k, line, i) for k, line in LINES for i in range(len(line["fields"]))]
GOOD = {
    "flag": "",
    "integer": "1",
    "real": "0.25",
    "reals": "0,1",
    "name": "SOME",
    "text": "some",
    "item": "1",
}
BAD = {
    "integer": "1.5",
    "real": "0.2x",
    "reals": "0.2x",
    "choice": "?",
    "name": "17",
    "item": "1.5",
}


def name_of(value):
    if isinstance(value, dict):
        return value.get("keyword") or value.get("name") or value.get("when") or "line"
    return str(value)


def swapped(word):
    """The last two letters that differ, swapped."""
    i = next(i for i in range(len(word) - 2, -1, -1) if word[i] != word[i + 1])
    return word[:i] + word[i + 1] + word[i] + word[i + 2 :]


def good(rule):
    return rule["choices"][0] if rule["type"] == "choice" else GOOD[rule["type"]]


def expectation(rule):
    """What a value must be, in words: written here once more, on purpose."""
    if rule["type"] == "choice":
        choices = rule["choices"]
        return " or ".join([", ".join(choices[:-1])] * (len(choices) > 1) + choices[-1:])
    return {
        "integer": f"an integer {rule.get('range', '')}".strip(),
        "real": f"a real {rule.get('range', '')}".strip(),
        "reals": "reals separated by commas",
        "name": "a name of at most 80 characters",
        "item": "a number > 0 or the name of a set",
        "text": "a text",
    }[rule["type"]]


def written(rule, value=None):
    if rule["type"] == "flag" and value is None:
        return rule["name"]
    return f"{rule['name']}={good(rule) if value is None else value}"


def head(keyword, left_out, *last):
    """A keyword line with the required parameters, one of each group, but for those left out."""
    parts, groups = [keyword["keyword"]], {rule.get("exclusive") for rule in left_out} - {None}
    for rule in keyword["parameters"]:
        if rule in left_out or not rule["required"] or rule.get("exclusive") in groups:
            continue
        groups |= {rule.get("exclusive")} - {None}
        parts.append(written(rule))
    needs = [rule["only_with"] for rule in left_out if "only_with" in rule]
    given = {need.split("=")[0] for need in needs}
    parts = [part for part in parts if part.split("=")[0] not in given]
    return ", ".join(parts + needs + list(last))


def message(line, column, width, error, hint=""):
    """A complete message about the first line of job.inp."""
    pointer = " " * (column - 1) + "^" + "~" * (width - 1)
    return f"job.inp:1:{column}: error: {error}\n    1 | {line}\n      | {pointer} {hint}".rstrip()


def check(run, expected):
    assert f"\n{expected}\n" in f"\n{run.stderr}\n", run.stderr
    assert run.code == 2
    assert_clean(run.stderr)


@pytest.mark.parametrize("keyword", KEYWORDS, ids=name_of)
def test_misspelt_keyword_is_recognised(keyword, run_tessera):
    line = swapped(keyword["keyword"])
    run = run_tessera(line + "\n")
    hint = f"did you mean '{keyword['keyword']}'?"
    assert run.stderr == message(line, 1, len(line), f"unknown keyword '{line}'", hint) + "\n"
    assert run.code == 2


@pytest.mark.parametrize(("keyword", "rule"), PARAMETERS, ids=name_of)
def test_misspelt_parameter_is_recognised(keyword, rule, run_tessera):
    wrong = swapped(rule["name"])
    line = head(keyword, [rule])
    column = len(line) + 3
    line += ", " + written(dict(rule, name=wrong))
    error = f"unknown parameter '{wrong}' of {keyword['keyword']}"
    hint = f"did you mean '{rule['name']}'?"
    check(run_tessera(line + "\n"), message(line, column, len(wrong), error, hint))


@pytest.mark.parametrize(("keyword", "rule"), PARAMETERS, ids=name_of)
def test_missing_parameter_is_reported(keyword, rule, run_tessera):
    group = [r for r in keyword["parameters"] if r.get("exclusive") and r["required"]]
    line = head(keyword, group if rule in group else [rule])
    word = keyword["keyword"]
    expected = (
        f"{rule['name']} with {expectation(rule)}" if rule["type"] != "flag" else rule["name"]
    )
    error = f"missing parameter {rule['name']} of {word}: expected {expected}"
    if rule in group:
        names = [r["name"] for r in group]
        error = f"missing parameter of {word}: expected {', '.join(names[:-1])} or {names[-1]}"
    run = run_tessera(line + "\n")
    if rule["required"]:
        check(run, message(line, 1, len(word), error))
    else:
        assert "missing parameter" not in run.stderr


@pytest.mark.parametrize(("keyword", "rule"), PARAMETERS, ids=name_of)
def test_parameter_without_value_is_reported(keyword, rule, run_tessera):
    line = head(keyword, [rule])
    column = len(line) + 3
    what = f"{rule['name']} of {keyword['keyword']}"
    if rule["type"] == "flag":
        line += f", {rule['name']}=YES"
        expected = message(
            line, column + len(rule["name"]) + 1, 3, f"{what} is a flag: expected no value"
        )
    else:
        line += f", {rule['name']}"
        error = f"{what} has no value: expected {expectation(rule)}"
        expected = message(line, column, len(rule["name"]), error)
    check(run_tessera(line + "\n"), expected)


@pytest.mark.parametrize(
    ("keyword", "rule"), [p for p in PARAMETERS if p[1]["type"] in BAD], ids=name_of
)
def test_wrong_value_of_parameter_is_reported(keyword, rule, run_tessera):
    wrong = BAD[rule["type"]]
    line = head(keyword, [rule])
    column = len(line) + 4 + len(rule["name"])
    line += ", " + written(rule, wrong)
    error = f"{rule['name']} of {keyword['keyword']} is '{wrong}': expected {expectation(rule)}"
    check(run_tessera(line + "\n"), message(line, column, len(wrong), error))


def card(keyword, line):
    """A keyword line for which a form of data lines holds, and the fields of a data line."""
    when = line.get("when", "")
    name, _, value = when.partition("=")
    rules = [rule for rule in keyword["parameters"] if rule["name"] == name]
    last = [written(rule, value.split("|")[0] if value else None) for rule in rules]
    fields = [good(rule) for rule in line["fields"] for _ in range(rule.get("count", 1))]
    if name == "field 2":
        fields[1] = value
    return head(keyword, rules, *last), fields


def data_message(fields, place, error):
    """A complete message about a field of line 2, or what is behind the last one."""
    text = ", ".join(fields)
    column = 1 + sum(len(field) + 2 for field in fields[:place])
    width = len(fields[place]) if place < len(fields) else 1
    if place == len(fields):
        column -= 2
    pointer = " " * (column - 1) + "^" + "~" * (width - 1)
    return f"job.inp:2:{column}: error: {error}\n    2 | {text}\n      | {pointer}"


@pytest.mark.parametrize(("keyword", "line", "i"), FIELDS, ids=name_of)
def test_wrong_kind_of_field_is_reported(keyword, line, i, run_tessera):
    first, fields = card(keyword, line)
    rule = line["fields"][i]
    place = sum(r.get("count", 1) for r in line["fields"][:i])
    fields[place] = BAD[rule["type"]]
    error = (
        f"{rule['name']} of {keyword['keyword']} is '{fields[place]}': expected {expectation(rule)}"
    )
    run = run_tessera(f"{first}\n{', '.join(fields)}\n")
    check(run, data_message(fields, place, error))


@pytest.mark.parametrize(("keyword", "line", "i"), FIELDS, ids=name_of)
def test_empty_field_is_reported(keyword, line, i, run_tessera):
    first, fields = card(keyword, line)
    fields += ["1"]
    rule = line["fields"][i]
    place = sum(r.get("count", 1) for r in line["fields"][:i])
    fields[place] = ""
    run = run_tessera(f"{first}\n{', '.join(fields)}\n")
    error = f"empty field in a line of {keyword['keyword']}: "
    error += f"expected {rule['name']}, {expectation(rule)}"
    assert f"error: {error}\n" in run.stderr
    assert run.code == 2
    assert_clean(run.stderr)


def layout(line):
    """Fields of a data line in words."""
    words = ""
    for i, rule in enumerate(line["fields"]):
        words += ("" if rule["required"] else "[") + (", " if i else "") + rule["name"]
        words += f" (x{rule['count']})" if rule.get("count", 1) > 1 else ""
    words += "]" * sum(not rule["required"] for rule in line["fields"])
    return words + (", ..." if line["repeats"] else "")


@pytest.mark.parametrize(("keyword", "line"), LINES, ids=name_of)
def test_wrong_count_of_fields_is_reported(keyword, line, run_tessera):
    first, fields = card(keyword, line)
    n_required = sum(r.get("count", 1) for r in line["fields"] if r["required"])
    what = f"values in a line of {keyword['keyword']}: expected {layout(line)}"
    if n_required > 1:
        few = fields[: n_required - 1]
        if not line.get("when", "").startswith("field") or len(few) > 1:
            run = run_tessera(f"{first}\n{', '.join(few)}\n")
            check(run, data_message(few, len(few), f"too few {what}"))
    if not line["repeats"]:
        many = [*fields, "1"]
        run = run_tessera(f"{first}\n{', '.join(many)}\n")
        check(run, data_message(many, len(many) - 1, f"too many {what}"))


@pytest.mark.parametrize("keyword", [k for k in KEYWORDS if k["data"]["min"] > 0], ids=name_of)
def test_missing_data_line_is_reported(keyword, run_tessera):
    line = head(keyword, [])
    run = run_tessera(line + "\n")
    word = keyword["keyword"]
    if keyword["keyword"] == "*NSET" or "when" not in keyword["data"]["lines"][0]:
        form = layout(keyword["data"]["lines"][-1])
        check(run, message(line, 1, len(word), f"missing data line of {word}: expected {form}"))
    else:
        assert f"error: missing data line of {word}: expected " in run.stderr
        assert run.code == 2


# --- command line and files ----------------------------------------------------------------------


COMMAND_LINES = {
    "no deck": ([], "no deck: expected tessera JOB.inp"),
    "two decks": (["a.inp", "b.inp"], "second deck 'b.inp': expected one"),
    "misspelt option": (["--chek", "a.inp"], "unknown option '--chek': did you mean '--check'?"),
    "unknown option": (["--frobnicate", "a.inp"], "unknown option '--frobnicate'"),
    "unknown letter": (["-z", "a.inp"], "unknown option '-z'"),
    "no folder": (["a.inp", "-o"], "--output needs a value: expected --output DIR"),
    "no threads": (["a.inp", "--threads"], "--threads needs a value: expected --threads N"),
    "zero threads": (["-t", "0", "a.inp"], "--threads is '0': expected an integer > 0"),
    "many threads": (["-t", "many", "a.inp"], "--threads is 'many': expected an integer > 0"),
    "twice the same to compare": (
        ["--compare", "fbar,fbar", "a.inp"],
        "--compare is 'fbar,fbar': expected standard,fbar or one of them",
    ),
    "flag with value": (["--check=yes", "a.inp"], "--check takes no value, found 'yes'"),
    "wrong schema": (["--schema=xml"], "--schema is 'xml': expected json or markdown"),
    "quiet and verbose": (["-q", "-v", "a.inp"], "--quiet and --verbose: expected one of them"),
    "two checks": (
        ["--check", "--check-tangent", "a.inp"],
        "--check and --check-tangent: expected one of them",
    ),
    "estimate and check": (
        ["--estimate", "--check", "a.inp"],
        "--check and --estimate: expected one of them",
    ),
    "no restart file": (["a.inp", "--restart"], "--restart needs a value: expected --restart FILE"),
    "no memory": (
        ["--max-memory", "0", "a.inp"],
        "--max-memory is '0': expected gigabytes, a number > 0",
    ),
}


@pytest.mark.parametrize("name", COMMAND_LINES)
def test_wrong_command_line_gets_its_message(name, tessera, run_program):
    arguments, error = COMMAND_LINES[name]
    run = run_program(tessera, *arguments)
    assert run.stderr == f"tessera: error: {error}\ntessera --help lists the options\n"
    assert (run.code, run.stdout) == (1, "")


def test_missing_deck_is_reported(tessera, run_program):
    run = run_program(tessera, "none.inp")
    assert run.stderr == "none.inp: error: cannot read the deck: No such file or directory\n"
    assert run.code == 2


def test_folder_for_a_deck_is_reported(tessera, run_program, tmp_path):
    (tmp_path / "deck.inp").mkdir()
    run = run_program(tessera, "deck.inp")
    assert run.stderr == "deck.inp: error: cannot read the deck: Is a directory\n"
    assert run.code == 2


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read and write everything")
def test_unreadable_deck_is_reported(tessera, run_program, tmp_path):
    (tmp_path / "deck.inp").write_text(PLANE)
    (tmp_path / "deck.inp").chmod(0)
    run = run_program(tessera, "deck.inp")
    assert run.stderr == "deck.inp: error: cannot read the deck: Permission denied\n"
    assert run.code == 2


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read and write everything")
def test_unwritable_folder_is_reported(run_tessera, tmp_path):
    (tmp_path / "closed").mkdir()
    (tmp_path / "closed").chmod(0o500)
    run = run_tessera(PLANE, "-o", "closed")
    assert "closed" in run.stderr
    assert run.code == 8
    assert_clean(run.stderr)


@pytest.mark.parametrize("folder", ["/proc/none", "job.inp/results", "job.inp"])
def test_impossible_folder_is_reported(folder, run_tessera):
    run = run_tessera(PLANE, "-o", folder)
    expected = "expected a path where a folder may be written"
    assert run.stderr == f"error: folder '{folder}' cannot be made: {expected}\n"
    assert run.code == 8


def test_earlier_results_are_kept_without_force(run_tessera, tmp_path):
    assert run_tessera(PLANE, "-q").code == 0
    log = (tmp_path / "job.log").read_bytes()
    run = run_tessera(PLANE, "-q")
    expected = "earlier results are only overwritten with --force"
    assert run.stderr == f"error: 'job.log' exists already: {expected}\n"
    assert run.code == 8
    assert (tmp_path / "job.log").read_bytes() == log
    assert run_tessera(PLANE, "-q", "--force").code == 0
