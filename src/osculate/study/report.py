"""The report of a run: one self-contained HTML page with interactive plots that works offline."""

import html
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from osculate.files import write_text
from osculate.simulation.dataset import plain_parts
from osculate.simulation.metrics import Metrics
from osculate.simulation.plot import BLUE, GREEN, GREY, ORANGE, RED, footprints, readable, thinned
from osculate.strict_json import strict_json

if TYPE_CHECKING:
    from osculate.simulation import Run, Verdict
    from osculate.study.scenario import Scenario
    from osculate.target import SpeedPlan

Trace = dict[str, Any]
PALETTE = [BLUE, ORANGE, GREEN, RED, "#7b4fa3", "#b08900", "#0f8a8a", "#5b6470"]


def metric_rows(metrics: Metrics) -> list[tuple[str, str]]:
    """Label and readable value with its unit, for every metric that is known."""
    rows = []
    for name, unit, label in Metrics.items():
        value = getattr(metrics, name)
        if value is not None:
            rows.append((label, value if isinstance(value, str) else _with_unit(value, unit)))
    return rows


def _with_unit(value: float, unit: str) -> str:
    if not np.isfinite(value):
        return "not known" if np.isnan(value) else "not finite"
    if unit == "m" and 0.0 < abs(value) < 1.0:
        factor, small = readable(abs(value))
        return f"{value * factor:.4g} {small}"
    if unit in ("rad", "rad/s"):
        return f"{np.degrees(value):.4g} {unit.replace('rad', '°')}"
    return f"{value:.5g} {unit}"


def write_report(run: "Run", path: Path, title: str, description: str = "") -> Path:
    """Write the page.

    Args:
        run: What to report.
        path: The HTML file.
        title: Heading of the page.
        description: One sentence below it.
    """
    from plotly.offline import get_plotlyjs

    column = thinned(run)
    plots = {
        "Path": _path_plot(run, column),
        "Speeds": _speed_plot(column),
        "Cross-track error": _error_plot(column),
        "Speed errors": _speed_error_plot(column),
        "Steering": _steering_plot(column),
        "Torques": _torque_plot(column),
    }
    if run.plan is not None:
        plots["Speed plan"] = _plan_plot(run, run.plan)
    page = _PAGE.format(
        title=html.escape(title),
        description=html.escape(description),
        verdict=verdict_banner(run.verdict),
        interventions=_interventions(run),
        rows="\n".join(
            f"<tr><th>{html.escape(label)}</th><td>{html.escape(value)}</td></tr>"
            for label, value in metric_rows(run.metrics)
        ),
        setup=html.escape(_setup_text(run)),
        sections="\n".join(
            f'<section><h2>{name}</h2><div class="plot" id="plot-{n}"></div></section>'
            for n, name in enumerate(plots)
        ),
        plots=_as_script(list(plots.values())),
        plotly=get_plotlyjs(),
    )
    return write_text(path, page)


def _as_script(data: Any) -> str:
    """Data within a script of the page, which no name in them ends."""
    return strict_json(data).replace("<", "\\u003c")


def write_refusal_report(verdict: "Verdict", scenario: "Scenario", path: Path) -> Path:
    """Write the page of a scenario that the robot cannot drive: there is no run to show."""
    fields = scenario.model_dump(mode="json")
    page = _PAGE.format(
        title=html.escape(scenario.name),
        description=html.escape(scenario.description),
        verdict=verdict_banner(verdict),
        interventions="",
        rows="<tr><th>There is no run.</th></tr>",
        setup=html.escape(strict_json(fields, indent=2)),
        sections="",
        plots="[]",
        plotly="",
    )
    return write_text(path, page)


def verdict_banner(verdict: "Verdict") -> str:
    """A verdict as the first line of a page: a sign, the word, the sentence."""
    kind, sign = ("good", "✓") if verdict.reached else ("bad", "✗")
    word, sentence = html.escape(verdict.kind), html.escape(verdict.sentence)
    return f'<p class="verdict {kind}"><strong>{sign} {word}</strong>: {sentence}.</p>'


def _interventions(run: "Run") -> str:
    """What was done instead of what the law decided, as lines of the page."""
    lines = [str(done) for done in run.interventions]
    return "<br>".join(html.escape(line) for line in [*lines, run.caution] if line)


def _setup_text(run: "Run") -> str:
    curve = run.setup.curve
    parts = plain_parts(run.setup)
    parts["curve"] = {"kind": getattr(curve, "kind", "curve"), "length": curve.length}
    return strict_json(parts, indent=2)


def _line(x: Any, y: Any, name: str, colour: str, dash: str = "solid", width: float = 2.0) -> Trace:
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "x": _numbers(x),
        "y": _numbers(y),
        "line": {"color": colour, "dash": dash, "width": width},
    }


def _numbers(values: Any) -> list[float]:
    return [float(f"{value:.7g}") for value in np.asarray(values).tolist()]


def _plot(traces: list[Trace], x: str, y: str, **layout: Any) -> dict[str, Any]:
    return {
        "data": traces,
        "layout": {
            "xaxis": {"title": {"text": x}, "zeroline": False},
            "yaxis": {"title": {"text": y}, "zeroline": False},
            "margin": {"l": 70, "r": 20, "t": 10, "b": 50},
            "legend": {"orientation": "h", "y": 1.02, "yanchor": "bottom"},
            "hovermode": "x unified",
            **layout,
        },
    }


