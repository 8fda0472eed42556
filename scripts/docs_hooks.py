"""Hooks of the docs build: formulas become MathML, so that pages need no script and no network.

``$$ ... $$`` is a displayed formula, ``$ ... $`` one in a line. ``{{ model }}`` stands for the
equations of motion and ``{{ comparison }}`` for the comparison of controllers, both made anew at every
build. Formulas wait behind a mark while Markdown is at work, which would take MathML for HTML.
"""

import re
from functools import cache

from latex2mathml.converter import convert

FENCE = re.compile(r"(```.*?```|`[^`\n]+`)", re.DOTALL)
DISPLAY = re.compile(r"\$\$(.+?)\$\$", re.DOTALL)
INLINE = re.compile(r"(?<![\\$])\$([^$]+?)\$")
MARK = re.compile(r"<p>%FORMULA(\d+)%</p>|%FORMULA(\d+)%")

_formulas: list[str] = []


def on_page_markdown(markdown: str, **_: object) -> str:
    """Called by MkDocs before Markdown: hide the formulas."""
    for mark, text in (("{{ model }}", model), ("{{ comparison }}", comparison)):
        if mark in markdown:
            markdown = markdown.replace(mark, text())
    parts = FENCE.split(markdown)
    return "".join(part if n % 2 else _hidden(part) for n, part in enumerate(parts))


def on_page_content(html: str, **_: object) -> str:
    """Called by MkDocs after Markdown: put the formulas back, as MathML."""
    return MARK.sub(lambda found: _formulas[int(found[1] or found[2])], html)


def _hidden(text: str) -> str:
    def display(found: re.Match[str]) -> str:
        formula = convert(found[1].strip(), display="block")
        block = f'<div style="overflow-x:auto;padding:.3em 0">{formula}</div>'
        return f"\n\n{_mark(block)}\n\n"

    text = DISPLAY.sub(display, text)
    return INLINE.sub(lambda found: _mark(convert(found[1])), text)


def _mark(formula: str) -> str:
    _formulas.append(formula)
    return f"%FORMULA{len(_formulas) - 1}%"


@cache
def comparison() -> str:
    """The rankings of all trackers on the built-in curves, as Markdown tables."""
    from osculate import compare
    from osculate.study.comparison.report import ranking_table
    from osculate.study.comparison.suite import conditions, starts

    tables = []
    for title, begin, robot in (
        ("On the robot that the laws know", ["on-path", "offset", "metre", "across"], "ideal"),
        ("With a steering servo 30 % slower", ["on-path"], "slow-servo"),
        ("With 40 ms of delay that no law knows", ["on-path"], "late"),
    ):
        result = compare(start=starts(begin), condition=conditions([robot]))
        header, *rows = ranking_table(result)
        lines = [header, ["---"] + ["---:"] * (len(header) - 1), *rows]
        tables.append(f"### {title}\n\n" + "\n".join("| " + " | ".join(r) + " |" for r in lines))
    return "\n\n".join(tables)


@cache
def model() -> str:
    """Titles and formulas of the derivation."""
    from osculate.vehicle.derivation import derive

    lines = []
    for line in derive().latex().splitlines():
        title = line.removeprefix("% ")
        lines.append(f"\n*{title}*\n" if line.startswith("%") else f"\n$${line}$$\n")
    return "\n".join(lines)
