"""Words on a film: the verdict; time, speed and cross-track error with their units; what colours mean."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from osculate.simulation.recording.video.stage import Frame
from osculate.simulation.verdict import Verdict

DESIGN = (1280, 720)  # pixels, of the picture that these sizes are meant for
PLACE, PANEL = (28, 612), (760, 80)  # upper left corner; width and height
COLUMNS = ((22, "time"), (152, "speed"), (296, "cross-track error"), (628, "floor squares"))
LEGEND = (506, ("curve", (236, 125, 18)), ("driven", (38, 108, 184)))
BANNER = (28, 24, 1224)  # pixels from left and top, and width at most
GOOD, BAD = (29, 107, 66), (179, 38, 30)
WHITE, INK, PALE = (255, 255, 255, 215), (32, 36, 42), (98, 105, 114)


class Caption:
    """The verdict at the top, and a panel in the lower left corner of which only the numbers change."""

    def __init__(self, size: tuple[int, int], verdict: Verdict) -> None:
        from PIL import Image, ImageDraw

        self.size = size
        self._scale = min(size[0] / DESIGN[0], size[1] / DESIGN[1])
        left, up = self._scaled(PLACE[0]), size[1] - self._scaled(DESIGN[1] - PLACE[1])
        width, height = map(self._scaled, PANEL)
        self._area = slice(up, up + height), slice(left, left + width)
        self._words, self._numbers = self._font("DejaVuSans", 14), self._font("DejaVuSans-Bold", 23)
        self._draw_on = ImageDraw.Draw
        self._image = Image
        self._mask = self._rounded(width, height)
        self._draw_banner(verdict)

    def _rounded(self, width: int, height: int) -> Any:
        """A mask with round corners, drawn four times as large so that they have no steps."""
        corners = self._image.new("L", (4 * width, 4 * height))
        self._draw_on(corners).rounded_rectangle(
            (0, 0, 4 * width - 1, 4 * height - 1), 4 * self._scaled(12), fill=WHITE[3]
        )
        return corners.resize((width, height))

    def _draw_banner(self, verdict: Verdict) -> None:
        """Draw the verdict once: a sign, the word and the sentence, in as many lines as it needs."""
        colour, sign = (GOOD, "✓") if verdict.reached else (BAD, "✗")
        left, up, widest = map(self._scaled, BANNER)
        font, margin, step = self._font("DejaVuSans-Bold", 16), self._scaled(14), self._scaled(23)
        lines = wrapped(
            f"{sign} {verdict}", lambda text: font.getlength(text) <= widest - 2 * margin
        )
        width = 2 * margin + round(max(font.getlength(line) for line in lines))
        height = 2 * margin + step * len(lines)
        self._banner = self._image.new("RGB", (width, height), WHITE[:3])
        for n, line in enumerate(lines):
            draw = self._draw_on(self._banner)
            draw.text((margin, margin + n * step), line, font=font, fill=colour)
        self._top = slice(up, up + height), slice(left, left + width)
        self._top_mask = self._rounded(width, height)

    def on(self, picture: NDArray[np.uint8], frame: Frame) -> NDArray[np.uint8]:
        """A copy of a picture, shape (height, width, 3), with the words on it."""
        done = picture.copy()
        top = self._image.fromarray(done[self._top])
        shown = top.size
        top.paste(self._banner.crop((0, 0, *shown)), (0, 0), self._top_mask.crop((0, 0, *shown)))
        done[self._top] = np.asarray(top)
        panel = self._image.fromarray(done[self._area])
        panel.paste(WHITE[:3], (0, 0), self._mask)
        draw = self._draw_on(panel)
        for (x, label), value in zip(COLUMNS, (*readings(frame), "1 m"), strict=True):
            self._write(draw, (x, 13), label, self._words, PALE)
            self._write(draw, (x, 36), value, self._numbers, INK)
        x, *entries = LEGEND
        for y, (label, colour) in zip((23, 51), entries, strict=True):
            line = [self._scaled(v) for v in (x, y - 3, x + 28, y + 3)]
            draw.rectangle(line, fill=colour)
            self._write(draw, (x + 38, y - 9), label, self._words, INK)
        done[self._area] = np.asarray(panel)
        return done

    def _write(
        self, draw: Any, at: tuple[int, int], text: str, font: Any, colour: tuple[int, ...]
    ) -> None:
        draw.text((self._scaled(at[0]), self._scaled(at[1])), text, font=font, fill=colour)

    def _font(self, name: str, size: int) -> Any:
        """A font that comes with Matplotlib, so that every machine has it."""
        import matplotlib as mpl
        from PIL import ImageFont

        path = Path(mpl.get_data_path()) / "fonts" / "ttf" / f"{name}.ttf"
        return ImageFont.truetype(str(path), max(self._scaled(size), 6))

    def _scaled(self, length: float) -> int:
        return round(length * self._scale)


def wrapped(text: str, fits: Callable[[str], bool]) -> list[str]:
    """A text in lines that fit, broken between words; a word that fits nowhere has a line of its own."""
    lines: list[str] = []
    for word in text.split():
        longer = f"{lines[-1]} {word}" if lines else word
        if lines and fits(longer):
            lines[-1] = longer
        else:
            lines.append(word)
    return lines


def readings(frame: Frame) -> tuple[str, str, str]:
    """Time, speed and cross-track error (left is positive) with their units."""
    error = round(1e3 * frame.cross_track_error, 3) + 0.0  # no minus sign before nothing
    return f"{frame.time:.2f} s", f"{frame.speed:.2f} m/s", f"{error:+.3f} mm".replace("-", "−")
