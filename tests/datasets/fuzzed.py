# SPDX-License-Identifier: GPL-3.0-or-later
"""fuzzed.py COUNT: that many files, changed from valid ones at random with a fixed seed. Each ends in a form or in an InputError of one line,
soon, and with little memory; another end is a traceback or a signal."""

import random
import resource
import signal
import sys
import tempfile
from pathlib import Path

import numpy as np

from salbench import datasets
from salbench import _core
from salbench.datasets.records import Form, InputError
from support import npy, off

SEED, SECONDS, BYTES = 41, 20, 4 << 30
WORDS = (b"nan", b"inf", b"-1", b"1e999", b"\0", b"\n", b"\r", b",", b";", b"#", b'"', b"\xff\xfe", b"9" * 40, b"{item}", b"*a", b"&a", b"[", b"{", b": ",
         b"- ", b"../", b"'", b"!!python/name:os.system ", b"vertex", b"0,5")
TEXT = b"vertex,x,y,z,s\n" + b"".join(b"%d,%d,%d,%d,0.%d\n" % (k, k & 1, k >> 1 & 1, k >> 2, k) for k in range(4))
OWN = (b"places:\n  - &p {meshes: 'off/*', truth: {saliency: 'maps/{item}.csv', picks: 'clicks/{item}.pid'}}\n  - *p\n"
       b"values: {per: vertex, column: s, unseen: -1}\nindices: {base: 0}\nunits: mm\n"
       b"splits: {list: paths.txt, shares: {train: 80%, test: 0.2}}\nlicence: ask\n")
POINTS = OWN.replace(b"per: vertex", b"per: point, points: [x, y, z]")
GAZE = (b"places: [{meshes: 'off/*'}]\nunits: m\nrecording:\n  files: gaze/{person}.csv\n  columns: {item: item, time: t, valid: ok, pixel: [px, py], "
        b"frame: f}\n  cameras: cameras/{item}.json\n  delay_ms: 10\n  time: s\n  length: mm\n")
LOOKS = b"item,t,ok,px,py,f\n" + b"".join(b"cat,%d.5,1,3%d,240,%d\n" % (k, k, k % 3) for k in range(9))
JSON = b"".join(b'{"item": "cat", "t": %d, "ok": true, "px": 320, "py": 240.5, "f": %d}\n' % (k, k % 3) for k in range(5))
CAMERAS = (b'{"frames_per_second": 60, "width": 640, "height": 480, "fx": 500, "fy": 500, "frames": ['
           + b", ".join(b'{"frame": %d, "world_to_camera": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, %d], [0, 0, 0, 1]]}' % (k, k) for k in range(3)) + b"]}")
RECORDED = {"own.yaml": GAZE, "gaze/P1.csv": LOOKS, "gaze/P2.csv": JSON, "cameras/cat.json": CAMERAS}
FILES = {"off/cat.off": off().encode(), "maps/cat.csv": TEXT, "clicks/cat.pid": b"0\n3\n# c\n1\n", "paths.txt": b"a/cat.off\n", "own.yaml": OWN}
SEEDS = (("own.yaml", OWN), ("own.yaml", POINTS), ("maps/cat.csv", TEXT), ("maps/cat.csv", TEXT.replace(b",", b" ")),
         ("maps/cat.csv", npy(np.arange(4.0))),
         ("clicks/cat.pid", b"0\n3\n# c\n1\n"),
         ("paths.txt", b"a/cat.off\n"), ("off/cat.off", off().encode()), ("gaze/own.yaml", GAZE), *((name, RECORDED[name]) for name in list(RECORDED)[1:]))


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


def outcome(root, folder):
    """What becomes of the archive: forms of its items, or one line."""
    layout = str(root / "own.yaml")

    def read(item):
        form = datasets.read(layout, str(folder), item)
        if form.recording is not None:
            assert _core.read_one_form(_core.one_form_image(form), b"form")["recording"]["people"] == form.recording.people
        return form

    try:
        forms = [read(item) for item in datasets.find(layout).items(str(folder)).items if not item.problem]
        assert all(isinstance(form, Form) for form in forms)
        return bool(forms)
    except InputError as error:
        assert "\n" not in str(error), error
        return False


def main(count):
    resource.setrlimit(resource.RLIMIT_AS, (BYTES, BYTES))
    draw, read = random.Random(SEED), 0
    with tempfile.TemporaryDirectory() as folder:
        for k in range(count):
            name, seed = SEEDS[k % len(SEEDS)]
            data = changed(draw, seed)
            others = RECORDED if name.startswith(("gaze", "cameras")) else {}
            for file, content in (FILES | others | {name.removeprefix("gaze/") if name.endswith(".yaml") else name: data}).items():
                path = Path(folder) / file
                path.parent.mkdir(exist_ok=True)
                path.write_bytes(content)
            signal.alarm(SECONDS)
            try:
                read += outcome(Path(folder), Path(folder))
            except BaseException:
                print(f"case {k}: {name}: {data!r}", file=sys.stderr)
                raise
            signal.alarm(0)
    print(read)


if __name__ == "__main__":
    main(int(sys.argv[1]))
