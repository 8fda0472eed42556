"""VDA 5050 orders and LIF layouts: all edges in their order, straight ones too, the norm's defaults."""

import copy
import json
import math
import random
import warnings

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzing.files import mutated, survives
from osculate import InvalidInput, Nurbs, Spline, read_curve
from osculate.curve.files import read_file

BEND = {  # from (4, 0) along x to (6, 2) along y, without curvature at its ends
    "degree": 5, "knotVector": [0.0] * 6 + [1.0] * 6,
    "controlPoints": [{"x": x, "y": y} for x, y in
                      [(4, 0), (4.6, 0), (5.2, 0), (6, 0.8), (6, 1.4), (6, 2)]],
}  # fmt: skip
PLACES = {"n0": (0, 0), "n1": (4, 0), "n2": (6, 2), "n3": (6, 5)}


def straight(a, b):
    return {
        "degree": 3, "knotVector": [0, 0, 0, 0, 1, 1, 1, 1],
        "controlPoints": [
            {"x": a[0] + t / 3 * (b[0] - a[0]), "y": a[1] + t / 3 * (b[1] - a[1])} for t in range(4)
        ],
    }  # fmt: skip


def order():
    nodes = [
        {"nodeId": n, "sequenceId": 2 * k, "released": True, "nodePosition": {"x": x, "y": y, "mapId": "h"}}
        for k, (n, (x, y)) in enumerate(PLACES.items())
    ]  # fmt: skip
    ways = [straight(PLACES["n0"], PLACES["n1"]), BEND, straight(PLACES["n2"], PLACES["n3"])]
    edges = [
        {"edgeId": f"e{n}", "sequenceId": 2 * n + 1, "released": True, "startNodeId": f"n{n}",
         "endNodeId": f"n{n + 1}", "trajectory": copy.deepcopy(way)}
        for n, way in enumerate(ways)
    ]  # fmt: skip
    return {"orderId": "o", "nodes": nodes, "edges": edges}


def put(folder, data, name="order.json"):
    path = folder / name
    path.write_text(json.dumps(data), encoding="utf-8")
    return path


WHOLE = 7.0 + Nurbs(
    degree=5, knots=(0,) * 6 + (1,) * 6, points=tuple((c["x"], c["y"]) for c in BEND["controlPoints"])
).length  # fmt: skip


@given(
    places=st.permutations(range(3)),
    bare=st.sets(st.sampled_from([0, 2])),
    scale=st.sampled_from([1.0, 0.5, 1e-3]),
    wrapped=st.booleans(),
)
def test_an_order_is_driven_edge_by_edge_at_any_scale(
    tmp_path_factory, places, bare, scale, wrapped
):
    data = order()
    for n in bare:  # an edge without a trajectory is straight
        del data["edges"][n]["trajectory"]
    data["edges"] = [data["edges"][n] for n in places]
    path = put(tmp_path_factory.mktemp("vda"), {"payload": data} if wrapped else data)
    curve = read_curve(path, scale)
    assert curve.length == pytest.approx(scale * WHOLE, rel=1e-9)
    ends = curve.at(np.array([0.0, curve.length]))
    assert ends.x == pytest.approx([0.0, scale * 6.0], abs=1e-12)
    assert ends.y == pytest.approx([0.0, scale * 5.0], abs=1e-12)
    middle = curve.at(scale * 4.0)
    assert (middle.x, middle.y) == (pytest.approx(scale * 4.0), pytest.approx(0.0, abs=1e-12))


def test_the_norms_defaults(tmp_path):
    control = [{"x": x, "y": y} for x, y in [(0, 0), (1, 0), (2, 0), (3, 0.5), (3, 1.5), (3, 2.5)]]
    curve = read_curve(put(tmp_path, {"degree": 3.0, "controlPoints": control}))
    assert curve.knots == pytest.approx((0, 0, 0, 0, 1 / 3, 2 / 3, 1, 1, 1, 1))
    assert curve.length == pytest.approx(4.9023, abs=1e-4)
    line = read_curve(put(tmp_path, {"controlPoints": [{"x": 0, "y": 0}, {"x": 3, "y": 4}]}))
    assert (line.degree, line.length) == (1, pytest.approx(5.0))


def test_an_order_of_nodes_only_is_a_curve_through_them(tmp_path):
    data = order()
    for edge in data["edges"]:
        del edge["trajectory"]
    with pytest.warns(UserWarning, match="no trajectories; the curve goes through the 4 nodes"):
        curve = read_curve(put(tmp_path, data), scale=2.0)
    assert curve == Spline(points=tuple((2.0 * x, 2.0 * y) for x, y in PLACES.values()))
    data["edges"] = data["edges"][:1]
    assert read_curve(put(tmp_path, data)).length == pytest.approx(4.0)


def moved(edge, dx=0.0, dy=0.0):
    for point in edge["trajectory"]["controlPoints"]:
        point["x"] += dx
        point["y"] += dy


def test_gaps_and_ends_beside_nodes_are_named(tmp_path):
    data = order()
    moved(data["edges"][2], dx=0.3)
    with pytest.raises(
        InvalidInput, match=r"gap of 0\.3 m between edge e1 and edge e2 at s = 7\.221 m"
    ):
        read_curve(put(tmp_path, data))
    data = order()
    data["nodes"][1]["nodePosition"]["y"] = 0.25
    with pytest.warns(UserWarning, match="beside node n1") as said:
        read_curve(put(tmp_path, data))
    words = " ".join(str(w.message) for w in said)
    assert "edge e0 ends 0.25 m beside node n1" in words
    assert "edge e1 begins 0.25 m beside node n1" in words
    data = order()
    data["edges"][1]["trajectory"] = straight((4, 0), (6, 2))
    path = put(tmp_path, data)
    with pytest.raises(InvalidInput, match="heading jumps by 45° between edge e0 and edge e1"):
        read_curve(path)
    for scale in (1.0, 0.5):
        rounded = read_curve(path, scale, tolerance=0.05).length
        assert rounded == pytest.approx(scale * (7 + math.sqrt(8)), abs=0.15)


