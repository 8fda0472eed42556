"""GeoJSON, GPX, KML, OpenDRIVE, MCAP; and what is no file of any kind."""

import gzip
import json
import math
import os
import random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzing.files import mutated, survives
from osculate import CurveFile, Cycloid, InvalidInput, read_curve, simulate
from osculate.curve.files import read_file

X = np.round(np.linspace(0.0, 12.0, 49), 4)
WAVE = np.stack([X, np.round(0.8 * np.sin(2 * np.pi * X / 6), 4)], axis=1)
PLACES = np.stack([11.57 + 1e-5 * WAVE[:, 0], 48.13 + 1e-5 * WAVE[:, 1]], axis=1)  # lon, lat
SIZE = 1e-5 * np.array([111_320 * math.cos(math.radians(48.13)) * 1.0019, 111_200])  # m


def put(folder, name, text):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def feature(points, kind="LineString"):
    inside = points if kind == "LineString" else [points]
    return {"type": "Feature", "properties": {}, "geometry": {"type": kind, "coordinates": inside}}


def on_globe(points):
    assert points[0] == pytest.approx([0.0, 0.0], abs=1e-9)
    assert points == pytest.approx(WAVE * SIZE, abs=0.02)


@pytest.mark.filterwarnings("ignore:.*taken as metres")
@given(
    wrap=st.sampled_from(["FeatureCollection", "Feature", "LineString", "MultiLineString"]),
    suffix=st.sampled_from([".json", ".geojson", ".txt"]),
    degrees=st.booleans(),
    height=st.booleans(),
)
@pytest.mark.core
def test_geojson_in_metres_and_in_degrees(tmp_path_factory, wrap, suffix, degrees, height):
    points = (PLACES if degrees else WAVE).tolist()
    points = [[*p, 3.0] for p in points] if height else points
    line = feature(points)
    data = {
        "FeatureCollection": {"type": "FeatureCollection", "features": [line]},
        "Feature": line,
        "LineString": line["geometry"],
        "MultiLineString": {"type": "MultiLineString", "coordinates": [points]},
    }[wrap]
    reading = read_file(put(tmp_path_factory.mktemp("geo"), "line" + suffix, json.dumps(data)))
    assert reading.format == "GeoJSON"
    if degrees:
        on_globe(reading.points)
    else:
        assert reading.points == pytest.approx(WAVE)


def test_geojson_says_what_it_takes(tmp_path):
    with pytest.warns(UserWarning, match="taken as metres"):
        read_curve(put(tmp_path, "a.json", json.dumps(feature(WAVE.tolist()))))
    utm = {**feature((WAVE + [691_000, 5_334_000]).tolist()),
           "crs": {"properties": {"name": "EPSG:25832"}}}  # fmt: skip
    with pytest.warns(UserWarning, match="metres of EPSG:25832"):
        read_curve(put(tmp_path, "a.json", json.dumps(utm)))
    square = [[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]]
    with pytest.warns(UserWarning, match="metres"):
        assert read_file(put(tmp_path, "a.json", json.dumps(feature(square, "Polygon")))).closed
    two = {"type": "FeatureCollection", "features": [feature(WAVE.tolist()), feature(square)]}
    path = put(tmp_path, "a.json", json.dumps(two))
    with pytest.raises(InvalidInput, match=r"2 lines \(GeoJSON\); say --take"):
        read_curve(path)
    with pytest.warns(UserWarning, match="metres"):
        assert len(read_file(path, take="1").points) == 49
    for bad, message in (
        ({"type": "Point", "coordinates": [1, 2]}, "no line"),
        ({"type": "LineString", "coordinates": [[1, 2], [True, 2]]}, "coordinate 1.*truth value"),
        ({"type": "LineString", "coordinates": 5}, "no list of coordinates"),
    ):
        with pytest.raises(InvalidInput, match=message):
            read_curve(put(tmp_path, "a.json", json.dumps(bad)))


def gpx(points, kind="trk"):
    inner = "".join(
        f'<{kind}pt lat="{y:.9f}" lon="{x:.9f}"><ele>5</ele></{kind}pt>' for x, y in points
    )
    inner = f"<trkseg>{inner}</trkseg>" if kind == "trk" else inner
    return f'<gpx xmlns="http://www.topografix.com/GPX/1/1"><{kind}><name>way</name>{inner}</{kind}></gpx>'


