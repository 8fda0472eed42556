"""LIF layouts: networks of nodes and edges, of which one way can be driven."""

from collections.abc import Mapping, Sequence
from typing import Any

from osculate.curve.files.found import Wishes, refuse

Made = tuple[str, str, str, Mapping[str, Any] | None]


def mappings(value: Any) -> list[Mapping[str, Any]]:
    """The mappings in a list; nothing of what is no list."""
    return [item for item in value if isinstance(item, Mapping)] if isinstance(value, list) else []


def trajectory_of(edge: Mapping[str, Any], label: str) -> Mapping[str, Any] | None:
    """The trajectory of an edge, or None if it is straight.

    Raises:
        InvalidInput: It is something else than a mapping.
    """
    trajectory = edge.get("trajectory")
    if trajectory is not None and not isinstance(trajectory, Mapping):
        raise refuse(label, "its trajectory must be a mapping", f"edge {edge.get('edgeId', '?')}")
    return trajectory or None


def chained(
    layouts: Any, label: str, wishes: Wishes
) -> tuple[list[Made], dict[str, Mapping[str, Any]], tuple[str, ...]]:
    """The edges of a layout one after the other, its nodes, and what the user should know.

    Raises:
        InvalidInput: Several layouts, or a network in which there is more than one way.
    """
    layouts = mappings(layouts)
    named = [item for item in layouts if str(item.get("layoutId")) == wishes.take]
    if len(layouts) > 1 and not named:
        ids = ", ".join(str(item.get("layoutId")) for item in layouts)
        raise refuse(label, f"holds the layouts {ids}; say --take LAYOUT")
    layout = (named or layouts or [{}])[0]
    edges = mappings(layout.get("edges"))
    if not edges:
        raise refuse(label, "the layout has no edges; a path needs one at least")
    ordered = _way(edges, label)
    take = "" if named else wishes.take
    types = sorted({kind for edge in ordered for kind in _types(edge)})
    if take and take not in types:
        raise refuse(label, f"has no vehicle type {take!r}; it has {', '.join(types)}")
    chosen = take or next((kind for edge in ordered for kind in _types(edge)), "")
    warnings: tuple[str, ...] = ()
    if len(types) > 1 and not take:
        others = ", ".join(kind for kind in types if kind != chosen)
        warnings = (f"the vehicle type {chosen} is read; {others} are there too (--take TYPE)",)
    nodes = {str(node.get("nodeId")): node for node in mappings(layout.get("nodes"))}
    return [_made(edge, chosen, label) for edge in ordered], nodes, warnings


def _types(edge: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    """Properties of an edge by vehicle type."""
    listed = mappings(edge.get("vehicleTypeEdgeProperties"))
    return {str(properties.get("vehicleTypeId")): properties for properties in listed}


def _made(edge: Mapping[str, Any], kind: str, label: str) -> Made:
    types, name = _types(edge), str(edge.get("edgeId", "?"))
    if types and kind not in types:
        raise refuse(label, f"is not for the vehicle type {kind}", f"edge {name}")
    owner = types.get(kind, edge)
    return (
        name,
        str(edge.get("startNodeId")),
        str(edge.get("endNodeId")),
        trajectory_of(owner, label),
    )


def _way(edges: Sequence[Mapping[str, Any]], label: str) -> list[Mapping[str, Any]]:
    """The edges end to start, if there is only one way to say so."""
    after = {str(edge.get("startNodeId")): edge for edge in edges}
    ends = {str(edge.get("endNodeId")) for edge in edges}
    starts = [edge for edge in edges if str(edge.get("startNodeId")) not in ends] or [edges[0]]
    if len(after) == len(edges) == len(ends) and len(starts) == 1:
        way = [starts[0]]
        while len(way) < len(edges) and str(way[-1].get("endNodeId")) in after:
            way.append(after[str(way[-1].get("endNodeId"))])
        if len({id(edge) for edge in way}) == len(edges):
            return way
    names = ", ".join(str(edge.get("edgeId", "?")) for edge in edges[:8])
    raise refuse(
        label, f"the layout is a network of {len(edges)} edges ({names}{' …' * (len(edges) > 8)}), "
        "not one way; write the way as a VDA 5050 order",
    )  # fmt: skip
