"""Names are texts: on the terminal, on pages, in figures and as files, whatever they look like."""

import html
import json
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from unittest import mock

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from rich.console import Console

from osculate import Comparison, Continuous, Cycloid, simulate
from osculate.apps import terminal
from osculate.study.comparison.compare import Trace
from osculate.study.report import _as_script, write_report

PIECES = (
    "[bold]", "[/x]", "[", "]", "$", "\\", "|", "<script>", "</script>", "<b>", "&amp;", "&", "{", "}", "_",
    ":smile:", "%s", "'", '"', "ü", "a", " ", "..", "/", "^", "~",
)  # fmt: skip
NAMES = st.lists(st.sampled_from(PIECES), min_size=1, max_size=6).map("".join)


@given(NAMES)
@example("[/x]")
@example(":smile:")
def test_the_terminal_shows_names_as_they_are(name):
    with terminal.out.capture() as got:
        terminal.tell_path("Report", name)
        terminal.tell_verdict(name, terminal.out, good=False)
        terminal.print_rows(name, [("label", name)])
        terminal.print_table([["controller"], [name]])
    lines = [line.strip(" │┃") for line in got.get().splitlines()]
    assert lines[0] == f"Report: {name}".strip()
    assert lines[1] == name.strip()
    assert sum(name.strip() in line for line in lines) >= 5 or len(name.strip()) < 2
    for console in (terminal.out, terminal.err):
        with console.capture() as got:
            console.print(name, soft_wrap=True)
        assert got.get() == f"{name}\n"
    with terminal.err.capture() as got:
        terminal.tell_error(name)
        terminal.tell_warning(name)
        with terminal.progress(name) as report:
            report(0.5)
    assert f"error: {name}".strip() in got.get()
    assert f"warning: {name}".strip() in got.get()


def test_names_command_no_terminal():
    assert terminal.shown("a\x1b[2J\r\x9bb\ud800\tc\n") == "a\\x1b[2J\\x0d\\x9bb\\ud800\tc\n"


class Page(HTMLParser):
    """Tags of a page, and its text outside scripts."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.texts, self.scripts = [], [], []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)

    def handle_data(self, data):
        script = self.tags and self.tags[-1] == "script" and self.cdata_elem
        (self.scripts if script else self.texts).append(data)


@pytest.fixture(scope="module")
def run():
    return simulate(Cycloid.over(), clock=Continuous(duration=0.2))


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=15)
@given(NAMES)
@example("</script><script>alert(1)</script>")
def test_a_report_shows_names_as_they_are(run, tmp_path, name):
    plain, path = tmp_path / "plain.html", tmp_path / "page.html"
    write_report(run, plain, "x", "x")
    write_report(run, path, name, name)
    usual, page = (Page(p.read_text(encoding="utf-8")) for p in (plain, path))
    assert page.tags == usual.tags
    assert f"<h1>{html.escape(name)}</h1>" in path.read_text(encoding="utf-8")
    (data,) = re.findall(r"const plots = (.*);", path.read_text(encoding="utf-8"))
    assert len(json.loads(data)) > 5
    assert "<" not in _as_script([name])
    assert json.loads(_as_script([name])) == [name]


def comparison(controllers, curves):
    """A result with these names; the numbers mean nothing."""
    s = np.linspace(0.0, 1.0, 5)
    cells, traces = [], {}
    for law in controllers:
        for curve in curves:
            key = {"controller": law, "curve": curve, "speed": 1.0, "start": law, "plant": curve}
            numbers = ("cross_track_rms", "cross_track_max", "heading_error_rms", "duration",
                       "steering_travel", "torque_travel", "energy", "speed_max")  # fmt: skip
            values = {**dict.fromkeys(numbers, 1.0), "failed": True, "arrived": False, "ended": law}
            verdict = {"verdict": "hit", "sentence": law, "verdict_place": 1.0, "verdict_time": 1.0}
            cells.append({**key, "seed": 1, **values, **verdict})
            traces[law, curve, "1", curves[0], curves[0]] = Trace(s, s, s, s)
    return Comparison(cells, traces, dict.fromkeys(curves, Cycloid.over()))


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=1)
@given(st.lists(NAMES, min_size=2, max_size=2, unique=True), NAMES)
@example(["a/b", "A_b"], "_$x$")
@example(["../x", "$\\frac$"], "<script>$\\frac$")
def test_a_comparison_takes_any_names(tmp_path, curves, law):
    folder = tmp_path / "deep" / "out"
    written = comparison([law, f"{law} 2"], curves).write(folder)
    page = Page((folder / "comparison.html").read_text(encoding="utf-8"))
    assert "script" not in page.tags
    assert law.strip() in "".join(page.texts)
    assert len({*written}) == 5
    assert {path.name for path in written} == {p.name for p in folder.iterdir()} - {
        ".osculate.json"
    }
    assert [*tmp_path.iterdir()] == [folder.parent]
    assert [*folder.parent.iterdir()] == [folder]


def test_a_scenario_with_names_that_look_like_markup(tmp_path):
    name = "[bold]x[/y] <script>alert(1)</script> & $x$ :smile:"
    folder = tmp_path / "[red]out[/z]"
    path = tmp_path / "[b]mine[/c].yaml"
    path.parent.mkdir()
    path.write_text(
        f"name: '{name}'\nclock: {{kind: continuous, duration: 0.2}}\n", encoding="utf-8"
    )
    done = subprocess.run(
        [sys.executable, "-m", "osculate", "run", str(path), "--output", str(folder)],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 14, done.stderr  # late
    assert name in " ".join(done.stdout.split())  # the title may be broken into lines
    assert f"Report: {folder / 'report.html'}" in done.stdout
    assert f"<h1>{html.escape(name)}</h1>" in Path(folder / "report.html").read_text("utf-8")


def test_a_table_shows_names_whole_in_80_columns():
    names = ["curvature-tracker", "lqr-preview"]
    header = ["controller", *["a column of figures"] * 5]
    with mock.patch.object(terminal, "out", Console(width=80)), terminal.out.capture() as got:
        terminal.print_table([header, *([name, *["0.0005032"] * 5] for name in names)])
    assert all(f"│ {name} " in got.get() for name in names)
    assert "…" not in got.get()
