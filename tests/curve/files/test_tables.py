"""Tables: a known curve written in many ways is the same curve; what is no path is refused by its fault."""

import json
import math
import warnings

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from osculate import InvalidInput, read_curve
from osculate.curve.files import read_file

X = np.round(np.linspace(0.0, 12.0, 49), 4)
WAVE = np.stack([X, np.round(0.8 * np.sin(2 * np.pi * X / 6), 4)], axis=1)
NAMES = [
    ("x", "y"), ("X", "Y"), ("x_m", "y_m"), ("pos_x", "pos_y"), ("posX", "posY"), ("px", "py"),
    ("tx", "ty"), ("center_x", "center_y"), ("x_center", "y_center"), ("Easting", "Northing"),
    ("field.position.x", "field.position.y"), ("/odom/pose/pose/position/x", "/odom/pose/pose/position/y"),
    ("utm_x", "utm_y"), ("x_ref", "y_ref"), ("xCoord", "yCoord"), ("waypoint_x", "waypoint_y"), ("E", "N"),
    ("p_RS_R_x", "p_RS_R_y"),
]  # fmt: skip
UNITS = {
    "": 1.0,
    " (in)": 1 / 0.0254,
    "_m": 1.0,
    "_mm": 1e3,
    " [mm]": 1e3,
    "_cm": 1e2,
    " (km)": 1e-3,
    " [m]": 1.0,
}
OTHERS = {
    "time": lambda n: f"{1.7e9 + n / 4:.2f}", "index": str, "name": lambda n: f"wp{n}",
    "orientation.x": lambda n: "0.3", "yaw": lambda n: f"{n / 10}",
    "remark": lambda n: "" if n % 3 else "ok",
    "x_std": lambda n: "0.01", "vy": lambda n: "9", "z": lambda n: "0.0", "w_tr_right_m": lambda n: "1.5",
}  # fmt: skip
HEADERS = st.sampled_from(["plain", "comment", "quoted"])


def written(tmp_path, name, text, encoding="utf-8"):
    path = tmp_path / name
    path.write_bytes(text.encode(encoding))
    return path


def points(path, **options):
    reading = read_file(path, **options)
    return reading.points


