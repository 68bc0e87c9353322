# SPDX-License-Identifier: GPL-3.0-or-later
"""Shared by tests of the documentation: its pages, their blocks, and the folder that blocks run in."""

import atexit
import functools
import json
import os
import re
import shutil
import tempfile
from pathlib import Path

import numpy as np

from tests.support import toy_data, tracker_files, without_figures
from tests.support.toy_data import PROGRAM, ROOT

PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
MESHES = (1, 52, 125)  # named as SHREC'07's are, from three of its classes


class Block:
    def __init__(self, language, text, line):
        self.language, self.text, self.line = language, text, line

    @property
    def file(self):
        """The file that the block is, if its first line is a comment with nothing but a name: `# predict.py`."""
        found = re.match(r"# ([\w./-]+\.\w+)\n", self.text)
        return found and found.group(1)


def blocks(page):
    """Fenced blocks in their order; directives of MyST, {toctree} and such, are none."""
    text = page.read_text(encoding="utf-8")
    found = re.finditer(r"^```([^\n]*)\n(.*?)^```$", text, flags=re.M | re.S)
    return [Block(match[1], match[2], text.count("\n", 0, match.start()) + 1) for match in found if not match[1].startswith("{")]


def prose(page):
    """A page without its blocks."""
    return re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)


def shape_files(folder):
    """A small data set of the Schelling study's form, maps of another program, and a cloud."""
    rng = np.random.default_rng(1)
    truths = toy_data.study(folder / "SchellingData", MESHES, 12, 10, participants=4)
    toy_data.meshes(folder / "toy", len(MESHES))
    for part in ("my_maps", "mine", "my_clouds"):
        (folder / part).mkdir()
    for number, truth in truths.items():
        for maps in ("my_maps", "mine"):
            np.savetxt(folder / maps / f"{number}.val", rng.random(len(truth)))
    np.savetxt(folder / "my_clouds/statue.xyz", rng.normal(size=(200, 3)))
    study(folder / "study")


def save(path, rows, **how):
    path.parent.mkdir(parents=True, exist_ok=True)
    np.savetxt(path, rows, comments="", **how)


def study(folder, names=("cat", "eel", "owl")):
    """Files in every form that examples of data sets read, of the same three meshes."""
    rng = np.random.default_rng(2)
    toy_data.meshes(folder / "shapes", len(names))
    for number, name in enumerate(names, 1):
        path = (folder / f"shapes/{number}.off").rename(folder / f"shapes/{name}.off")
        _, (n, m, _), *rows = [[*map(float, line.split())] if line != "OFF" else [] for line in path.read_text().splitlines()]
        n, m = int(n), int(m)
        points, faces = np.array(rows[:n]), np.array(rows[n:], int)[:, 1:]
        text = "".join(f"v {x} {y} {z}\n" for x, y, z in points) + "".join("f {} {} {}\n".format(*face + 1) for face in faces)
        (folder / f"shapes/{name}.obj").write_text(text)
        (folder / f"shapes/animals_{number % 2}").mkdir(exist_ok=True)
        (folder / f"shapes/animals_{number % 2}/{name}.obj").write_text(text)
        save(folder / f"looks/{name}.txt", looks := rng.random(n))
        save(folder / f"looks/shapes_{name}.txt", looks)  # where an item's name begins with its folder
        save(folder / f"areas/{name}.txt", rng.random(m))
        save(folder / f"points/{name}.csv", np.hstack([points, rng.random((n, 1))]), header="x,y,z,density", delimiter=",")
        padded = np.hstack([points, points, rng.random((n, 1)), rng.random((n, 1)) > 0.9])
        save(folder / f"Gaze/{name}.txt", np.vstack([padded, np.zeros((3, 8))]))
        for person in ("A", "B", "C"):
            save(folder / f"people/{name}_{person}.txt", rng.random(n))
            save(folder / f"clicks/{name}_{ord(person) - 64}.pid", rng.choice(n, 5, replace=False) + 1, fmt="%d")
            eyes = np.tile([0, 0, 9000.0], (40, 1))
            rays = points[rng.choice(n, 40)] * 1000 - eyes
            rays /= np.linalg.norm(rays, axis=1, keepdims=True)
            table = np.hstack([np.arange(40)[:, None] / 60, np.ones((40, 1)), eyes, rays])
            save(folder / f"gaze/{name}_{person}.csv", table, header="t,ok,ex,ey,ez,dx,dy,dz", delimiter=",")
            save(folder / f"pixels/{name}_{person}.csv", np.column_stack([np.arange(40) * 16, np.full(40, 1160), np.full(40, 540), np.arange(40)]),
                 header="t,px,py,frame", delimiter=",")
        for view in ("front", "left"):
            save(folder / f"visible/{name}_{view}.txt", rng.random(n) > 0.3, fmt="%d")
            save(folder / f"seen/{name}_{view}.txt", rng.random(m) > 0.3, fmt="%d")
            save(folder / f"views/{name}_{view}.txt", rng.random(n))
            for person in ("A", "B"):
                save(folder / f"maps/{name}_{view}_{person}.csv", np.column_stack([np.arange(m), rng.random(m)]), header="face,density", delimiter=",")
        camera = {"width": 1920, "height": 1080, "fx": 1800, "fy": 1800, "frames_per_second": 60}
        pose = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 9], [0, 0, 0, 1]]
        (folder / "cameras").mkdir(exist_ok=True)
        (folder / f"cameras/{name}.json").write_text(json.dumps(camera | {"frames": [{"frame": k, "world_to_camera": pose} for k in range(40)]}))
    trackers(folder, names)
    (folder / "splits.csv").write_text("item,split\ncat,train\neel,test\nowl,train\n")
    (folder / "paths.txt").write_text("data/cat.off\ndata/eel.off\ndata/owl.off\n")


def trackers(folder, names):
    """Recordings of two people in the forms of eye trackers, under names as their makers give them, and the camera that all of them saw."""
    (folder / "camera.json").write_text(json.dumps(tracker_files.CAMERA))
    files = {"tobii.tsv": tracker_files.tobii_pro_lab("AB", names), "eyelink/A.asc": tracker_files.eyelink(names), "eyelink/B.asc": tracker_files.eyelink(names)}
    for kind, end in (("tobii_glasses", "gz"), ("pupil_core", "csv"), ("pupil_neon", "csv"), ("gazepoint", "csv"), ("unity", "csv"), ("eyenavgs", "csv")):
        files |= {f"{kind}/{name}_{person}.{end}": getattr(tracker_files, {"unity": "unity_world"}.get(kind, kind))() for name in names for person in "AB"}
    for name, content in files.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())


@functools.cache
def files_of_shapes():
    folder = tempfile.mkdtemp()
    atexit.register(shutil.rmtree, folder)
    shape_files(Path(folder))
    return folder


def workspace(folder):
    """Fills a folder as a checkout is, with data beside it; the environment in which its commands run."""
    shutil.copytree(files_of_shapes(), folder, dirs_exist_ok=True)
    for name in ("configs", "docs", "models", "scripts"):
        (folder / name).symlink_to(ROOT / name)
    bin_folder = folder / "bin"
    bin_folder.mkdir()
    (bin_folder / "python3").symlink_to("/usr/bin/python3")  # which sees Debian's packages
    (bin_folder / "salbench").symlink_to(without_figures.PROGRAM)
    (bin_folder / "salbench-engine").symlink_to(f"{PROGRAM}-engine")
    return os.environ | {"PATH": f"{bin_folder}:{os.environ['PATH']}", "TMPDIR": str(folder), "PYTHONDONTWRITEBYTECODE": "1"}
