"""Initial runs and parameters of a batch, block by block, and the numbers that vary by name."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from osculate.errors import InvalidInput
from osculate.kernel import Grid, names
from osculate.simulation.blocks import Block, single_block
from osculate.simulation.loop import Loop

LANES = 64  # runs side by side in one block
SAME = {"events.settled": "settled"}  # what two kernels read is one quantity


def places_of(loop: Loop) -> dict[str, list[tuple[int, int]]]:
    """Name of a number to where a `Block` holds it: which of its arrays, and the row."""
    places: dict[str, list[tuple[int, int]]] = {}
    for array, value in ((1, loop.parameters), (3, loop.thought)):
        here = set(names(value))
        for row, name in enumerate(names(value)):
            if name.rpartition(".")[2] != "zero" and not _of_table(name, here):
                places.setdefault(SAME.get(name, name), []).append((array, row))
    for row, name in enumerate(names(loop.initial.state)):
        places[f"initial.{name}"] = [(0, row)]
    if not loop.sampled:
        del places["delay"]
    return places


def _of_table(name: str, known: set[str]) -> bool:
    """Whether a number says where a table lies, which is no quantity of the robot."""
    owner, _, field = name.rpartition(".")
    return field in Grid._fields and {f"{owner}.{other}" for other in Grid._fields} <= known


class Columns:
    """The initial runs and parameters of any block, without holding all of them."""

    def __init__(
        self, loops: list[Loop], varied: Mapping[str, NDArray[np.float64]], count: int
    ) -> None:
        self.count, self.loops = count, loops
        self.places = places_of(loops[0])
        for name in varied:
            if name not in self.places:
                raise InvalidInput(
                    f"vary[{name!r}]", name, f"unknown; valid: {', '.join(sorted(self.places))}"
                )
        self.varied = {n: np.broadcast_to(v, (count,)) for n, v in varied.items()}
        for name, values in varied.items():
            _require_numbers(loops[0], name, values)

    def loop(self, run: int) -> Loop:
        """The closed loop of a run."""
        return self.loops[run if len(self.loops) > 1 else 0]

    def block(self, start: int) -> Block:
        """The runs of the lanes from run ``start``; the last one is repeated."""
        index = np.minimum(np.arange(start, start + LANES), self.count - 1)
        if len(self.loops) == 1:
            block = Block(*(np.repeat(a, LANES, axis=1) for a in single_block(self.loops[0])))
        else:
            columns = [single_block(self.loops[i]) for i in index]
            block = Block(*(np.hstack(parts) for parts in zip(*columns, strict=True)))
        for name, values in self.varied.items():
            for array, row in self.places[name]:
                block[array][row] = values[index]
        return block


def _require_numbers(loop: Loop, name: str, values: NDArray[np.float64]) -> None:
    """Refuse what is no number, and a delay of more commands than are on their way."""
    field = f"vary[{name!r}]"
    if np.isnan(values).any():
        raise InvalidInput(field, float("nan"), f"must be numbers; run {np.isnan(values).argmax()}")
    if name == "delay":
        most = (len(loop.initial.held.commands) - 1) * loop.setup.clock.substeps
        wrong = (values < 0.0) | (values > most)
        if wrong.any():
            message = f"must be from 0 to {most} steps; a longer clock.delay keeps more commands"
            raise InvalidInput(field, float(np.atleast_1d(values)[wrong.argmax()]), message)
