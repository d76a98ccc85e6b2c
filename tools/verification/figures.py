"""Draws the figures of a case."""

import contextlib
import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from tessera_post.cli import run_command
from tessera_post.errors import PostError
from tessera_post.job import Job
from tessera_post.style import COLORS, MARKERS, plt, save

from verification.case import CaseFigure
from verification.judging import CaseResult, StudyResult
from verification.measuring import function_of
from verification.toml_table import CaseError


def draw_figures(result: CaseResult, folder: Path) -> None:
    """All figures of a case, in a folder. CaseError when one cannot be drawn."""
    folder.mkdir(parents=True, exist_ok=True)
    for figure in result.case.figures:
        path = folder / figure.file
        if figure.studies:
            draw_studies([s for s in result.studies if s.study.name in figure.studies], path)
        elif figure.command:
            draw_by_command(result, figure, path)
        else:
            draw_by_function(result, figure, path)


def draw_by_command(result: CaseResult, figure: CaseFigure, path: Path) -> None:
    """A picture of tessera-post: names of jobs become their result files."""
    results = {run.deck.job: str(run.results) for run in result.runs}
    name, *options = (results.get(word, word) for word in figure.command)
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            run_command(name, [*options, "-o", str(path)])
    except (PostError, ModuleNotFoundError, SystemExit) as problem:
        raise CaseError(f"figure '{figure.file}' of {result.case.name}: {problem}") from problem


def draw_by_function(result: CaseResult, figure: CaseFigure, path: Path) -> None:
    """A picture of measures.py, which gets all jobs by name."""
    function = function_of(result.case, figure.function)
    jobs: dict[str, Job] = {}
    try:
        for run in result.runs:
            jobs[run.deck.job] = Job(run.results)
        function(jobs, path)
    except PostError as problem:
        raise CaseError(f"figure '{figure.file}' of {result.case.name}: {problem}") from problem
    finally:
        for job in jobs.values():
            job.close()


def number_errors(axes: Axes) -> None:
    """Plain numbers at a logarithmic axis of errors."""
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_formatter(NullFormatter())


def draw_studies(studies: Sequence[StudyResult], path: Path) -> None:
    """Errors over the size of the cells, with a triangle for the least order."""
    figure, axes = plt.subplots(figsize=(7.0, 4.6))
    for i, result in enumerate(studies):
        h, errors = np.array(result.study.h), np.array(result.errors)
        label = f"{result.study.name}: order {result.order:.2f}"
        axes.loglog(h, errors, marker=MARKERS[i % 7], color=COLORS[i % 7], label=label)
    finest = min(studies, key=lambda result: min(result.errors))
    h = np.array([min(finest.study.h), max(finest.study.h)])
    least = 0.7 * min(finest.errors) * (h / h[0]) ** finest.study.order
    axes.loglog(h, least, color="0.5", linestyle="--", label=f"slope {finest.study.order:g}")
    axes.set(xlabel="size of cells", ylabel="error")
    sizes = sorted({size for result in studies for size in result.study.h})
    axes.set_xticks(sizes, [f"{size:g}" for size in sizes])
    axes.set_xticks([], minor=True)
    number_errors(axes)
    figure.legend(loc="outside upper center")
    save(figure, path)