def _path_plot(run: "Run", column: dict[str, Any]) -> dict[str, Any]:
    curve = run.setup.curve
    point = curve.at(np.linspace(0.0, curve.length, 601))
    start = (float(point.x[0]), float(point.y[0]))
    traces = [
        {
            **_filled(o.outline(start), "obstacle", "rgba(120,126,135,0.35)", GREY),
            "showlegend": n == 0,
        }
        for n, o in enumerate(run.scene.obstacles)
    ]
    traces += [
        _line(point.x, point.y, "target curve", ORANGE, width=5.0),
        _line(column["x"], column["y"], "path driven", BLUE),
    ]
    bodies = _filled(_joined(footprints(run, 24)), "footprint", "rgba(31,95,168,0.12)", BLUE)
    marker = {"color": GREEN, "size": 10}
    begin = {
        "type": "scatter", "mode": "markers", "name": "start",
        "x": [start[0]], "y": [start[1]], "marker": marker,
    }  # fmt: skip
    plot = _plot(
        [*traces, bodies, begin, *_verdict_mark(run.verdict)],
        "x (m)",
        "y (m)",
        hovermode="closest",
    )
    plot["layout"]["yaxis"].update(scaleanchor="x", scaleratio=1)
    return plot


def _verdict_mark(verdict: "Verdict") -> list[Trace]:
    """Where something happened, unless all is well."""
    if verdict.reached:
        return []
    return [
        {
            "type": "scatter", "mode": "markers", "name": str(verdict.kind),
            "x": [verdict.x], "y": [verdict.y],
            "marker": {"color": RED, "size": 13, "symbol": "x"},
        }
    ]  # fmt: skip


def _filled(outline: Any, name: str, fill: str, colour: str) -> Trace:
    closed = outline if isinstance(outline, list) else [*outline.tolist(), outline[0].tolist()]
    x = [None if c is None else float(f"{c[0]:.6g}") for c in closed]
    y = [None if c is None else float(f"{c[1]:.6g}") for c in closed]
    return {
        "type": "scatter", "mode": "lines", "name": name, "x": x, "y": y,
        "fill": "toself", "fillcolor": fill, "line": {"color": colour, "width": 1},
        "hoverinfo": "skip",
    }  # fmt: skip


def _joined(outlines: list[Any]) -> list[Any]:
    joined: list[Any] = []
    for outline in outlines:
        joined += [*outline.tolist(), outline[0].tolist(), None]
    return joined


def _speed_plot(column: dict[str, Any]) -> dict[str, Any]:
    t = column["time"]
    return _plot(
        [
            _line(t, column["speed"], "speed v (m/s)", BLUE),
            _line(t, column["target_speed"], "target v̂ (m/s)", BLUE, "dot"),
            _line(t, column["yaw_rate"], "yaw rate ω (rad/s)", ORANGE),
            _line(t, column["target_yaw_rate"], "target ω̂ (rad/s)", ORANGE, "dot"),
        ],
        "time (s)",
        "m/s, rad/s",
    )


def _error_plot(column: dict[str, Any]) -> dict[str, Any]:
    error = column["cross_track_error"]
    factor, unit = readable(float(np.abs(error).max()))
    return _plot(
        [_line(column["time"], error * factor, f"cross-track error ({unit})", RED)],
        "time (s)",
        f"left of the curve ({unit})",
        showlegend=False,
    )


def _speed_error_plot(column: dict[str, Any]) -> dict[str, Any]:
    t = column["time"]
    plot = _plot(
        [
            _line(t, column["speed_error"], "speed error v − v̂ (m/s)", BLUE),
            _line(t, column["yaw_rate_error"], "yaw-rate error ω − ω̂ (rad/s)", ORANGE),
        ],
        "time (s)",
        "m/s, rad/s",
    )
    plot["layout"]["yaxis"]["exponentformat"] = "power"
    return plot


def _plan_plot(run: "Run", plan: "SpeedPlan") -> dict[str, Any]:
    """The planned speed, coloured by the limit that binds, and the speed driven."""
    shares = plan.shares()
    every = max(1, len(plan.energy) // 1500)
    s, speed = plan.arc_length[::every], plan.speed[::every]
    binding = np.array(plan.binding)[::every]
    traces = []
    for colour, (name, share) in zip(PALETTE * 2, shares.items(), strict=False):
        here = [
            float(f"{v:.5g}") if b == name else None for v, b in zip(speed, binding, strict=True)
        ]
        traces.append(
            {
                "type": "scatter", "mode": "lines+markers", "name": f"{name} ({share:.0%})",
                "x": _numbers(s), "y": here, "marker": {"color": colour, "size": 4},
                "line": {"color": colour, "width": 3},
            }
        )  # fmt: skip
    column = thinned(run)
    traces.append(_line(column["foot"], column["speed"], "driven", GREY, "dot"))
    return _plot(traces, "arc length (m)", "speed (m/s)", hovermode="closest")


def _steering_plot(column: dict[str, Any]) -> dict[str, Any]:
    return _plot(
        [
            _line(
                column["time"], np.degrees(column["steering_angle"]), "steering angle φ (°)", GREEN
            )
        ],
        "time (s)",
        "φ (°)",
        showlegend=False,
    )


def _torque_plot(column: dict[str, Any]) -> dict[str, Any]:
    t = column["time"]
    return _plot(
        [
            _line(t, column["torque_left"], "left wheel (N m)", BLUE),
            _line(t, column["torque_right"], "right wheel (N m)", ORANGE, "dash"),
        ],
        "time (s)",
        "torque (N m)",
    )


_PAGE = (Path(__file__).with_name("report.html")).read_text(encoding="utf-8")