def test_gpx_and_kml(tmp_path):
    on_globe(read_file(put(tmp_path, "a.gpx", '<?xml version="1.0"?>\n' + gpx(PLACES))).points)
    on_globe(read_file(put(tmp_path, "b.xml", gpx(PLACES, "rte"))).points)
    triples = "\n".join(f"{x:.9f},{y:.9f},0" for x, y in PLACES)
    kml = f"<kml><Placemark><LineString><coordinates>{triples}</coordinates></LineString></Placemark></kml>"
    on_globe(read_file(put(tmp_path, "a.kml", kml)).points)
    two = gpx(PLACES).replace(
        "</gpx>", "<trk><name>other</name><trkseg><trkpt lat='1' lon='2'/></trkseg></trk></gpx>"
    )
    path = put(tmp_path, "two.gpx", two)
    with pytest.raises(InvalidInput, match=r"lines way, other \(GPX\); say --take"):
        read_curve(path)
    on_globe(read_file(path, take="way").points)


def road(*pieces):
    text, x, y, heading = "", 0.0, 0.0, 0.0
    for length, shape, dx, dy, turn in pieces:
        place = f'x="{x!r}" y="{y!r}" hdg="{heading!r}"'
        text += f'<geometry s="0" {place} length="{length!r}">{shape}</geometry>'
        x, y, heading = x + dx, y + dy, heading + turn
    return f'<OpenDRIVE><road id="1"><planView>{text}</planView></road></OpenDRIVE>'


LINE = (5.0, "<line/>", 5.0, 0.0, 0.0)
ARC = (math.pi, '<arc curvature="0.5"/>', 2.0, 2.0, math.pi / 2)


def test_opendrive(tmp_path):
    bend = read_curve(put(tmp_path, "e.xodr", road(ARC)), scale=0.5)
    assert float(bend.at(0.0).curvature) == pytest.approx(1.0)
    spiral = (4.0, '<spiral curvStart="0" curvEnd="0.3"/>', 0, 0, 0)
    curve = read_curve(put(tmp_path, "a.xodr", road(LINE, spiral)), scale=0.5)
    assert curve.length == pytest.approx(4.5)
    assert float(curve.at(4.5).curvature) == pytest.approx(0.6)
    path = put(tmp_path, "b.xodr", road(LINE, ARC))
    with pytest.raises(
        InvalidInput, match=r"curvature jumps by 0\.5 1/m between geometry 0 and geometry 1"
    ):
        read_curve(path)
    assert read_curve(path, tolerance=0.05).length == pytest.approx(5 + math.pi, abs=0.1)
    cubic = (
        '<paramPoly3 aU="0" bU="3" cU="0" dU="0" aV="0" bV="0" cV="1" dV="0" pRange="normalized"/>'
    )
    with pytest.warns(UserWarning, match="cubic pieces"):
        points = read_file(put(tmp_path, "c.xodr", road((3.3, cubic, 0, 0, 0)))).points
    assert points[:, 1] == pytest.approx((points[:, 0] / 3) ** 2, abs=1e-12)
    for text, message in (
        (road(LINE, (*ARC[:1], '<arc curvature="x"/>', 0, 0, 0)), "geometry 1.*curvature is 'x'"),
        (road((0.0, "<line/>", 0, 0, 0)), "length is 0, must be positive"),
        (road(LINE, (5.0, "<line/>", 0, 0, 0)).replace('x="5.0"', 'x="5.5"'), "gap of 0.5 m"),
        (road((1.0, "<loop/>", 0, 0, 0)), "shape loop"),
        ("<OpenDRIVE></OpenDRIVE>", "roads none"),
    ):
        with pytest.raises(InvalidInput, match=message):
            read_curve(put(tmp_path, "d.xodr", text))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('<!DOCTYPE a [<!ENTITY b "c">]><gpx/>', "line 1.*document type or entities"),
        ("<!doctype html><html></html>", "HTML page"),
        ("\n<html></html>", "HTML page"),
        ("<osm/>", "root <osm>; GPX, KML and OpenDRIVE"),
        ("<gpx>", "not valid XML"),
        ("<gpx/>", "no track, route or line"),
        ('<gpx><wpt lat="1" lon="x"/></gpx>', "longitude is 'x', no number"),
    ],
)  # fmt: skip
def test_xml_without_entities_and_of_known_kinds(tmp_path, text, message):
    with pytest.raises(InvalidInput, match=message):
        read_curve(put(tmp_path, "a.xml", text))


