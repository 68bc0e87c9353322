# SPDX-License-Identifier: GPL-3.0-or-later
"""Point clouds in .pcd and .xyz files: points, normals if the file has them, and the viewpoint if known.
[rusu2011]

Points without a position are NaN; the caller leaves them out.
"""

import os
import re
from typing import Any

import numpy as np

from salbench.datasets.arrays import Floats
from salbench.datasets.tables import parse, read_lines, rows_of
from salbench.system.errors import InputError, in_quotes
from salbench.system.files import MAX_ITEM_BYTES, AnyPath, read_file

ROUNDING = 0.01  # tolerance for the length of a unit normal; other triples may be colours
HEADER_BYTES = 1 << 20
MOST_EXPANSION = 88  # LZF: 3 bytes encode at most 264

Cloud = tuple[Floats, "Floats | None", "Floats | None"]
_KEYWORDS = {
    b"VERSION",
    b"FIELDS",
    b"COLUMNS",
    b"SIZE",
    b"TYPE",
    b"COUNT",
    b"WIDTH",
    b"HEIGHT",
    b"VIEWPOINT",
    b"POINTS",
    b"DATA",
}
_HEADER = re.compile(rb"(?:.*\n)*?[ \t]*DATA[ \t]+(\S+)[ \t]*\r?\n")
_COMMENT = re.compile(rb"(?:^|\s)#.*")  # a '#' within a word, as in 1.#INF, begins no comment
_PLACE, _NORMAL = ("x", "y", "z"), ("normal_x", "normal_y", "normal_z")


def read_cloud(path: AnyPath) -> Cloud:
    """Reads a .pcd or .xyz file."""
    return (read_pcd if os.fspath(path).lower().endswith(".pcd") else read_xyz)(path)


def read_xyz(path: AnyPath) -> Cloud:
    """Reads x y z, or x y z and a unit normal, one point per line. The first line may give the number of
    points."""
    lines = [_COMMENT.sub(b"", line) for line in read_lines(path)]
    count = None
    if (filled := rows_of(lines)[1]) and (word := lines[filled[0] - 1].strip()).isdigit():
        count, lines[filled[0] - 1] = int(word), b""
    table, numbered = parse(lines, path), rows_of(lines)[1]
    if table.shape[1] not in (3, 6):
        raise InputError(
            f"{path}:{numbered[0]}: a point needs 3 values, x y z, or 6, x y z nx ny nz, separated by blanks"
        )
    if count is not None and count != len(table):
        raise InputError(
            f"{path}: {len(table)} points, but the first line announces {count}: copy the file again"
        )
    if table.shape[1] == 3:
        return table, None, None
    lengths = np.linalg.norm(table[:, 3:], axis=1)
    is_normal = (np.abs(lengths - 1) <= ROUNDING) | ~(lengths > 0)  # zeros and NaN: not measured
    if not is_normal.all() or not (lengths > 0).any():
        row = int(np.argmin(is_normal))
        raise InputError(
            f"{path}:{numbered[row]}: the last three of six values are"
            f" {' '.join(f'{x:g}' for x in table[row, 3:])}, which is not a unit normal: are these colours?"
            " Write x y z alone"
        )
    return table[:, :3], table[:, 3:], None


def read_pcd(path: AnyPath) -> Cloud:
    data = read_file(path)
    begin = _HEADER.match(data, 0, HEADER_BYTES)
    if begin is None:
        raise InputError(f"{path}: the file ends within the header: it is cut short, or not a PCD file")
    header = {
        words[0]: words[1:] for line in begin[0].splitlines() if (words := _COMMENT.sub(b"", line).split())
    }
    for keyword in header.keys() - _KEYWORDS:
        raise InputError(f"{path}: {in_quotes(keyword)} is not a keyword of a PCD header")
    fields = header.get(b"FIELDS", header.get(b"COLUMNS", []))
    try:
        sizes, repeats = (
            [int(word) for word in header.get(key, [b"1"] * len(fields))] for key in (b"SIZE", b"COUNT")
        )
        width, height = int(header[b"WIDTH" if b"WIDTH" in header else b"POINTS"][0]), int(
            header.get(b"HEIGHT", [b"1"])[0]
        )
        kinds = [{b"I": "i", b"U": "u", b"F": "f"}[kind] for kind in header[b"TYPE"]]
        form = np.dtype(
            [
                (f"{k}", f"<{kind}{size}", (repeat,))
                for k, (kind, size, repeat) in enumerate(zip(kinds, sizes, repeats, strict=True))
            ]
        )
        viewpoint = np.array(header.get(b"VIEWPOINT", [b"0", b"0", b"0"])[:3], float)
        n = int(header.get(b"POINTS", [b"%d" % (width * height)])[0])
    except (KeyError, ValueError, TypeError, IndexError, OverflowError) as error:
        raise InputError(
            f"{path}: the header cannot be used ({' '.join(str(error).split())[:80]}): it says FIELDS, SIZE,"
            " TYPE and COUNT of each field, WIDTH, HEIGHT and POINTS"
        ) from None
    if n < 1 or n != width * height or len(fields) != len(kinds):
        raise InputError(
            f"{path}: the header announces {n} points, {width} x {height}, with {len(fields)} fields and the"
            f" types of {len(kinds)}"
        )
    if not np.isfinite(viewpoint).all():
        raise InputError(f"{path}: the VIEWPOINT is not a finite place: correct it")
    names = [field.decode("latin-1") for field in fields]
    columns = [
        names.index(name) if names.count(name) == 1 and repeats[names.index(name)] == 1 else None
        for name in (*_PLACE, *_NORMAL)
    ]
    for name, column in zip(_PLACE, columns):
        if column is None:
            raise InputError(f'{path}: the header has no field "{name}" of one number per point')
    body = data[begin.end() :]
    if begin[1] == b"ascii":
        table = _of_text(body, path, begin[0].count(b"\n"), n, sum(repeats))
        found = [table[:, sum(repeats[:column])] for column in columns if column is not None]
    elif begin[1] in (b"binary", b"binary_compressed"):
        found = _of_bytes(
            body,
            path,
            n,
            form,
            [column for column in columns if column is not None],
            begin[1] == b"binary_compressed",
        )
    else:
        raise InputError(
            f"{path}: {in_quotes(begin[1])} is not a PCD format: expected ascii, binary or binary_compressed"
        )
    normals = np.stack(found[3:], axis=1) if len(found) == 6 else None
    return np.stack(found[:3], axis=1), normals, viewpoint if viewpoint.any() or height > 1 else None


