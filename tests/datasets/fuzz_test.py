# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that are changed from valid ones at random, with a fixed seed, hang and crash nothing: each ends in a shape or in an InputError of one line,
soon, and with little memory. SALBENCH_FUZZED says how many; `fuzz_test.py COUNT` reads so many in this process."""

import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

from archives_test import MINIATURES
from clouds_test import files
from salbench.datasets import reading
from salbench.datasets.records import InputError
from salbench.datasets.tables import numbers
from support import find, npy

SEED, SECONDS, BYTES = 41, 20, 4 << 30
WORDS = (b"nan", b"inf", b"-1", b"1e999", b"\0", b"\n", b"\r", b",", b";", b"#", b'"', b"\xff\xfe", b"9" * 40, b"*a", b"[", b"{", b": ", b"- ", b"../", b"'", b"0,5")
TABLE = b"vertex,x,y,z,s\n" + b"".join(b"%d,%d,%d,%d,0.%d\n" % (k, k & 1, k >> 1 & 1, k >> 2, k) for k in range(4))
SETS = ("3dva", "3dvisa", "alexiou", "meshmamba", "sal3d", "sal3d_meshes", "sal3d_spread")
SINGLE = (("a.csv", TABLE, lambda path: numbers(path, ["s", "x"])), ("a.csv", TABLE.replace(b",", b" "), numbers), ("a.npy", npy(np.arange(4.0)), reading.read_values),
          ("a.pid", b"0\n3\n# c\n1\n", lambda path: reading.picks(path, 4)), *(("a.pcd", content, reading.cloud) for content in files().values()),
          ("a.xyz", b"1 2 3 0 0 1 # c\n" + b"".join(b"%d %d %d 1 0 0\n" % (k, k * k % 7, k * k % 5) for k in range(20)), reading.cloud))


def changed(draw, data):
    """A few bytes, words, or pieces that are exchanged, repeated, or gone."""
    data = bytearray(data)
    for _ in range(draw.choice((1, 1, 2, 3, 8))):
        at, end = sorted((draw.randrange(len(data) + 1), draw.randrange(len(data) + 1)))
        how = draw.randrange(6)
        if how == 0 and data:
            data[at - 1] ^= 1 << draw.randrange(8)
        elif how == 1:
            data[at:at] = draw.choice(WORDS)
        elif how == 2:
            data[at:min(end, at + 8)] = draw.randbytes(draw.randrange(1, 9))
        elif how == 3:
            del data[at:min(end, at + draw.choice((1, 4, 64)))]
        elif how == 4:
            data[at:at] = data[at:end] * draw.choice((1, 2, 50))
        else:
            del data[at:]
    return bytes(data)


def read_set(name, folder):
    rows = find(name).items(folder).items
    for item in rows:
        if not item.problem:
            find(name).read(item)


def cases(draw, folder):
    """A name, the changed content, and what reads it; without end."""
    while True:
        for name, content, read in SINGLE:
            data = changed(draw, content)
            (folder / name).write_bytes(data)
            yield name, data, lambda: read(folder / name)
        for name in SETS:
            below = folder / name
            for file, content in MINIATURES[name][0].items():
                (below / file).parent.mkdir(parents=True, exist_ok=True)
                (below / file).write_text(content)
            file = draw.choice([*MINIATURES[name][0]])
            data = changed(draw, (below / file).read_bytes())
            (below / file).write_bytes(data)
            yield f"{name}/{file}", data, lambda: read_set(name, below)


def main(count):
    resource.setrlimit(resource.RLIMIT_AS, (BYTES, BYTES))
    done = 0
    with tempfile.TemporaryDirectory() as folder:
        for k, (name, data, read) in zip(range(count), cases(random.Random(SEED), Path(folder))):
            signal.alarm(SECONDS)
            try:
                read()
                done += 1
            except InputError as error:
                assert "\n" not in str(error), error
            except BaseException:
                print(f"case {k}: {name}: {data!r}", file=sys.stderr)
                raise
            signal.alarm(0)
    print(done)


class Fuzzed(unittest.TestCase):
    def test_each_ends_in_a_shape_or_in_one_line(self):
        count = int(os.environ.get("SALBENCH_FUZZED", "300"))
        ended = subprocess.run([sys.executable, "-B", __file__, str(count)], capture_output=True, text=True)
        self.assertEqual((ended.returncode, ended.stderr[-2000:]), (0, ""))
        self.assertTrue(0.05 * count < int(ended.stdout) < 0.95 * count, f"{ended.stdout} of them were read")


if __name__ == "__main__":
    main(int(sys.argv[1]))
