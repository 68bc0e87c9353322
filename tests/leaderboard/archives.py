# SPDX-License-Identifier: GPL-3.0-or-later
"""Archives as strangers make them, and the sound one that they start from."""

import io
import pickle
import struct
import zlib
from dataclasses import dataclass, replace

import numpy as np

from salbench import _core
from salbench.leaderboard.expected import Expected
from salbench.leaderboard.submission import archive_of
from salbench.leaderboard.texts import Manifest

PROTOCOL = _core.protocol("{}", "protocol")
ODD = "\N{LATIN SMALL LETTER E WITH ACUTE}"  # one character, where a file system may have two
POINTS = {"1": 5, "2": 7, ODD: 3}
EXPECTED = Expected(PROTOCOL, "0" * 32, POINTS, tuple(POINTS))
CARD = "name: MINE\ncitation: Somebody\nlicence: MIT\ntraining_data: none\ntest_overlap: none\n"


def sound(card=CARD):
    """Entries of a submission, by name."""
    manifest = Manifest(configuration=_core.digest(PROTOCOL.encode()), data=EXPECTED.data)
    maps = {item: np.arange(n) / n for item, n in POINTS.items()}
    data = archive_of(card.encode(), manifest, PROTOCOL, b"scores", maps)
    from salbench.leaderboard.archive import read_zip

    return read_zip(data, 100, EXPECTED.most_bytes)


@dataclass
class Record:
    """An entry, as it stands in the archive and in its directory; what is None follows from the content."""

    name: str | bytes
    content: bytes = b""
    deflated: bool = False
    flags: int = 0
    crc: int | None = None
    size: int | None = None  # as declared
    packed: int | None = None
    attributes: int = 0o100644
    extra: bytes = b""  # of the directory
    at: int | None = None  # where the directory says that it is
    method: int | None = None

    @property
    def raw(self):
        return self.name if isinstance(self.name, bytes) else self.name.encode()

    @property
    def stored(self):
        if not self.deflated:
            return self.content
        stream = zlib.compressobj(9, zlib.DEFLATED, -15)
        return stream.compress(self.content) + stream.flush()

    def fields(self):
        crc = zlib.crc32(self.content) if self.crc is None else self.crc
        size = len(self.content) if self.size is None else self.size
        packed = len(self.stored) if self.packed is None else self.packed
        method = (8 if self.deflated else 0) if self.method is None else self.method
        return struct.pack("<5H3I", 20, self.flags | 0x800, method, 0, 33, crc, packed, size)

    def local(self):
        return b"PK\3\4" + self.fields() + struct.pack("<2H", len(self.raw), 0) + self.raw + self.stored

    def central(self, at):
        head = b"PK\1\2" + struct.pack("<2B", 63, 3) + self.fields() + struct.pack("<2H", len(self.raw), len(self.extra))
        return head + struct.pack("<3H2I", 0, 0, 0, self.attributes << 16, at if self.at is None else self.at) + self.raw + self.extra


def zip_of_records(records):
    body = directory = b""
    for record in records:
        directory += record.central(len(body))
        body += record.local()
    n = min(len(records), 0xffff)
    return body + directory + b"PK\5\6" + struct.pack("<4H2IH", 0, 0, n, n, len(directory), len(body), 0)


def records_of(entries):
    return [Record(name, content) for name, content in entries.items()]


def added(*further):
    """The sound archive and further entries."""
    return zip_of_records([*records_of(sound()), *further])


def changed(name, **fields):
    """The sound archive, where one entry is otherwise."""
    return zip_of_records([replace(record, **fields) if record.name == name else record for record in records_of(sound())])


def with_map(content):
    return changed("maps/1.npy", content=content)


def with_card(text):
    return changed("card.yaml", content=text if isinstance(text, bytes) else text.encode())


def with_field(key, value):
    """The sound card with another value, as it stands in the file."""
    lines = [line for line in CARD.splitlines() if not line.startswith(f"{key}:")]
    return with_card("\n".join([*lines, f"{key}: {value}"]) + "\n")


def with_manifest(key, value):
    """The sound manifest with another value, as it stands in the file."""
    name = "submission.yaml"
    lines = [line for line in sound()[name].decode().splitlines() if not line.startswith(f"{key}:")]
    return changed(name, content="\n".join([*lines, f"{key}: {value}"]).encode() + b"\n")


def npy(header, body=b"", version=(1, 0)):
    text = header.encode() + b"\n"
    return b"\x93NUMPY" + bytes(version) + struct.pack("<H" if version == (1, 0) else "<I", len(text)) + text + body


def npy_with(shape="(5,)", descr="'<f8'", fortran="False", body=bytes(40)):
    return npy(f"{{'descr': {descr}, 'fortran_order': {fortran}, 'shape': {shape}, }}", body)


def saved(values):
    file = io.BytesIO()
    np.save(file, values, allow_pickle=True)
    return file.getvalue()


class Evil:
    """Runs a command when unpickled."""

    def __reduce__(self):
        import os

        return os.system, ("touch /tmp/salbench-was-here",)


EVIL = pickle.dumps(Evil())
