"""JSON, YAML and recordings: the same path in every form, strictly read, bounded, cut messages named."""

import json

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from osculate import InvalidInput, read_curve
from osculate.curve.files import read_file

X = np.round(np.linspace(0.0, 12.0, 25), 4)
WAVE = np.stack([X, np.round(0.8 * np.sin(2 * np.pi * X / 6), 4)], axis=1)
PAIRS = WAVE.tolist()
HEAD = {"stamp": {"sec": 1, "nanosec": 0}, "frame_id": "map"}
TURNED = {"x": 0.0, "y": 0.0, "z": 0.6, "w": 0.8}
POSES = [{"position": {"x": x, "y": y, "z": 0.0}, "orientation": TURNED} for x, y in PAIRS]
STAMPED = [{"header": HEAD, "pose": pose} for pose in POSES]
TWIST = {
    "twist": {"linear": {"x": 0.5, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": 0.1}}
}
ODOMETRY = [
    {"header": HEAD, "child_frame_id": "base", "pose": {"pose": pose, "covariance": [0.0] * 36},
     "twist": {**TWIST, "covariance": [0.0] * 36}}
    for pose in POSES
]  # fmt: skip
ONE = {
    "pairs": PAIRS,
    "triples": [[x, y, 0.0] for x, y in PAIRS],
    "mappings": [{"x": x, "y": y} for x, y in PAIRS],
    "more keys": [{"id": n, "y": y, "x": x, "speed": 1.0} for n, (x, y) in enumerate(PAIRS)],
    "units": [{"x_mm": 1e3 * x, "y_mm": 1e3 * y} for x, y in PAIRS],
    "waypoints": {"waypoints": [{"x": x, "y": y} for x, y in PAIRS]},
    "points": {"name": "a", "points": PAIRS},
    "nested": {"route": {"frame": "map", "points": PAIRS}},
    "unknown key": {"my_line": PAIRS},
    "named": {f"wp{n}": {"x": x, "y": y} for n, (x, y) in enumerate(PAIRS)},
    "position lists": {"waypoints": [{"position": [x, y, 0.0]} for x, y in PAIRS]},
    "columns": {"X": WAVE[:, 0].tolist(), "Y": WAVE[:, 1].tolist(), "X_i": [1.0, 2.0], "n": 25},
    "Path": {"header": HEAD, "poses": STAMPED},
    "PoseArray": {"header": HEAD, "poses": POSES},
    "transforms": {
        "transforms": [
            {"child_frame_id": "base", "transform": {"translation": p["position"], "rotation": TURNED}}
            for p in POSES
        ]
    },
    "stamped": STAMPED,
    "empty and full": [{"header": HEAD, "poses": []}, {"header": HEAD, "poses": STAMPED}],
    "states": [{"agvPosition": {"x": x, "y": y, "theta": 0.1, "mapId": "m"}} for x, y in PAIRS],
}  # fmt: skip
MANY = {"PoseStamped": STAMPED, "Odometry": ODOMETRY, "poses": POSES, "points": ONE["mappings"]}


class Plain(yaml.CSafeDumper):
    """Without anchors."""

    def ignore_aliases(self, data):
        return True


def dumped(data, flow=False):
    return yaml.dump(data, Dumper=Plain, default_flow_style=flow, sort_keys=False)


def put(folder, name, text):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


@given(st.data())
def test_a_path_is_the_same_in_every_form(tmp_path_factory, data):
    folder = tmp_path_factory.mktemp("documents")
    if data.draw(st.booleans()):
        one = ONE[data.draw(st.sampled_from(sorted(ONE)))]
        texts = {
            ".json": json.dumps(one, indent=data.draw(st.sampled_from([None, 2]))),
            ".yaml": dumped(one, data.draw(st.sampled_from([None, False, True]))),
        }
    else:
        many = MANY[data.draw(st.sampled_from(sorted(MANY)))]
        texts = {
            ".json": "\n".join(map(json.dumps, many)),
            ".yaml": "---\n".join(map(dumped, many)) + data.draw(st.sampled_from(["", "---\n"])),
        }
    suffix = data.draw(st.sampled_from(sorted(texts)))
    name = suffix if suffix == ".yaml" or data.draw(st.booleans()) else ".txt"
    assert read_file(put(folder, f"path{name}", texts[suffix])).points == pytest.approx(
        WAVE, abs=1e-9
    )


@pytest.mark.parametrize("form", ["PoseStamped", "Odometry", "points"])
def test_a_dump_is_known_by_its_content(tmp_path, form):
    text = "---\n".join(map(dumped, MANY[form]))
    assert read_file(put(tmp_path, "echo.log", text)).points == pytest.approx(WAVE)


def test_what_was_understood_is_said(tmp_path):
    rows = dict(
        read_file(put(tmp_path, "odometry.yaml", "---\n".join(map(dumped, ODOMETRY)))).rows()
    )
    assert rows["message"] == "nav_msgs/Odometry"
    assert rows["fields"] == "pose.pose.position.x, pose.pose.position.y"
    assert rows["points"] == "25"
    assert rows["ends"].startswith("open: its ends are 12 m apart")
    reading = read_file(put(tmp_path, "odometry.json", json.dumps(ODOMETRY)))
    assert reading.speeds == pytest.approx(np.full(25, 0.5))


def test_of_several_paths_the_last_is_taken_and_said(tmp_path):
    short = {"header": HEAD, "poses": STAMPED[:9]}
    text = "---\n".join(map(dumped, [short, ONE["Path"]]))
    with pytest.warns(
        UserWarning, match=r"2 messages hold poses; the last one is read \(25 points\)"
    ):
        assert len(read_file(put(tmp_path, "plans.yaml", text)).points) == 25
    two = {"left": PAIRS, "right": PAIRS[::-1]}
    path = put(tmp_path, "two.json", json.dumps(two))
    with pytest.raises(InvalidInput, match="several lists of points: left, right; say --take"):
        read_curve(path)
    assert read_file(path, take="right").points == pytest.approx(WAVE[::-1])
    with pytest.raises(InvalidInput, match="no list 'middle'; it has left, right"):
        read_file(path, take="middle")
    with pytest.warns(UserWarning, match="path is read; obstacle are there too"):
        read_curve(put(tmp_path, "t.json", json.dumps({"obstacle": PAIRS[:5], "path": PAIRS})))
    frames = [{"transforms": [{"child_frame_id": f, "transform": {"translation": p["position"]}}]}
              for p in POSES for f in ("base", "laser")]  # fmt: skip
    path = put(tmp_path, "tf.yaml", "---\n".join(map(dumped, frames)))
    with pytest.raises(InvalidInput, match="the frames base, laser; say --take"):
        read_curve(path)
    assert len(read_file(path, take="laser").points) == 25


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("poses:\n- pose: {position: {x: 0, y: 0}}\n- '...'\n", "was cut.*--full-length"),
        ("x: [0.0, 1.0, '...']\ny: [0.0, 1.0, '...']\n", "point 2.*--full-length"),
        ("poses: []\n", "the list poses in it is empty"),
        ("- {x: 0, y: 0}\n- {x: 1}\n", "point 1.*has no y"),
        ("x: 0\ny: 0\n---\nx: 1\ny: 1\n---\nx: 2\n", "message 2.*no position"),
        ("- {x: 0, y: 010}\n- {x: 1, y: 1}\n", "point 0.*'010'.*octal"),
        ("- {x: 0, y: 1:30}\n- {x: 1, y: 1}\n", "point 0.*'1:30'.*minutes"),
        ("- {x: 0, y: true}\n- {x: 1, y: 1}\n", "point 0.*'true', no number"),
        ("- {x: 0, y: 0x1F}\n- {x: 1, y: 1}\n", "point 0.*no number"),
        ("- {x: 0, y: 1_0}\n- {x: 1, y: 1}\n", "point 0.*no number"),
        ("- {x: 0, y: .nan}\n- {x: 1, y: 1}\n", "point 0.*must be finite"),
        ("- {x: 0, y: 1e999}\n- {x: 1, y: 1}\n", "point 0.*must be finite"),
        ("- {x: 0, y: '1.0'}\n- {x: 1, y: 1}\n", "point 0"),
        ("- {x: 0, y: 0, x: 5}\n- {x: 1, y: 1}\n", "line 1.*'x' is there twice"),
        ("a: &a {x: 0}\nb: {<<: *a, y: 1}\n", "merged mappings"),
        ("- [0, 0]\n- [1, 1\n", "is not valid YAML"),
        ("- [0, 0]\n- [1, 1, 5]\n", "point 1.*has 3 numbers, point 0 has 2"),
        ("x: [0, 1, 2]\ny: [0, 1]\n", "3 x and 2 y"),
        ("- [0, 1, 2, 3, 4]\n- [0, 1, 0, 1, 0]\n", "two lists of 5 numbers"),
        ("image: map.pgm\nresolution: 0.05\n", "the keys image, resolution"),
        ("just text", "no points"),
        ("a: &a [*a]\n", "no finished anchor"),
        ("[" * 5000, "nested more than"),
        ("- " * 3000 + "1\n", "nested more than"),
        ("", "empty YAML"),
    ],
)  # fmt: skip
def test_documents_are_read_strictly(tmp_path, text, message):
    with pytest.raises(InvalidInput, match=message):
        read_curve(put(tmp_path, "a.yaml", text))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('[{"x": true, "y": 0}, {"x": 1, "y": 1}]', "point 0.*truth value"),
        ('[{"x": null, "y": 0}, {"x": 1, "y": 1}]', "point 0.*empty"),
        ('[{"x": "1", "y": 0}, {"x": 1, "y": 1}]', "point 0.*the text '1'.*without quotes"),
        ('[{"x": NaN, "y": 0}, {"x": 1, "y": 1}]', "must be finite"),
        ('[{"x": 1, "y": 0, "x": 2}, {"x": 1, "y": 1}]', "'x' is there twice"),
        ('[[0, 0], [1, 1]', "line 1.*not valid JSON"),
        ('[[0, 0], ["1", 1]]', "point 1"),
        ('[[0, 0], {"x": 1, "y": 1}]', "point 1.*has no numbers"),
        ("[" * 100_000, "nested more than"),
        ('{"a":' * 60 + "1" + "}" * 60, "nested more than"),
        (f"[[{'9' * 5000}, 0], [1, 1]]", "not valid JSON"),
        ("{}", "no points"),
        ("3", "no points"),
    ],
)  # fmt: skip
def test_json_is_read_strictly(tmp_path, text, message):
    with pytest.raises(InvalidInput, match=message):
        read_curve(put(tmp_path, "a.json", text))


def test_aliases_are_shared_but_bounded(tmp_path):
    text = "head: &h {frame: map}\nposes:\n" + "".join(
        f"- {{header: *h, pose: {{position: {{x: {x}, y: {y}}}}}}}\n" for x, y in PAIRS
    )
    assert read_file(put(tmp_path, "a.yaml", text)).points == pytest.approx(WAVE)
    bomb = "a0: &a0 [0, 1]\n" + "".join(
        f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]\n" for n in range(1, 12)
    )
    with pytest.raises(InvalidInput, match="aliases written out"):
        read_curve(put(tmp_path, "bomb.yaml", bomb))


def test_progress_of_a_long_file_is_told(tmp_path):
    told = []
    text = "points:\n" + "".join(f"- [{0.01 * n}, {(n % 7) * 0.001}]\n" for n in range(30_000))
    read_file(put(tmp_path, "long.yaml", text), on_progress=told.append)
    assert told == sorted(told)
    assert told[-1] == 1.0
    assert len(told) > 5