@given(data=st.data())
def test_a_curve_is_the_same_however_its_table_is_written(tmp_path_factory, data):
    names = data.draw(st.sampled_from(NAMES))
    unit = data.draw(st.sampled_from(sorted(UNITS)))
    if ("/" in names[0] and " " in unit) or "_m" in names[0]:  # no name has two units
        unit = ""
    style = data.draw(HEADERS)
    delimiters = [",", ";", "\t", "|", ", "] + ([] if " " in unit else [" "])
    delimiter = data.draw(st.sampled_from(delimiters))
    commas = delimiter in (";", "\t") and data.draw(st.booleans())
    others = data.draw(st.lists(st.sampled_from(sorted(OTHERS)), unique=True, max_size=4))
    if delimiter == " ":
        others = [name for name in others if name != "remark"]
    order = data.draw(st.permutations([*(name + unit for name in names), *others]))
    columns = {
        name + unit: [f"{value * UNITS[unit]:.9g}" for value in WAVE[:, n]]
        for n, name in enumerate(names)
    } | {name: [OTHERS[name](n) for n in range(len(WAVE))] for name in others}
    mark, quote = {"plain": ("", ""), "comment": ("# ", ""), "quoted": ("", '"')}[style]
    if delimiter == ", " and quote:
        delimiter = ","
    header = mark + delimiter.join(f"{quote}{name}{quote}" for name in order)
    rows = [delimiter.join(columns[name][n] for name in order) for n in range(len(WAVE))]
    if commas:
        rows = [row.replace(".", ",") for row in rows]
    trailing = data.draw(st.sampled_from(["", delimiter.strip(" ")]))
    end = data.draw(st.sampled_from(["\n", "\r\n", "\n\n"]))
    text = end.join(row + trailing for row in [header, *rows])
    encoding = data.draw(st.sampled_from(["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "latin-1"]))
    path = written(tmp_path_factory.mktemp("table"), "wave.csv", text, encoding)
    assert points(path) == pytest.approx(WAVE, abs=1e-7)


def plain(rows=WAVE):
    return "".join(f"{x},{y}\n" for x, y in rows)


HEADED = "".join(
    f"{x},{y},{math.atan2(b - y, 0.25)}\n"
    for (x, y), b in zip(WAVE, [*WAVE[1:, 1], 0.0], strict=True)
)


@pytest.mark.parametrize(
    "text",
    [
        plain(),
        "x,y\n# a comment, of two parts\n" + plain(),
        "sep=;\nx;y\n" + plain().replace(",", ";"),
        "a track\nmeasured in May\nx,y\n" + plain(),
        "# recorded on a Monday with a rover\n" + plain().replace(",", " "),
        "x,y\nm,m\n" + plain(),
        "".join(f"{x},{y},\n" for x, y in WAVE),
        HEADED,
        plain().replace("-", "−"),
        "".join(f"wp{n},{x},{y}\n" for n, (x, y) in enumerate(WAVE)),
        "x,y\n" + plain() + ",\n,\n",
    ],
    ids=[
        "bare", "comment", "excel", "title", "prose", "units", "trailing", "heading", "minus", "named",
        "blank",
    ],
)  # fmt: skip
@pytest.mark.filterwarnings("ignore:.*left out")
def test_other_ways_to_write_it(tmp_path, text):
    assert points(written(tmp_path, "wave.csv", text)) == pytest.approx(WAVE, abs=1e-12)


@given(
    sign=st.sampled_from(["#", "%", "//"]),
    said=st.sampled_from(["", " start, here", "no space", " 3; 4", " it's | \t"]),
    delimiter=st.sampled_from([",", ";", "\t", "|", " ", ", "]),
    header=st.sampled_from(["", "x{}y", "x{}y # in metres", "'x'{}'y'"]),
    quote=st.sampled_from(["", "'"]),
    every=st.integers(1, 60),
)
def test_remarks_behind_numbers_and_single_quotes_change_nothing(
    tmp_path_factory, sign, said, delimiter, header, quote, every
):
    if delimiter == " " and "#" in header:
        header = "x{}y"
    rows = [
        delimiter.join(f"{quote}{value}{quote}" for value in row)
        + (f"  {sign}{said}" if n % every == 0 else "")
        for n, row in enumerate(WAVE)
    ]
    text = "\n".join([*([header.format(delimiter)] if header else []), *rows])
    path = written(tmp_path_factory.mktemp("table"), "wave.csv", text)
    assert points(path) == pytest.approx(WAVE, abs=1e-12)


def test_a_name_with_a_number_sign_is_no_remark(tmp_path):
    for header in ("x,y,name #\n", "x,y,name\n", ""):
        text = header + "".join(f"{x},{y} ,#{n}\n" for n, (x, y) in enumerate(WAVE))
        reading = read_file(written(tmp_path, "wave.csv", text))
        assert reading.points == pytest.approx(WAVE, abs=1e-12)
        assert not reading.warnings


@given(
    delimiter=st.sampled_from([";", "\t", "|", " ", "; "]),
    digits=st.integers(4, 8),
    more=st.sampled_from(["", "0,3", "wp"]),
)
def test_decimal_commas_need_no_header(tmp_path_factory, delimiter, digits, more):
    cells = [[f"{value:.{digits}f}".replace(".", ",") for value in row] for row in WAVE]
    text = "\n".join(delimiter.join([*row, *([more] if more else [])]) for row in cells)
    path = written(tmp_path_factory.mktemp("table"), "wave.csv", text)
    assert points(path) == pytest.approx(WAVE, abs=1e-12)


@pytest.mark.parametrize(
    ("row", "offer"),
    [
        (lambda n, x, y: f"{n},{x},{y},0.0,0.1", "2,3"),
        (lambda n, x, y: f"{n + 1},{x},{y}", "2,3"),
        (lambda n, x, y: f"{1.7e9 + n / 4:.3f} {x} {y} 0.0 0 0 0.6 0.8", "2,3"),
        (lambda n, x, y: f"{n / 4} {x} {y} 0.0 0 0 0.6 0.8", "2,3"),
        (lambda n, x, y: f"{1.7e18 + n * 1e8:.0f},{x},{y}", "2,3"),
        (lambda n, x, y: f"{1.7e9 + n // 10:.0f},{n % 10 * 10**8},{x},{y}", "3,4"),
        (lambda n, x, y: f"{math.atan(0.8378 * math.cos(1.0472 * x))},{x},{y}", "2,3"),
        (lambda n, x, y: f"{x},0.325,{y}", "1,3"),
        (lambda n, x, y: f"7,{x},{y}", "2,3"),
        (lambda n, x, y: f"{n},{n * 100},odom,{x},{y},0.0,0,0,0.6,0.8", "4,5"),
        (lambda n, x, y: f"1 0 0 {x} 0 1 0 {y} 0 0 1 0", "4,8"),
    ],
    ids=[
        "index", "from 1", "tum", "tum from 0", "ns", "s and ns", "heading", "height", "constant",
        "echo --csv", "kitti",
    ],
)  # fmt: skip
def test_without_a_header_the_wrong_columns_are_refused_and_the_right_ones_offered(
    tmp_path, row, offer
):
    text = "".join(row(n, x, y) + "\n" for n, (x, y) in enumerate(WAVE))
    path = written(tmp_path, "log.csv", text)
    with pytest.raises(InvalidInput, match=f"--columns {offer}"):
        read_curve(path)
    chosen = [int(n) for n in offer.split(",")]
    assert points(path, columns=chosen) == pytest.approx(WAVE, abs=1e-12)


def driven(kind, spacing, digits):
    """Columns of a drive round a bean or along a slalom: x, y, speed, heading, the steps even or timed."""
    part = np.linspace(0.0, 1.0, 3001)
    angle = 2.0 * np.pi * part
    radius = 30.0 + 6.0 * np.sin(3.0 * angle + 1.0)
    x, y = (
        (radius * np.cos(angle), radius * np.sin(angle))
        if kind == "bean"
        else (2.0 * np.sin(12.0 * part), 40.0 * part)
    )
    way = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))])
    at = np.linspace(0.0, 1.0, 150)
    speed = 1.5 + 0.8 * np.sin(4.0 * np.pi * at + 0.3)
    if spacing == "timed":
        at = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]))])
    place = at / at[-1] * way[-1]
    x, y = np.interp(place, way, x), np.interp(place, way, y)
    heading = np.unwrap(np.arctan2(np.gradient(y), np.gradient(x)))
    named = {"x": x, "y": y, "v": speed, "h": heading}
    return {name: np.round(column, digits) for name, column in named.items()}


