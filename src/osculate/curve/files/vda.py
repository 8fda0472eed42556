"""VDA 5050 orders and bare trajectories, LIF layouts: edges in their order, straight or NURBS.

Defaults are the norm's: degree 1, knots uniform and clamped, weights 1; an edge without a trajectory
is the straight line between its nodes. Sources: VDA 5050 2.1 and 3.0, LIF 1.0.
"""

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from osculate.curve.files.found import Found, Wishes, refuse
from osculate.curve.files.network import chained, mappings, trajectory_of
from osculate.curve.files.numbers import number
from osculate.curve.files.pieces import Piece, joined
from osculate.curve.files.trajectory import nurbs
from osculate.curve.segments import Line

ALONG = 0.1  # rad, an orientation against the edge that still is forwards
BESIDE = 0.01  # m, an edge that ends further from its node is named
Node = Mapping[str, Any]


class Edge(NamedTuple):
    """An edge in the order of driving."""

    name: str
    start: str  # nodeId
    end: str
    trajectory: Mapping[str, Any] | None


def find_vda(documents: Sequence[Any]) -> list[Mapping[str, Any]]:
    """The orders, layouts or trajectories in the documents, outermost first."""
    return [found for document in documents for found in _find(document)]


def _find(node: Any) -> Iterator[Mapping[str, Any]]:
    if isinstance(node, Mapping):
        if isinstance(node.get("layouts"), list) or "controlPoints" in node or "edgeStates" in node:
            yield node
            return
        edges = node.get("edges")
        if isinstance(edges, list) and (
            isinstance(node.get("nodes"), list) or _has_trajectory(edges)
        ):
            yield node
            return
        node = list(node.values())
    if isinstance(node, list):
        for item in node:
            if isinstance(item, (Mapping, list)):
                yield from _find(item)


def _has_trajectory(edges: list[Any]) -> bool:
    return any(isinstance(edge, Mapping) and edge.get("trajectory") for edge in edges)


def read_vda(found: Sequence[Mapping[str, Any]], label: str, wishes: Wishes) -> Found:
    """The curve of an order, a layout or a trajectory.

    Raises:
        InvalidInput: Something that the norm does not allow, a gap between edges, a corner (says between
            which edges and how large).
    """
    warnings: tuple[str, ...] = ()
    if len(found) > 1 and any(item != found[-1] for item in found):
        warnings = (f"{len(found)} orders or trajectories are there; the last one is read",)
    item = found[-1]
    if "edgeStates" in item:
        raise refuse(
            label, "is a VDA 5050 state of a vehicle; the path is in the order that it drives"
        )
    if "controlPoints" in item:
        curve = nurbs(item, label, wishes.scale)
        shape = f"NURBS of degree {curve.degree} with {len(curve.points)} control points"
        rows = (("trajectory", shape),)
        return Found("VDA 5050 trajectory", None, curve, rows, warnings=warnings)
    if "layouts" in item:
        edges, nodes, more = chained(item["layouts"], label, wishes)
        kind, made = "LIF layout", [Edge(*edge) for edge in edges]
    else:
        made, nodes, more = _order(item, label)
        kind = "VDA 5050 order"
    return _driven(kind, made, nodes, label, wishes, (*warnings, *more))


def _order(
    order: Mapping[str, Any], label: str
) -> tuple[list[Edge], dict[str, Node], tuple[str, ...]]:
    """Edges by sequenceId and nodes by nodeId."""
    edges = order["edges"]
    if not edges or not all(isinstance(edge, Mapping) for edge in edges):
        raise refuse(label, "the order has no edges; a path needs one at least")
    warnings = []
    numbers = [_sequence(edge, n, label) for n, edge in enumerate(edges)]
    known = [value for value in numbers if value is not None]
    if len(known) == len(edges):
        if len(set(known)) < len(known):
            raise refuse(label, "two edges have the same sequenceId")
        edges = [edges[n] for n in sorted(range(len(edges)), key=known.__getitem__)]
    elif len(edges) > 1:
        warnings.append("not every edge has a sequenceId; the order of the file is taken")
    horizon = sum(str(edge.get("released", True)).lower() == "false" for edge in edges)
    if horizon:
        warnings.append(f"{horizon} of {len(edges)} edges are not released yet (the horizon)")
    warnings += _unused(edges)
    nodes = {str(node.get("nodeId")): node for node in mappings(order.get("nodes"))}
    made = [
        Edge(
            str(edge.get("edgeId", f"number {n}")), str(edge.get("startNodeId", "")),
            str(edge.get("endNodeId", "")), trajectory_of(edge, label),
        )
        for n, edge in enumerate(edges)
    ]  # fmt: skip
    return made, nodes, tuple(warnings)


