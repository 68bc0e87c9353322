# SPDX-License-Identifier: GPL-3.0-or-later
"""Programs beside the test, and what they leave in a cache. Imports nothing of the package: builds with a sanitizer have none for the test."""

import hashlib
import os
import signal
import subprocess
import time
from pathlib import Path

import h5py
import numpy
import yaml

from tests.support import toy_data
from tests.support.cache_files import segments

ENGINE, PROGRAM = os.environ["SALBENCH_ENGINE"], toy_data.PROGRAM
PATIENCE = 300  # s, of a test that fails
# Whatever starts the tests (nohup, a script in the background) may have had them ignored.
USUAL = (signal.SIGHUP, signal.SIGINT, signal.SIGQUIT, signal.SIGPIPE, signal.SIGTERM)
OF_ALL = ("matched", "scores", "reference", "mean_histogram", "score_table")  # kinds of stages that wait for other items


def at_rename(moment, number):
    """The environment of a program that sends itself this signal at one of its renames, such as "3 before": kill_at_rename.cpp."""
    return {"LD_PRELOAD": os.environ["SALBENCH_KILL_AT_RENAME"], "SALBENCH_KILL_AT": moment, "SALBENCH_KILL_BY": str(int(number)),
            "ASAN_OPTIONS": "verify_asan_link_order=0", "PYTHONDONTWRITEBYTECODE": "1"}  # writing bytecode renames files, too


def started(words, **environment):
    return subprocess.Popen([*map(str, words)], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                            env=os.environ | environment, preexec_fn=lambda: [signal.signal(number, signal.SIG_DFL) for number in USUAL])


def ended(process):
    out, errors = process.communicate(timeout=PATIENCE)
    return subprocess.CompletedProcess(process.args, process.returncode, out, errors)


def called(words, **environment):
    return ended(started(words, **environment))


def soon(condition, process=None):
    """Waits for a condition that is certain to come, and stays. False where it does not, or the process ends without it."""
    end = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > end or process is not None and process.poll() is not None:
            return condition()
        time.sleep(.001)
    return True


def without_symmetry(data):
    """Bends the meshes, so that no two of their scans are equal: those would share what is made of them."""
    for path in data.glob("Meshes/*.off"):
        head, counts, *rows = path.read_text().splitlines()
        n = int(counts.split()[0])
        places = (map(float, row.split()) for row in rows[:n])
        bent = [f"{x + .1 * y * y + .05 * z!r} {y + .07 * z * x!r} {z + .03 * x * x!r}" for x, y, z in places]
        path.write_text("\n".join([head, counts, *bent, *rows[n:]]) + "\n")


def contents(cache, *kinds):
    """{(stage, item, digest of its arrays)}: what a cache holds, without when that was computed."""
    found = set()
    for path in segments(cache):
        with h5py.File(path) as file:
            for stage, item in ((stage, item) for stage in file for item in file[stage] if not kinds or stage.partition(".")[0] in kinds):
                digest = hashlib.sha256()

                def add(name, data):
                    values = data[()] if isinstance(data, h5py.Dataset) else numpy.empty(0)
                    digest.update(repr((name, values.tolist() if values.dtype.hasobject else values.tobytes())).encode())
                file[stage][item].visititems(add)
                found.add((stage, item, digest.hexdigest()))
    return found


def before_reference(found, mesh):
    """Rows of a mesh and its scans that wait for no other item."""
    return {row for row in found if row[1].partition("_")[0] == mesh and row[0].partition(".")[0] not in OF_ALL}


def left_over(cache, out):
    """All in the cache's scratch folder, and in the output folder what is no table."""
    return [*(cache / "tmp").glob("*"), *(path for path in out.glob("*") if path.suffix not in (".csv", ".yaml", ".json"))]


def computed(record):
    return yaml.safe_load(Path(record).read_text())["artefacts_computed"]