@given(
    kind=st.sampled_from(["bean", "slalom"]),
    spacing=st.sampled_from(["even", "timed"]),
    digits=st.integers(3, 6),
    order=st.sampled_from(["vxy", "vxyh", "vhxy"]),
)
def test_a_speed_before_x_and_y_is_not_taken_as_x(tmp_path_factory, kind, spacing, digits, order):
    columns = driven(kind, spacing, digits)
    table = np.stack([columns[name] for name in order], axis=1)
    path = tmp_path_factory.mktemp("table") / "drive.csv"
    np.savetxt(path, table, fmt="%.6f", delimiter=",")
    pair = order.index("x") + 1, order.index("y") + 1
    with pytest.raises(InvalidInput, match=f"--columns {pair[0]},{pair[1]}"):
        read_file(path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert points(path, columns=pair)[:9] == pytest.approx(
            np.stack([columns["x"], columns["y"]], axis=1)[:9], abs=1e-9
        )


@given(
    kind=st.sampled_from(["bean", "slalom"]),
    spacing=st.sampled_from(["even", "timed"]),
    rest=st.sampled_from(["v", "h", "hv", "0", "w", "ww"]),
)
def test_x_and_y_first_are_read_whatever_follows(tmp_path_factory, kind, spacing, rest):
    columns = driven(kind, spacing, 4)
    columns |= {"0": np.zeros(150), "w": 1.1 + 0.1 * np.sin(np.arange(150) / 9.0)}
    table = np.stack([columns[name] for name in "xy" + rest], axis=1)
    path = tmp_path_factory.mktemp("table") / "drive.csv"
    np.savetxt(path, table, fmt="%.6f", delimiter=",")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert points(path)[:9] == pytest.approx(table[:9, :2], abs=1e-9)


@pytest.mark.parametrize("first", [lambda x: np.sin(x), lambda x: np.round(np.cos(x / 3)), abs])
def test_where_both_pairs_may_be_the_path_it_is_said(tmp_path, first):
    text = "".join(f"{first(6 - x):.4f},{x},{y}\n" for x, y in WAVE)
    with pytest.warns(UserWarning, match="may be x and y as well; if they are, say --columns 2,3"):
        read_file(written(tmp_path, "t.csv", text))


NOISE = np.random.default_rng(0).uniform(-1.0, 1.0, (3, 49))


ANGLE = 0.1 * (np.arange(49) + 0.05 * NOISE[0])


@pytest.mark.parametrize(
    "table",
    [
        (0.3 * (-1.0) ** np.arange(49), X + 0.1 * NOISE[0], WAVE[:, 1]),
        (0.6 * np.sin(ANGLE), np.cos(ANGLE), np.sin(ANGLE)),
    ],
    ids=["rougher", "less even"],
)
def test_a_rough_or_uneven_column_before_x_and_y_is_doubted(tmp_path, table):
    np.savetxt(tmp_path / "t.csv", np.stack(table, axis=1), delimiter=",")
    with pytest.warns(UserWarning, match="may be x and y as well; if they are, say --columns 2,3"):
        read_file(tmp_path / "t.csv", tolerance=1.0)


def test_a_time_or_widths_behind_x_and_y_raise_no_doubt(tmp_path):
    at = np.linspace(0.0, 1.0, 49)
    angle = 5.0 * (at + 0.1 * np.sin(6.0 * at))
    x, y = 0.2 * np.cos(angle), 0.02 * np.sin(angle)
    ring = np.sort(np.random.default_rng(0).uniform(0.0, 2.0 * np.pi, 150))
    part = np.linspace(0.0, 1.0, 150)
    widths = 1.1 + 0.1 * np.sin(10.0 * part), 1.1 + 0.05 * np.cos(15.0 * part)
    for table in ((x, y, 10.0 * at), (30.0 * np.cos(ring), 20.0 * np.sin(ring), *widths)):
        np.savetxt(tmp_path / "t.csv", np.stack(table, axis=1), fmt="%.6f", delimiter=",")
        reading = read_file(tmp_path / "t.csv")
        assert not any("as well" in said for said in reading.warnings)


def test_a_header_out_of_place_is_pointed_out(tmp_path):
    for text in ("# y_refx_ref|kappa|time\n0|1|2|5\n1|0|5|5\n0|3|1|5\n", "0,1\n# y,x\n1,0\n0,3\n"):
        with pytest.warns(UserWarning, match="may be a header, but"):
            read_curve(written(tmp_path, "t.csv", text))


def test_the_length_of_the_way_is_no_x(tmp_path):
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(WAVE, axis=0).T))])
    text = "".join(f"{s:.4f},{x},{y}\n" for s, (x, y) in zip(arc, WAVE, strict=True))
    with pytest.raises(InvalidInput, match="length of the way"):
        read_curve(written(tmp_path, "s.csv", text))
    text = "".join(f"{0.1 * n + 0.01 * (n % 3)},{x},{y}\n" for n, (x, y) in enumerate(WAVE))
    with pytest.warns(UserWarning, match="grows all the way; if it is a time, say --columns 2,3"):
        read_curve(written(tmp_path, "t.csv", text))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("s,x,z\n0,0,0\n1,1,1\n2,2,4\n", "x is there, y is not, among s, x, z"),
        ("# v_mps,ax_max_mps2,ay_max_mps2\n0.0,9.0,9.0\n5.0,8.5,9.0\n", "names v_mps, ax_max_mps2"),
        ("LATERAL,9.8051\nAVERAGE,0.7500\nlookahead,2.5\n", "no two columns of numbers"),
        ("O.0,5.0\n" + plain(), "line 1.*cell 1 is 'O.0', no number.*a header has no number"),
        ("x,y\n0,0\n1,l.5\n2,0\n", "line 3.*cell 2 is 'l.5'"),
        ("x,y\n0,0\n1,\n2,0\n", "line 3.*cell 2 is empty"),
        ("x,y\n0,0\n1\n2,0\n", "line 3.*cell 2 is empty"),
        ("x,y\n0,0\n1,2,3\n2,0\n", "line 3.*has 3 cells, the header names 2"),
        ("0,0\n1,2,3\n2,0\n", "line 1.*has 2 cells, others have 3"),
        ("x,y\n0,0\n1,nan\n2,0\n", "line 3.*must be finite"),
        ("x,y\n0,0\n1,1e999\n2,0\n", "line 3.*must be finite"),
        ("x,y\n0,0\n1:30,2\n2,0\n", "line 3.*minutes"),
        ("x,y\n0,0\n1_0,2\n2,0\n", "line 3.*no number"),
        ("x,y\n0,0\nx,y\n2,0\n", "line 3.*'x', no number"),
        ("x;y\n0,5;1,5\n1.5;2,5\n", "line 3.*decimal point"),
        ("0,25,0,20\n0,50,0,39\n0,75,0,05\n", "decimal commas between commas"),
        ('x,y\n0,0\n"1,2\n2,0\n', "line 3.*quotes"),
        ("ref.x,ref.y,act.x,act.y\n0,0,1,1\n", "several columns may be x and y.*--columns 1,2 or"),
        ("x1,y1,x2,y2\n0,0,1,1\n", "names x1, y1, x2, y2 and no x and y"),
        ("x_px,y_px\n0,0\n4,9\n", "counts pixels"),
        ("0,1\n0.5,2.5\n1.5,2.5\n2.5,2.5\n", "line 1.*counts the columns"),
        ("x,y\n0,0\n1e200,0\n2,0\n", "point 1.*further than 1e.11 m away"),
        ("x,y\n", "header only"),
        ("# nothing\n", "holds none"),
        ("x,y\n1,1\n1,1\n", "two different points"),
        ("x,0,1,2\ny,0,1,0\n", "rows are x, y; write one point a line"),
        ("(0, 0)\n(1, 2)\n", "line 1.*brackets around"),
        ("'0,5','1'\n'1,5','2'\n", "has no two columns of numbers"),
        ("x,y\n0,0\n1,'2\n2,3\n", "line 3.*cell 2 is \"'2\", no number"),
        ("x,y\n0,0\n1,2 remark\n2,3\n", "line 3.*cell 2 is '2 remark', no number"),
        ("x|y\n---|---\n1|2\n", "line 2.*cell 1 is '---', no number"),
    ],
)  # fmt: skip
def test_what_is_no_path_is_refused_by_its_fault(tmp_path, text, message):
    with pytest.raises(InvalidInput, match=message):
        read_curve(written(tmp_path, "table.csv", text))