def recorded(path, topics):
    """An MCAP of topic → (type, messages)."""
    writer_of = pytest.importorskip("mcap_ros2.writer").Writer
    systems = pytest.importorskip("rosbags.typesys")
    store = systems.get_typestore(systems.Stores.ROS2_JAZZY)
    with path.open("wb") as stream:
        writer = writer_of(stream)
        for topic, (kind, messages) in topics.items():
            schema = writer.register_msgdef(kind, store.generate_msgdef(kind, ros_version=2)[0])
            for n, message in [*enumerate(messages)][::-1]:  # logged late, as in a merged recording
                writer.write_message(topic, schema, message, n, n)
        writer.finish()
    return path


def pose(x, y):
    return {
        "position": {"x": x, "y": y, "z": 0.0},
        "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
    }


def test_recordings_of_robots(tmp_path):
    head = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "map"}
    poses = [{"header": head, "pose": pose(x, y)} for x, y in WAVE.tolist()]
    twist = {"linear": {"x": 0.5, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": 0.0}}
    odometry = [
        {"header": head, "child_frame_id": "b", "pose": {"pose": p["pose"], "covariance": [0.0] * 36},
         "twist": {"twist": twist, "covariance": [0.0] * 36}}
        for p in poses
    ]  # fmt: skip
    odom, plan = ("nav_msgs/msg/Odometry", odometry), "nav_msgs/msg/Path"
    path = recorded(tmp_path / "a.mcap", {"/odom": odom})
    reading = read_file(path)
    assert reading.points == pytest.approx(WAVE)
    assert reading.speeds == pytest.approx(np.full(49, 0.5))
    plans = [{"header": head, "poses": some} for some in ([], poses[:9], poses)]
    path = recorded(tmp_path / "b.mcap", {"/odom": odom, "/plan": (plan, plans)})
    with pytest.warns(UserWarning, match=r"2 messages hold a path; the last one is read \(49"):
        assert dict(read_file(path).rows())["topic"] == "/plan"
    assert read_file(path, take="/odom").points == pytest.approx(WAVE)
    stamped = ("geometry_msgs/msg/PoseStamped", poses)
    path = recorded(tmp_path / "c.mcap", {"/a": stamped, "/b": stamped})
    with pytest.warns(UserWarning, match="/a is read; /b hold"):
        assert read_file(path).points == pytest.approx(WAVE)
    with pytest.raises(InvalidInput, match="no topic '/c'"):
        read_file(path, take="/c")
    words = ("geometry_msgs/msg/Twist", [twist])
    with pytest.raises(
        InvalidInput, match=r"no path or pose.*/cmd \(geometry_msgs/msg/Twist, cdr\)"
    ):
        read_curve(recorded(tmp_path / "d.mcap", {"/cmd": words}))
    whole = (tmp_path / "a.mcap").read_bytes()
    for damaged in (whole[:200], whole[: len(whole) // 2] + b"x" * 100, whole[:9]):
        (tmp_path / "e.mcap").write_bytes(damaged)
        with pytest.raises(InvalidInput):
            read_curve(tmp_path / "e.mcap")


def test_damaged_recordings_and_geojson_are_refused_in_words(tmp_path):
    head = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "map"}
    poses = [{"header": head, "pose": pose(x, y)} for x, y in WAVE.tolist()]
    path = recorded(
        tmp_path / "a.mcap", {"/plan": ("nav_msgs/msg/Path", [{"header": head, "poses": poses}])}
    )
    whole, tree = path.read_bytes(), feature(WAVE.tolist())
    for seed in range(150):
        rng = random.Random(seed)
        data = bytearray(whole)
        for _ in range(rng.randint(1, 4)):
            data[rng.randrange(len(data))] = rng.randrange(256)
        path.write_bytes(data[: rng.randrange(len(data))] if rng.random() < 0.2 else data)
        survives(path)
        survives(put(tmp_path, "a.geojson", json.dumps(mutated(rng, tree))))


def test_a_recording_of_osculates_own_is_the_curve_that_was_driven(tmp_path):
    pytest.importorskip("mcap_ros2")
    curve = Cycloid.over()
    path = simulate(curve).save(tmp_path / "run.mcap")
    assert read_curve(path).length == pytest.approx(curve.length, rel=1e-4)


@pytest.mark.parametrize("size", [300 * 2**20, 2**40])
def test_what_a_chunk_unpacks_to_is_bounded_before_it_is_unpacked(size):
    from types import SimpleNamespace

    from osculate.curve.files.mcap import _check_size

    with pytest.raises(InvalidInput, match="MiB, unpacked"):
        _check_size(SimpleNamespace(uncompressed_size=size, compression="", data=b""), "a.mcap")


def test_only_regular_files_of_bounded_size_are_opened(tmp_path):
    os.mkfifo(tmp_path / "pipe.csv")
    for name, message in (
        (tmp_path / "pipe.csv", "regular file"), ("/dev/zero", "regular file"), (tmp_path, "is a folder"),
        (tmp_path / "none.csv", "no such file"), (tmp_path / ("a" * 500), "must be a readable file"),
    ):  # fmt: skip
        with pytest.raises(InvalidInput, match=message):
            read_curve(name)
    with (tmp_path / "large.csv").open("wb") as stream:
        stream.truncate(2**36)  # sparse
    with pytest.raises(InvalidInput, match="larger than 64 MiB"):
        read_curve(tmp_path / "large.csv")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\n" * 3, "NMEA"),
        ("LINESTRING (0 0, 1 2, 2 2)\n", "well-known text"),
        ("SRID=25832;LINESTRING Z(0 0 1, 1 2 1)", "well-known text"),
        ("[[points]]\nx = 0\ny = 0\n", "TOML or INI"),
        ("[path]\nx=0,1,2\n", "TOML or INI"),
        ("0\nSECTION\n2\nENTITIES\n", "DXF"),
        ("G21\nG1 X0 Y0\nG1 X1 Y1\n", "G-code"),
        ("G1 X0 Y0\nG1 X1 Y1\n", "G-code"),
        ("M 0 0 L 1 1 L 2 0", "SVG path"),
        ("version https://git-lfs.github.com/spec/v1\noid sha256:ab\nsize 12\n", "Git LFS pointer"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("suffix", [".txt", ".csv", ".yaml"])
def test_other_notations_are_named(tmp_path, suffix, text, message):
    with pytest.raises(InvalidInput, match=f"is.* {message}"):
        read_curve(put(tmp_path, f"a{suffix}", text))


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (gzip.compress(b"x,y\n0,0\n1,1\n", mtime=0), "gzip data; unpack it first"),
        (b"PK\x03\x04rest", "ZIP archive"),
        (b"#ROSBAG V2.0\n", "ROS 1 bag"),
        (b"SQLite format 3\0", "SQLite file"),
        (b"x,y\n0,0\n1,\0\n", "line 3.*binary data"),
        (b"\xff\xfex\0y", "line 1.*is not valid UTF-16|header only|holds"),
    ],
)  # fmt: skip
def test_binary_files_are_named(tmp_path, data, message):
    path = tmp_path / "data.csv"
    path.write_bytes(data)
    with pytest.raises(InvalidInput, match=message):
        read_curve(path)


def test_the_files_speeds_are_a_limit_if_asked_for(tmp_path):
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(WAVE, axis=0).T))])
    text = "x,y,v\n" + "".join(
        f"{x},{y},{0.5 + s / 10}\n" for (x, y), s in zip(WAVE, arc, strict=True)
    )
    path = str(put(tmp_path, "a.csv", text))
    assert CurveFile(path=path).speed_limit([1.0]) is None
    curve = CurveFile(path=path, speeds=True)
    s = np.linspace(0.0, curve.length, 7)
    assert curve.speed_limit(s) == pytest.approx(0.5 + s / 10, abs=2e-3)
    with pytest.raises(InvalidInput, match="no column or field of speeds"):
        CurveFile(path=str(put(tmp_path, "b.csv", "x,y\n0,0\n1,1\n")), speeds=True).length  # noqa: B018
    with (
        pytest.warns(UserWarning, match="v is negative from line 3 on"),
        pytest.raises(InvalidInput, match="negative speeds"),
    ):
        CurveFile(path=str(put(tmp_path, "c.csv", "x,y,v\n0,0,1\n1,1,-1\n")), speeds=True).read()
