"""Hooks of the docs build: formulas become MathML, so that pages need no script and no network.

``$$ ... $$`` is a displayed formula, ``$ ... $`` one in a line. ``{{ model }}`` stands for the equations
of motion, derived anew at every build.
"""

import re
from functools import cache

from latex2mathml.converter import convert

FENCE = re.compile(r"(```.*?```|`[^`\n]+`)", re.DOTALL)
DISPLAY = re.compile(r"\$\$(.+?)\$\$", re.DOTALL)
INLINE = re.compile(r"(?<![\\$])\$([^$\n]+?)\$")


def on_page_markdown(markdown: str, **_: object) -> str:
    """Called by MkDocs for every page."""
    if "{{ model }}" in markdown:
        markdown = markdown.replace("{{ model }}", model())
    parts = FENCE.split(markdown)
    return "".join(part if n % 2 else formulas(part) for n, part in enumerate(parts))


def formulas(text: str) -> str:
    """Replace every formula by MathML."""
    text = DISPLAY.sub(lambda m: f"\n<div>{convert(m[1].strip(), display='block')}</div>\n", text)
    return INLINE.sub(lambda m: convert(m[1]), text)


@cache
def model() -> str:
    """Titles and formulas of the derivation."""
    from osculate.vehicle.derivation import derive

    lines = []
    for line in derive().latex().splitlines():
        title = line.removeprefix("% ")
        lines.append(f"\n*{title}*\n" if line.startswith("%") else f"\n$${line}$$\n")
    return "\n".join(lines)