@pytest.mark.parametrize(
    ("columns", "message"),
    [((2,), "must be two"), ((1, 9), "no column 9"), ((2, 2), "same column twice"), (("a", 1), "'a'")],
)  # fmt: skip
def test_columns_that_are_not_there(tmp_path, columns, message):
    with pytest.raises(InvalidInput, match=message):
        read_file(written(tmp_path, "t.csv", "u,v,w\n0,0,1\n1,1,1\n"), columns=columns)


def test_options_that_say_nothing_about_a_file_are_refused(tmp_path):
    table = written(tmp_path, "t.csv", "x,y\n0,0\n1,1\n")
    with pytest.raises(InvalidInput, match=r"take = 'a': chooses among several paths; .*holds one"):
        read_file(table, take="a")
    line = {"type": "LineString", "coordinates": [[0.0, 0.0], [900.0, 1.0]]}
    line = written(tmp_path, "t.geojson", json.dumps(line))
    with pytest.raises(InvalidInput, match=r"columns.*tables and lists; .* is GeoJSON"):
        read_file(line, columns=(1, 2))


def test_columns_by_name_and_their_units(tmp_path):
    text = "u_mm,v_mm\n" + "".join(f"{1e3 * x},{1e3 * y}\n" for x, y in WAVE)
    path = written(tmp_path, "t.csv", text)
    assert points(path, columns=("u_mm", "v_mm")) == pytest.approx(WAVE, abs=1e-9)
    assert points(path, columns=(1, 2), scale=2.0) == pytest.approx(2 * WAVE, abs=1e-9)


