# SPDX-License-Identifier: GPL-3.0-or-later
"""Processes that read files of strangers: requests and answers, limits, and one that dies."""

import io
import json
import os
import re
import subprocess
import sys
import threading
import time
import unittest
from unittest import mock

import h5py
import numpy as np

from salbench._errors import Interrupted, StorageError
from salbench import _limits
from salbench import _workers
from salbench.datasets import records
from salbench._workers import Worker
from support import FACES, NAN, WithArchive, lines, off

VIEWS = "places:\n  - meshes: 'm/*'\n    truth: {saliency: 'v/{item}_{view}.txt'}\n    views: scored\n"


class Served(WithArchive):
    def setUp(self):
        super().setUp()
        code = "import sys; from salbench.datasets.worker import main; sys.exit(main())"
        self.process = subprocess.Popen([sys.executable, "-P", "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.addCleanup(self.process.communicate)

    def asked(self, request):
        """What stands in OUT and OUT.error."""
        out = self.root / "out"
        self.process.stdin.write(f"{json.dumps(request)}\t{out}\n")
        self.process.stdin.flush()
        self.assertEqual(self.process.stdout.readline(), f"{out}\n")
        found = [path.read_bytes() if path.exists() else None for path in (out, self.root / "out.error")]
        for path in (out, self.root / "out.error"):
            path.unlink(missing_ok=True)
        return found

    def test_an_item_is_an_image_with_the_digests_of_what_was_read(self):
        self.write({"m/a.off": off(), "v/a_1.txt": lines([1, 2, 3, 4])})
        (row,) = self.list(VIEWS).items
        made, problem = self.asked({"do": "item", "layout": str(self.own), "root": str(self.root), "item": row.to_json()})
        self.assertIsNone(problem)
        with h5py.File(io.BytesIO(made)) as file:
            np.testing.assert_array_equal(file["shape/faces"][:], FACES)
            self.equal(file["views/1/saliency"][:], [1, 2, 3, 4])
            digests = dict(line.split("  ")[::-1] for line in file.attrs["source_files"].decode().splitlines())
        self.assertEqual(digests.keys(), {"m/a.off", "v/a_1.txt"})

    def test_what_is_wrong_is_one_line_and_the_next_request_is_answered(self):
        self.write({"m/a.off": off(), "v/a_1.txt": lines([1, 2, 3])})
        (row,) = self.list(VIEWS).items
        item = {"do": "item", "layout": str(self.own), "root": str(self.root), "item": row.to_json()}
        for request, expected in ((item, "v/a_1.txt"), ({"do": "dance"}, "dance"), ({}, "do"), ({"do": "maps", "path": "/no/such.h5"}, "/no/such.h5: "),
                                  ({"do": "rewrite", "path": str(self.root)}, "is a folder, where a file is expected")):
            made, problem = self.asked(request)
            self.assertIsNone(made)
            self.assertIn(expected, problem.decode())
            self.assertNotIn(b"\n", problem)
        self.write({"v/a_1.txt": lines([1, 2, 3, NAN])})
        self.assertIn("finite", self.asked(item)[1].decode())
        self.write({"v/a_1.txt": lines([1, 2, 3, 4])})
        self.assertIsNone(self.asked(item)[1])

    def test_names_that_are_no_utf8(self):
        name = os.fsdecode(b"caf\xe9")
        self.write({f"m/{name}.off": off(), f"v/{name}_1.txt": lines([1, 2, 3, 4])})
        (row,) = self.list(VIEWS).items
        made, problem = self.asked({"do": "item", "layout": str(self.own), "root": str(self.root), "item": row.to_json()})
        self.assertIsNone(problem)
        self.assertIn(b"m/caf\xe9.off", made)

    def test_a_shape_has_all_views_that_can_be_used(self):
        self.write({"m/a.off": off(), "v/a_1.txt": lines([1, 2, 3, 4]), "v/a_2.txt": lines([1, 2]), "v/a_3.txt": lines([5, 6, 7, 8])})
        items = [row.to_json() for row in self.list(VIEWS).items]
        made, problems = self.asked({"do": "shape", "layout": str(self.own), "root": str(self.root), "items": items})
        with h5py.File(io.BytesIO(made)) as file:
            self.assertEqual(list(file["views"]), ["1", "3"])
            self.assertEqual([line.split("  ")[1] for line in file.attrs["source_files"].decode().splitlines()], ["m/a.off", "v/a_1.txt", "v/a_3.txt"])
        (line,) = problems.decode().splitlines()
        self.assertTrue(line.startswith("a_2\t") and "v/a_2.txt" in line, line)


class Limits(unittest.TestCase):
    """A child bounds itself; these processes are this test's own."""

    def ended(self, work):
        code = f"from salbench import _limits\n_limits.no_core()\n{work}"
        return subprocess.run([sys.executable, "-P", "-c", code], capture_output=True, text=True, timeout=120)

    def test_memory_beyond_the_limit_is_an_exception(self):
        done = self.ended("_limits.limit(60, 1 << 28)\nprint(len(bytes(1 << 27)))\nbytes(1 << 29)")
        self.assertEqual((done.stdout, "MemoryError" in done.stderr), (f"{1 << 27}\n", True), done.stderr)

    def test_processor_time_beyond_the_limit_ends_the_process(self):
        done = self.ended("_limits.limit(1)\nwhile True: pass")
        self.assertEqual(done.returncode, -24)  # SIGXCPU

    def test_each_request_has_its_own_time(self):
        done = self.ended("import time\nfor k in range(3):\n    _limits.limit(1)\n    begin = time.process_time()\n"
                          "    while time.process_time() < begin + .7: pass\nprint('done')")
        self.assertEqual(done.stdout, "done\n", done.stderr)
        self.assertGreaterEqual(_limits.SECONDS, 60)


class Workers(WithArchive):
    def setUp(self):
        super().setUp()
        self.worker = Worker()
        self.addCleanup(self.worker.close)

    # Answers nothing but how many signals a file has left: one worker after the other dies of the next.
    DYING = """import sys; sys.path.insert(0, sys.argv.pop(1))
import os, pathlib
from salbench.datasets import worker
def maps(request):
    file = pathlib.Path(request["path"])
    signals = file.read_text().split()
    if signals:
        file.write_text(" ".join(signals[1:]))
        os.kill(os.getpid(), int(signals[0]))
    return b"answered"
worker.ANSWERS["maps"] = maps
sys.exit(worker.main())"""

    def test_one_that_dies_of_its_input_fails_it_and_one_that_is_killed_is_replaced_once(self):
        outside, damaged = "the process that reads it was ended from outside, twice (signal ", "damaged: the process that reads it crashed (signal "
        for signals, wrong in [("", ""), ("9", ""), ("15", ""), ("1", ""), ("9 9", f"{outside}9: Killed); run it again, with more memory free"),
                               ("9 15", f"{outside}15: "), ("11", f"{damaged}11: "), ("6", f"{damaged}6: "), ("9 11", f"{damaged}11: "),
                               ("24", "damaged: reading took more than")]:
            self.write({"signals": signals})
            request = {"do": "maps", "path": str(self.root / "signals")}
            with self.subTest(signals), mock.patch.object(_workers, "_START", self.DYING):
                if wrong.startswith(outside):  # nobody is to blame who wrote the file
                    with self.assertRaisesRegex(StorageError, f"signals: {re.escape(wrong)}"):
                        self.worker.ask(request)
                    self.assertEqual(self.worker.ask(request), (b"answered", []), "by the next")
                    continue
                made, problems = self.worker.ask(request)
                self.assertEqual((made, [problem.startswith(wrong) for problem in problems]), (None, [True]) if wrong else (b"answered", []), problems)
                self.assertEqual(self.worker.ask(request), (b"answered", []), "by the next")

    def test_all_are_asked_as_many_at_once_as_there_are_workers(self):
        requests = [{"do": "maps", "path": str(self.root / f"{number}.h5")} for number in range(12)]
        answers = {}
        self.assertTrue(_workers.ask_all(requests, lambda number, made, problems: answers.update({number: (made, problems)}), 3))
        self.assertEqual(sorted(answers), list(range(12)))
        for number, (made, problems) in answers.items():
            self.assertIsNone(made)
            self.assertIn(f"{number}.h5", problems[0])

    def test_a_failure_of_what_takes_the_answers_ends_it(self):
        def full(number, made, problems):
            raise OSError("disk full")
        begin = time.monotonic()
        with self.assertRaisesRegex(OSError, "disk full"):
            _workers.ask_all([{"do": "maps", "path": "none"}] * 200, full, 2)
        self.assertLess(time.monotonic() - begin, 60)

    def test_a_question_of_this_process_has_an_error_or_bytes(self):
        with self.assertRaisesRegex(records.InputError, "none.h5: "):
            _workers.asked({"do": "maps", "path": "none.h5"})
        pool = _workers.Pool()
        self.addCleanup(pool.close)
        self.write({"signals": "11"})
        request = {"do": "maps", "path": str(self.root / "signals")}
        with mock.patch.object(_workers, "_START", self.DYING):
            with self.assertRaisesRegex(records.InputError, f"^{request['path']}: damaged: the process that reads it crashed"):
                pool.ask(request)
            self.assertEqual(pool.ask(request), b"answered")

    def test_who_asks_is_interrupted_when_all_are_to_end(self):
        pool, at_work = _workers.Pool(), self.root / "at_work"
        os.mkfifo(at_work)
        code = f"import sys\nsys.stdin.readline()\nopen({str(at_work)!r}, 'w').close()\nsys.stdin.read()"
        ending = threading.Thread(target=lambda: (at_work.read_bytes(), pool.end_all()))
        ending.start()
        with mock.patch.object(_workers, "_START", code), self.assertRaises(Interrupted):
            pool.ask({"do": "maps", "path": "none.h5"})
        ending.join()
        self.assertRaises(Interrupted, pool.ask, {"do": "maps", "path": "none.h5"})
        pool.begin()
        self.addCleanup(pool.close)
        self.assertRaises(records.InputError, pool.ask, {"do": "maps", "path": "none.h5"})
