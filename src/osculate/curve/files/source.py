"""The bytes of a file and their text: regular files of bounded size, in the encodings people have."""

import codecs
import stat
from pathlib import Path
from typing import NamedTuple

from osculate.errors import InvalidInput

LARGEST = 64 * 2**20  # bytes of text: ten times what 10⁵ poses need as YAML
MAGIC = {
    b"\x1f\x8b": "gzip data; unpack it first",
    b"BZh": "bzip2 data; unpack it first",
    b"\xfd7zXZ": "xz data; unpack it first",
    b"\x28\xb5\x2f\xfd": "Zstandard data; unpack it first",
    b"\x04\x22\x4d\x18": "LZ4 data; unpack it first",
    b"PK\x03\x04": "a ZIP archive (a spreadsheet, KMZ or NumPy archive?); export it as CSV",
    b"#ROSBAG": "a ROS 1 bag; convert it to MCAP (mcap convert) or dump the topic as text",
    b"SQLite format 3": "an SQLite file (a rosbag2 .db3?); convert it to MCAP (ros2 bag convert)",
    b"\x93NUMPY": "a NumPy array; save it as text (numpy.savetxt)",
    b"\x89HDF": "an HDF5 or netCDF file; export x and y as CSV",
    b"CDF\x01": "a netCDF file; export x and y as CSV",
    b"PAR1": "a Parquet file; export x and y as CSV",
    b"%PDF": "a PDF document",
    b"\x89PNG": "a PNG picture",
    b"\xff\xd8\xff": "a JPEG picture",
    b"MATLAB 5.0": "a MATLAB file; export x and y as CSV",
}
MCAP = b"\x89MCAP0\r\n"
BOMS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)


class Text(NamedTuple):
    """Decoded text and how it was decoded."""

    content: str
    encoding: str  # as Python names it


def check_regular(path: Path) -> None:
    """Look at a file before opening it.

    Raises:
        InvalidInput: Missing, a folder, a pipe, a device or a socket (they may never end).
    """
    try:
        mode = path.stat().st_mode
    except FileNotFoundError:
        raise InvalidInput("path", str(path), "there is no such file") from None
    except (OSError, ValueError) as error:
        raise InvalidInput("path", str(path), f"must be a readable file ({error})") from None
    if stat.S_ISDIR(mode):
        raise InvalidInput("path", str(path), "is a folder; name the file in it")
    if not stat.S_ISREG(mode):
        raise InvalidInput(
            "path", str(path), "must be a regular file, no pipe, device or socket; save it first"
        )


def starts_with(path: Path, magic: bytes) -> bool:
    """Whether a regular file begins with these bytes.

    Raises:
        InvalidInput: It cannot be read.
    """
    try:
        with path.open("rb") as stream:
            return stream.read(len(magic)) == magic
    except OSError as error:
        raise InvalidInput("path", str(path), f"must be a readable file ({error})") from None


def read_text(path: Path) -> Text:
    """The text of a regular file.

    Raises:
        InvalidInput: Not regular, not readable, larger than `LARGEST`, or binary (says of which kind).
    """
    check_regular(path)
    try:
        with path.open("rb") as stream:
            data = stream.read(LARGEST + 1)  # /proc and growing logs have no true size
    except OSError as error:
        raise InvalidInput("path", str(path), f"must be a readable file ({error})") from None
    if len(data) > LARGEST:
        raise InvalidInput(
            "path", str(path), f"is larger than {LARGEST // 2**20} MiB; keep only the path in it"
        )
    for magic, kind in MAGIC.items():
        if data.startswith(magic):
            raise InvalidInput("path", str(path), f"is {kind}")
    return decode(data, str(path))


def decode(data: bytes, label: str) -> Text:
    """UTF-8, UTF-16 and UTF-32 with or without a mark; what is none of them is read as Latin-1.

    Raises:
        InvalidInput: Binary data.
    """
    encoding = next((name for mark, name in BOMS if data.startswith(mark)), _guess(data))
    try:
        content = data.decode(encoding)
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise InvalidInput(
            "path", f"{label}, line {line}", f"is not valid {encoding.upper()} ({error.reason})"
        ) from None
    if "\0" in content:
        line = content[: content.index("\0")].count("\n") + 1
        raise InvalidInput("path", f"{label}, line {line}", "holds binary data, not text")
    return Text(content, encoding)


def _guess(data: bytes) -> str:
    """The encoding of data without a mark; ASCII in UTF-16 has a zero in every other byte."""
    head = data[:4096]
    half = len(head) // 2
    if half and head[1::2].count(0) > 0.7 * half and head[::2].count(0) == 0:
        return "utf-16-le"
    if half and head[::2].count(0) > 0.7 * half and head[1::2].count(0) == 0:
        return "utf-16-be"
    try:
        data.decode("utf-8")
    except UnicodeDecodeError:
        return "latin-1"
    return "utf-8"