def test_degrees_are_projected_to_metres(tmp_path):
    metre = 360.0 / 40_007_863.0  # degrees of latitude, on average
    rows = "".join(f"{48.0 + metre * y:.9f},{11.0 + x * 1.3e-5:.9f}\n" for x, y in WAVE)
    path = written(tmp_path, "gps.csv", "lat,lon\n" + rows)
    reading = read_file(path)
    assert reading.points[0] == pytest.approx([0.0, 0.0], abs=1e-9)
    assert reading.points[:, 1] == pytest.approx(WAVE[:, 1], abs=2e-3)
    east = (
        1.3e-5 * 111_320.0 * math.cos(math.radians(48.0)) * 1.0025
    )  # m per 1.3e-5°, on the ellipsoid
    assert reading.points[:, 0] == pytest.approx(east * X, rel=1e-3, abs=1e-6)
    assert dict(reading.rows())["units"] == "degrees, projected to m"
    swapped = written(tmp_path, "swapped.csv", "lat,lon\n148.0,11.0\n148.1,11.0\n")
    with pytest.raises(InvalidInput, match=r"line 2.*latitude is 148, must be within ±90"):
        read_curve(swapped)


@pytest.mark.parametrize(
    ("name", "factor"), [("vx_mps", 1.0), ("speed_kmh", 1 / 3.6), ("v [km/h]", 1 / 3.6), ("mps", 1.0)]
)  # fmt: skip
def test_speeds_are_found_with_their_unit(tmp_path, name, factor):
    rows = "".join(f"{x},{y},{n + 1}\n" for n, (x, y) in enumerate(WAVE))
    reading = read_file(written(tmp_path, "t.csv", f"x,y,{name}\n{rows}"))
    assert reading.speeds == pytest.approx(factor * np.arange(1, 50))
    assert reading.found.speed_name == name


