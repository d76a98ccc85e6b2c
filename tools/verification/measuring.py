"""Calls the functions of a case's measures.py."""

import importlib.util
import math
import sys
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from tessera_post.errors import PostError
from tessera_post.job import Job

from verification.case import Case, Measure
from verification.running import DeckRun
from verification.toml_table import CaseError


@dataclass(frozen=True)
class Found:
    """What a measure found in one run."""

    measure: str
    deck: str
    value: float
    problem: str = ""  # not empty: there is no value


def function_of(case: Case, name: str) -> Callable[..., Any]:
    """A function of the case's measures.py. CaseError when it is not there."""
    path = case.folder / "measures.py"
    module_name = f"measures of {case.name}"
    module = sys.modules.get(module_name)
    if module is None or module.__file__ != str(path):
        spec = importlib.util.spec_from_file_location(module_name, path)
        if spec is None or spec.loader is None or not path.is_file():
            raise CaseError(f"there is no '{path}': expected a function '{name}' in it")
        module = importlib.util.module_from_spec(spec)
        sys.modules[module_name] = module
        try:
            spec.loader.exec_module(module)
        except Exception as problem:
            del sys.modules[module_name]
            raise CaseError(f"{path}: {last_line(problem)}") from problem
    function = getattr(module, name, None)
    if not callable(function):
        raise CaseError(f"'{path}' has no function '{name}'")
    return function


def measure_all(case: Case, runs: Sequence[DeckRun]) -> list[Found]:
    """All measures of all decks that have run."""
    return [
        measure_one(case, measure, run)
        for measure in case.measures
        for run in runs
        if run.deck.file in measure.decks
    ]


def measure_one(case: Case, measure: Measure, run: DeckRun) -> Found:
    """One measure of one run."""
    function = function_of(case, measure.function)
    try:
        job = Job(run.results)
    except PostError as problem:
        return Found(measure.name, run.deck.file, math.nan, f"'{measure.name}': {problem}")
    try:
        value = float(function(job, **measure.arguments))
    except Exception as problem:
        text = f"'{measure.name}' of {run.deck.file}: {last_line(problem)}"
        return Found(measure.name, run.deck.file, math.nan, text)
    finally:
        job.close()
    return Found(measure.name, run.deck.file, value)


def last_line(problem: BaseException) -> str:
    """An error in one line, with the place where it was raised."""
    frames = traceback.extract_tb(problem.__traceback__)
    where = f" ({frames[-1].filename}:{frames[-1].lineno})" if frames else ""
    return traceback.format_exception_only(problem)[-1].strip() + where