def change(**fields):
    def apply(data):
        data["edges"][1].update(fields)

    return apply


def trajectory(**fields):
    def apply(data):
        data["edges"][1]["trajectory"].update(fields)

    return apply


def without_position(data):
    del data["edges"][0]["trajectory"]
    del data["nodes"][1]["nodePosition"]


def wrong_control(data):
    data["edges"][1]["trajectory"]["controlPoints"][2]["y"] = True


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        (trajectory(degree=2.7), "degree is 2.7, must be a whole number"),
        (trajectory(degree=True), "its degree is a truth value"),
        (trajectory(degree="3"), "its degree is the text '3'"),
        (trajectory(knotVector=[0, "1"]), "knot 1 is the text '1'"),
        (lambda data: data.update(edgeStates=[]), "state of a vehicle"),
        (trajectory(degree=0), "must be from 1 to 5"),
        (trajectory(degree=6), "must be from 1 to 5"),
        (trajectory(knotVector=[0, 1]), "must be 12 numbers"),
        (trajectory(knotVector="0 1"), "must be a list"),
        (trajectory(controlPoints=[{"x": 0, "y": 0}]), "at least two controlPoints"),
        (trajectory(controlPoints=[{"x": 0}, {"x": 0, "y": 1}]), "control point 0 needs x and y"),
        (wrong_control, "y of control point 2 is a truth value"),
        (change(startNodeId="n3"), "edge e0 ends at node n1, edge e1 starts at node n3"),
        (change(sequenceId=1), "same sequenceId"),
        (change(sequenceId="two"), "edge 1.*its sequenceId"),
        (change(trajectory=[1]), "edge e1.*must be a mapping"),
        (without_position, "node 'n1'.*has no nodePosition"),
        (lambda data: data.update(edges=[]), "no edges"),
    ],
)  # fmt: skip
def test_what_the_norm_does_not_allow_is_named(tmp_path, fault, message):
    data = order()
    fault(data)
    with pytest.raises(InvalidInput, match=message):
        read_curve(put(tmp_path, data))


@given(
    speeds=st.lists(st.none() | st.floats(0.1, 3.0), min_size=3, max_size=3),
    turns=st.lists(st.none() | st.floats(-3.2, 3.2), min_size=3, max_size=3),
)
def test_what_edges_ask_for_and_is_not_done_is_said(tmp_path_factory, speeds, turns):
    data = order()
    for edge, speed, turn in zip(data["edges"], speeds, turns, strict=True):
        asked = {"maxSpeed": speed, "orientation": turn}
        edge.update({key: value for key, value in asked.items() if value is not None})
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        read_curve(put(tmp_path_factory.mktemp("order"), data))
    words = " ".join(str(w.message) for w in said)
    slow = [speed for speed in speeds if speed is not None]
    assert (f"maxSpeed (least {min(slow):g} m/s)" in words) if slow else ("maxSpeed" not in words)
    backwards = sum(turn is not None and abs(turn) > 0.1 for turn in turns)
    assert words.count("it is driven forwards") == backwards


def test_the_horizon_is_said(tmp_path):
    data = order()
    data["edges"][2]["released"] = False
    with pytest.warns(UserWarning, match="1 of 3 edges are not released"):
        assert read_curve(put(tmp_path, data)).length == pytest.approx(WHOLE)


def test_damaged_orders_and_layouts_are_refused_in_words(tmp_path):
    trees = [order(), layout(), BEND]
    read = sum(
        survives(put(tmp_path, mutated(random.Random(seed), trees[seed % 3])))
        for seed in range(300)
    )
    assert 20 < read < 280


def layout(kinds=("small", "big"), extra=()):
    edges = [
        {"edgeId": e["edgeId"], "startNodeId": e["startNodeId"], "endNodeId": e["endNodeId"],
         "vehicleTypeEdgeProperties": [
             {"vehicleTypeId": kind, **({"trajectory": e["trajectory"]} if kind == "small" else {})}
             for kind in kinds]}
        for e in order()["edges"]
    ]  # fmt: skip
    nodes = [{"nodeId": n, "nodePosition": {"x": x, "y": y}} for n, (x, y) in PLACES.items()]
    return {"layouts": [{"layoutId": "l", "nodes": nodes, "edges": [*edges[::-1], *extra]}]}


def test_a_layout_is_read_for_one_vehicle_type(tmp_path):
    path = put(tmp_path, layout())
    with pytest.warns(
        UserWarning, match=r"vehicle type small is read; big are there too \(--take TYPE\)"
    ):
        assert read_curve(path).length == pytest.approx(WHOLE)
    assert read_file(path, take="small").curve.length == pytest.approx(WHOLE)
    with pytest.warns(UserWarning, match="through the 4 nodes"):
        read_file(path, take="big")
    with pytest.raises(InvalidInput, match="no vehicle type 'huge'; it has big, small"):
        read_file(path, take="huge")
    back = {"edgeId": "back", "startNodeId": "n1", "endNodeId": "n0"}
    with pytest.raises(InvalidInput, match="a network of 4 edges"):
        read_curve(put(tmp_path, layout(("small",), [back])))
    two = layout()
    two["layouts"].append({"layoutId": "m", "nodes": [], "edges": []})
    with pytest.raises(InvalidInput, match="the layouts l, m"):
        read_curve(put(tmp_path, two))
