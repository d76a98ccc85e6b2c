"""Convergence plots of the report: residual against iteration, and against the one before."""

from collections.abc import Sequence

import numpy as np
import plotly.graph_objects as go
from cmcrameri import cm

from tessera_post.report_attempts import Reference, Trial, find_reference
from tessera_post.report_plots import INK, Plot, axis, layout, make_room

MOST_LINES = 200  # more lines would be a grey patch, and slow
FAILED = "#d55e00"
DARK = 0.8  # the end of the colour scale is too pale for lines on white
N_SHADES = 17
HOVER = "%{text}<br>iteration %{x}: residual %{y:.3~e}<extra></extra>"
HOVER_PAIR = "%{text}<br>residual %{x:.3~e} → %{y:.3~e}<extra></extra>"


def colorscale() -> list[list[object]]:
    """Increments from dark to light."""
    return [[s, rgb(float(s))] for s in np.linspace(0.0, 1.0, N_SHADES)]


def rgb(shade: float) -> str:
    """A colour of the scale of increments."""
    red, green, blue = (round(255 * part) for part in cm.batlow(DARK * shade)[:3])
    return f"rgb({red},{green},{blue})"


def thinned(trials: Sequence[Trial], most: int = MOST_LINES) -> list[Trial]:
    """Attempts evenly left out, if there are more than can be seen."""
    if len(trials) <= most:
        return list(trials)
    return [trials[i] for i in np.linspace(0, len(trials) - 1, most).astype(int)]


def shown_trials(trials: Sequence[Trial]) -> tuple[list[Trial], str]:
    """The attempts that are drawn, and a note when some are left out."""
    accepted = [trial for trial in trials if trial.accepted and len(trial.residuals)]
    failed = [trial for trial in trials if not trial.accepted and len(trial.residuals)]
    shown = thinned(accepted) + thinned(failed)
    every = len(accepted) + len(failed)
    if len(shown) == every:
        return shown, ""
    return shown, f"{len(shown)} of {every} attempts are drawn, evenly chosen."


def convergence_plots(trials: Sequence[Trial], tolerance: float | None) -> list[Plot]:
    """Both panels; empty when there are no iterations."""
    shown, note = shown_trials(trials)
    if not shown:
        return []
    reference = find_reference(trials)
    left = residual_figure(shown, reference, tolerance)
    right = order_figure(shown, reference)
    return [
        Plot("convergence", "Residual against iteration", left, 480, note),
        Plot("order", "Residual against the one before", right, 480),
    ]


def curve(trial: Trial, x: np.ndarray, y: np.ndarray, span: tuple[int, int]) -> go.Scatter:
    """The line of an attempt, coloured by its increment, dashed when it failed."""
    low, high = span
    shade = (trial.number - low) / max(high - low, 1)
    marker = {"size": 6, "color": np.full(len(x), float(trial.number)), "coloraxis": "coloraxis"}
    line = {"color": rgb(shade), "width": 1.3, "dash": "solid"}
    if not trial.accepted:
        marker = {"size": 8, "color": FAILED, "symbol": "x"}
        line = {"color": FAILED, "width": 1.3, "dash": "dash"}
    return go.Scatter(
        x=x, y=y, mode="lines+markers", marker=marker, line=line, text=[trial.name] * len(x)
    )


def span_of(trials: Sequence[Trial]) -> tuple[int, int]:
    """First and last increment."""
    numbers = [trial.number for trial in trials]
    return min(numbers), max(numbers)