def test_real_tables_are_read_right_or_refused(shared_data):
    folder = shared_data / "files"
    path = folder / "Austin_DonkeySim_waypoints.txt"
    with pytest.raises(InvalidInput, match="--columns 1,3"):
        read_curve(path)
    assert read_file(path, columns=(1, 3)).closed
    with pytest.raises(InvalidInput, match="no path"):
        read_curve(folder / "tmp01_metrics.csv")
    with pytest.raises(InvalidInput, match="looks like a time"):
        read_curve(shared_data / "logs" / "tricycle.txt")
    assert read_file(folder / "mpcc_track.json").curve.length == pytest.approx(17.85, abs=0.01)


def test_a_speed_in_steps_before_x_and_y_is_told(tmp_path):
    """A set speed stays for many rows and jumps; nothing else speaks for the other two columns."""
    p = np.linspace(0.0, 4.0, 200)
    speed = np.where(p < 1.3, 0.5, np.where(p < 2.9, 1.5, 1.0))
    rows = np.stack([speed, p + 0.05 * p**2, 0.3 * np.sin(1.7 * p)], axis=1)
    path = tmp_path / "drive.csv"
    np.savetxt(path, rows, delimiter=",", fmt="%.6f")
    with pytest.warns(UserWarning, match="--columns 2,3"):
        read_file(path)