def _unused(edges: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """What the edges ask for and a curve cannot hold: speeds, and driving backwards or aside."""
    slow = [edge["maxSpeed"] for edge in edges if isinstance(edge.get("maxSpeed"), (int, float))]
    if slow:
        yield f"maxSpeed (least {min(slow):g} m/s) is in the edges and not used; give it as the speed limit"
    for edge in edges:
        turned = edge.get("orientation")
        tangential = str(edge.get("orientationType", "TANGENTIAL")).upper() == "TANGENTIAL"
        if tangential and isinstance(turned, (int, float)) and abs(turned) > ALONG:
            yield (
                f"edge {edge.get('edgeId', '?')} is to be driven with the robot turned by "
                f"{np.degrees(turned):.4g}°; it is driven forwards"
            )


def _sequence(edge: Mapping[str, Any], n: int, label: str) -> float | None:
    if edge.get("sequenceId") is None:
        return None
    try:
        return number(edge["sequenceId"])
    except ValueError as error:
        raise refuse(label, f"its sequenceId {error}", f"edge {n}") from None


def _driven(
    kind: str, edges: Sequence[Edge], nodes: Mapping[str, Node], label: str, wishes: Wishes,
    warnings: tuple[str, ...],
) -> Found:  # fmt: skip
    """The curve along the edges."""
    for before, after in pairwise(edges):
        if before.end and after.start and before.end != after.start:
            raise refuse(
                label, f"edge {before.name} ends at node {before.end}, edge {after.name} starts at node "
                f"{after.start}",
            )  # fmt: skip
    straight = [edge.trajectory is None for edge in edges]
    names = ", ".join(edge.name for edge in edges[:8]) + (" …" if len(edges) > 8 else "")
    rows = (
        ("edges", f"{len(edges)}: {names}"),
        ("trajectories", f"{len(edges) - sum(straight)} NURBS, {sum(straight)} straight"),
    )
    if all(straight) and len(edges) > 1:
        way = [edges[0].start, *(edge.end for edge in edges)]
        through = np.array([place(name, nodes, label) for name in way])
        said = f"the edges have no trajectories; the curve goes through the {len(way)} nodes"
        return Found(kind, through, None, rows, place="node", warnings=(*warnings, said))
    pieces, more = [], []
    for edge in edges:
        piece = _piece(edge, nodes, label, wishes.scale)
        if piece is None:
            more.append(f"edge {edge.name} has no length and is left out")
            continue
        more += _beside(edge, piece, nodes, label, wishes.scale)
        pieces.append(piece)
    if not pieces:
        raise refuse(label, "no edge has a length")
    points, curve = joined(pieces, label, wishes)
    return Found(kind, points, curve, rows, warnings=(*warnings, *more))


def _piece(edge: Edge, nodes: Mapping[str, Node], label: str, scale: float) -> Piece | None:
    name = f"edge {edge.name}"
    if edge.trajectory is not None:
        return Piece(name, nurbs(edge.trajectory, f"{label}, {name}", scale))
    a, b = (place(node, nodes, label) for node in (edge.start, edge.end))
    if a == b:
        return None
    ends = [(scale * x, scale * y) for x, y in (a, b)]
    return Piece(name, Line.between(ends[0], ends[1]))


def _beside(
    edge: Edge, piece: Piece, nodes: Mapping[str, Node], label: str, scale: float
) -> Iterator[str]:
    """What is said where an edge does not begin or end at its node."""
    for node, (x, y), word in (
        (edge.start, piece.start, "begins"), (edge.end, piece.end, "ends"),
    ):  # fmt: skip
        if isinstance(nodes.get(node, {}).get("nodePosition"), Mapping):
            there = place(node, nodes, label)
            distance = ((x - scale * there[0]) ** 2 + (y - scale * there[1]) ** 2) ** 0.5
            if distance > BESIDE:
                yield f"edge {edge.name} {word} {distance:.3g} m beside node {node}"


def place(node: str, nodes: Mapping[str, Node], label: str) -> tuple[float, float]:
    """Position of a node (m).

    Raises:
        InvalidInput: No such node, or without a position.
    """
    position = nodes.get(node, {}).get("nodePosition")
    if not isinstance(position, Mapping):
        what = "has no nodePosition" if node in nodes else "is not among the nodes"
        raise refuse(label, f"{what}; an edge without a trajectory needs it", f"node {node!r}")
    try:
        return number(position["x"]), number(position["y"])
    except KeyError as error:
        raise refuse(label, f"its position has no {error}", f"node {node!r}") from None
    except ValueError as error:
        raise refuse(label, f"its position {error}", f"node {node!r}") from None
