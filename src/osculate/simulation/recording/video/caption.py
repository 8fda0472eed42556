"""Words on a film: time, speed and cross-track error with their units, and what the colours mean."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from osculate.simulation.recording.video.stage import Frame

DESIGN = (1280, 720)  # pixels, of the picture that these sizes are meant for
PLACE, PANEL = (28, 612), (760, 80)  # upper left corner; width and height
COLUMNS = ((22, "time"), (152, "speed"), (296, "cross-track error"), (628, "floor squares"))
LEGEND = (506, ("curve", (236, 125, 18)), ("driven", (38, 108, 184)))
WHITE, INK, PALE = (255, 255, 255, 215), (32, 36, 42), (98, 105, 114)


class Caption:
    """A panel in the lower left corner; it is drawn once, only the numbers change."""

    def __init__(self, size: tuple[int, int]) -> None:
        from PIL import Image, ImageDraw

        self._scale = min(size[0] / DESIGN[0], size[1] / DESIGN[1])
        left, up = self._scaled(PLACE[0]), size[1] - self._scaled(DESIGN[1] - PLACE[1])
        width, height = map(self._scaled, PANEL)
        self._area = slice(up, up + height), slice(left, left + width)
        self._words, self._numbers = self._font("DejaVuSans", 14), self._font("DejaVuSans-Bold", 23)
        # four times as large for round corners without steps
        corners = Image.new("L", (4 * width, 4 * height))
        ImageDraw.Draw(corners).rounded_rectangle(
            (0, 0, 4 * width - 1, 4 * height - 1), 4 * self._scaled(12), fill=WHITE[3]
        )
        self._mask = corners.resize((width, height))
        self._draw_on = ImageDraw.Draw
        self._image = Image

    def on(self, picture: NDArray[np.uint8], frame: Frame) -> NDArray[np.uint8]:
        """A copy of a picture, shape (height, width, 3), with the panel on it."""
        done = picture.copy()
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


def readings(frame: Frame) -> tuple[str, str, str]:
    """Time, speed and cross-track error (left is positive) with their units."""
    error = round(1e3 * frame.cross_track_error, 3) + 0.0  # no minus sign before nothing
    return f"{frame.time:.2f} s", f"{frame.speed:.2f} m/s", f"{error:+.3f} mm".replace("-", "−")