def _of_text(body: bytes, path: AnyPath, header: int, n: int, width: int) -> Floats:
    words = body.split()
    if len(words) != n * width:
        raise InputError(
            f"{path}: {len(words)} numbers follow the header, which announces {n} points of {width}: the file"
            " is cut short, or the header wrong"
        )
    try:
        return np.array([*map(float, words)]).reshape(n, width)
    except ValueError:
        for line, row in enumerate(body.splitlines(), header + 1):
            for word in row.split():
                try:
                    float(word)
                except ValueError:
                    raise InputError(f"{path}:{line}: {in_quotes(word)} is not a number") from None
        raise


def _of_bytes(
    body: bytes, path: AnyPath, n: int, form: np.dtype[np.void], columns: list[int], compressed: bool
) -> list[Floats]:
    """Decodes binary data: point after point if uncompressed, field after field if compressed."""
    size = n * form.itemsize
    if compressed:
        body = _unpacked(body, path, size)
    if len(body) < size:
        raise InputError(
            f"{path}: the file ends after {len(body) // form.itemsize} of {n} points: it is cut short, copy"
            " it again"
        )
    if body[size:].strip(b"\0 \r\n"):
        raise InputError(
            f"{path}: there are {len(body) - size} bytes after the last point: the header is wrong, or the"
            " file damaged"
        )
    if not compressed:
        table = np.frombuffer(body, form, n)
        return [table[f"{column}"][:, 0].astype(float) for column in columns]
    places: dict[str, Any] = dict(form.fields or {})  # type and offset, by name
    return [
        np.frombuffer(body, places[f"{column}"][0].base, n, places[f"{column}"][1] * n).astype(float)
        for column in columns
    ]


def _unpacked(body: bytes, path: AnyPath, size: int) -> bytes:
    """Decompresses the LZF block behind the two sizes. h5py's filter is unsuitable: it returns uninitialised
    bytes for a truncated block."""
    packed_size, whole = (int.from_bytes(body[at : at + 4], "little") for at in (0, 4))
    packed, out, at = body[8 : 8 + packed_size], bytearray(), 0
    if whole != size or size > min(MAX_ITEM_BYTES, packed_size * MOST_EXPANSION) or len(packed) < packed_size:
        raise InputError(
            f"{path}: {len(packed)} of {packed_size} compressed bytes are to hold {whole}, and the points of"
            f" the header take {size} (at most {MAX_ITEM_BYTES}): the file is cut short or damaged, copy it"
            " again"
        )
    while at < packed_size and len(out) <= size:
        head, at = packed[at], at + 1
        if head < 32:  # literal run of head + 1 bytes
            out += packed[at : at + head + 1]
            at += head + 1
            continue
        length, more = (head >> 5) + 2, head >> 5 == 7
        length += packed[at] if more and at < packed_size else 0
        at += more
        begin = len(out) - ((head & 31) << 8) - (packed[at] if at < packed_size else size) - 1
        at += 1
        if begin < 0:
            break
        piece = out[begin : begin + length]  # overlapping copies repeat themselves
        out += (piece * (length // len(piece) + 1))[:length]
    if len(out) != size:
        raise InputError(f"{path}: the compressed bytes are damaged, copy the file again")
    return bytes(out) + body[8 + packed_size :]