def residual_figure(
    trials: Sequence[Trial], reference: Reference | None, tolerance: float | None
) -> go.Figure:
    """Relative residual against iteration, one line per attempt."""
    figure = go.Figure()
    span = span_of(trials)
    for trial in trials:
        positive = np.flatnonzero(trial.residuals > 0.0)  # the axis is logarithmic
        trace = curve(trial, positive.astype(float), trial.residuals[positive], span)
        trace.update(hovertemplate=HOVER, showlegend=False)
        figure.add_trace(trace)
    low, high = range_of([trial.residuals for trial in trials])
    most = max(trial.n_iterations for trial in trials)
    if reference is not None:
        x = np.linspace(0.0, most, 40 * most + 1)
        y = reference.at(x)
        seen = (y >= low) & (y <= high)
        figure.add_trace(reference_line(x[seen], y[seen], "order 2: r → C r²", "dash"))
    if tolerance is not None:
        ends = [tolerance, tolerance]
        figure.add_trace(reference_line([0.0, most], ends, "tolerance of Newton's method", "dot"))
    layout(
        figure,
        axis("iteration [-]", dtick=max(1, -(-most // 10)), range=[-0.3, most + 0.3]),
        log_axis("relative residual [-]", low, high),
    )
    add_failed(figure, trials)
    make_room(figure)
    add_colorbar(figure, span)
    return figure


def order_figure(trials: Sequence[Trial], reference: Reference | None) -> go.Figure:
    """Residual after a correction against the one before, with slopes 1 and 2."""
    figure = go.Figure()
    span = span_of(trials)
    pairs = [pairs_of(trial) for trial in trials]
    for trial, (before, after) in zip(trials, pairs):
        trace = curve(trial, before, after, span)
        trace.update(hovertemplate=HOVER_PAIR, showlegend=False, mode="markers")
        figure.add_trace(trace)
    low, high = range_of([values for pair in pairs for values in pair])
    add_slopes(figure, low, high, reference.constant if reference else 1.0)
    layout(
        figure,
        log_axis("residual before [-]", low, high, most_ticks=5),
        log_axis("residual after [-]", low, high),
    )
    add_failed(figure, trials)
    make_room(figure)
    add_colorbar(figure, span)
    return figure


def pairs_of(trial: Trial) -> tuple[np.ndarray, np.ndarray]:
    """Residuals before and after each correction but the first: before it, nothing has moved."""
    r = trial.residuals[1:]
    positive = (r[:-1] > 0.0) & (r[1:] > 0.0)
    return r[:-1][positive], r[1:][positive]


def add_slopes(figure: go.Figure, low: float, high: float, constant: float) -> None:
    """Lines of slope 1, a residual that stays, and 2, through the attempts."""
    figure.add_trace(reference_line([low, high], [low, high], "slope 1", "dot"))
    x = np.geomspace(max(low, np.sqrt(low / constant)), min(high, np.sqrt(high / constant)), 2)
    figure.add_trace(reference_line(x, constant * x**2, "slope 2", "dash"))


def reference_line(
    x: Sequence[float] | np.ndarray, y: Sequence[float] | np.ndarray, name: str, dash: str
) -> go.Scatter:
    """A black line that is no result."""
    line = {"color": INK, "width": 2, "dash": dash}
    return go.Scatter(x=x, y=y, mode="lines", name=name, line=line, hoverinfo="skip")


def add_failed(figure: go.Figure, trials: Sequence[Trial]) -> None:
    """An entry of the legend for attempts that failed, if any did."""
    if all(trial.accepted for trial in trials):
        return
    figure.add_trace(
        go.Scatter(
            x=[None],
            y=[None],
            mode="lines+markers",
            name="attempt that failed",
            line={"color": FAILED, "width": 1.3, "dash": "dash"},
            marker={"size": 8, "color": FAILED, "symbol": "x"},
        )
    )


def add_colorbar(figure: go.Figure, span: tuple[int, int]) -> None:
    """The scale of increments."""
    low, high = span
    bar = {"title": {"text": "increment", "side": "right"}, "thickness": 14, "outlinewidth": 0}
    if high - low < 8:
        bar |= {"tickmode": "linear", "tick0": low, "dtick": 1}
    scale = {"colorscale": colorscale(), "cmin": low, "cmax": max(high, low + 1), "colorbar": bar}
    figure.update_layout(coloraxis={**scale, "showscale": high > low})


def range_of(series: Sequence[np.ndarray]) -> tuple[float, float]:
    """Full decades around all positive values."""
    values = np.concatenate([np.asarray(values, dtype=float) for values in series])
    values = values[(values > 0.0) & np.isfinite(values)]
    if len(values) == 0:
        return 1e-10, 1.0
    low, high = np.floor(np.log10(values.min())), np.ceil(np.log10(values.max()))
    return float(10.0**low), float(10.0 ** max(high, low + 1.0))


def log_axis(title: str, low: float, high: float, most_ticks: int = 8) -> dict[str, object]:
    """A logarithmic axis over full decades."""
    decades = np.log10([low, high])
    step = max(1, round(float(np.ptp(decades)) / most_ticks))
    margin = 0.02 * float(np.ptp(decades))
    ends = [float(decades[0]) - margin, float(decades[1]) + margin]
    return axis(title, type="log", range=ends, dtick=step)
