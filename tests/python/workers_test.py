# SPDX-License-Identifier: GPL-3.0-or-later
"""Processes that read files of strangers: questions and answers, limits, and those that die. The functions that are asked for stand in this file."""

import logging
import multiprocessing
import os
import re
import resource
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from unittest import mock

import numpy as np

import toy
from salbench.system import workers
from salbench.system.errors import InputError, Interrupted, StorageError, UnreadableError
from salbench.system.limits import BYTES_OF_A_MAP
from salbench.system.workers import NotRead, Pool, Question, ask_all

HERE = {"PYTHONPATH": os.pathsep.join([str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")])}


def same(*values):
    return values


def fail(kind, *arguments):
    raise kind(*arguments)


def die(file):
    """Kills its process by the next signal listed in the file."""
    signals = Path(file).read_text().split()
    Path(file).write_text(" ".join(signals[1:]))
    if "11" in signals[:1]:
        signal.signal(11, signal.SIG_DFL)  # a sanitizer would end the process with a status of its own
    if signals:
        os.kill(os.getpid(), int(signals[0]))
    return "alive"


def say():
    print("printed", flush=True)
    os.system("echo from another program")
    logging.getLogger("salbench").warning("odd")
    return sys.stdin.read()


def wait(fifo):
    with open(fifo, "wb"):
        pass
    time.sleep(1000)


def limits():
    return [resource.getrlimit(kind)[0] for kind in (resource.RLIMIT_CPU, resource.RLIMIT_AS, resource.RLIMIT_CORE)]


def asking(function, *arguments, **more):
    return Question(f"workers_test:{function.__name__}", arguments, "cow.off", **more)


class Workers(toy.InAFolder):
    def setUp(self):
        self.enterContext(mock.patch.dict(os.environ, HERE))
        super().setUp()
        self.pool = Pool()
        self.addCleanup(self.pool.close)

    def test_a_value_comes_back_as_it_is(self):
        values = (np.arange(6.).reshape(2, 3), np.arange(6)[::2], np.float32(2), np.array(["a", ""]), {"caf\udce9": [None, b"x", {1}]},
                  asking(same), np.zeros(0, bool), "x" * 3_000_000)
        for value, sent in zip(self.pool.ask(asking(same, *values)), values, strict=True):
            np.testing.assert_equal((value, getattr(value, "dtype", None)), (sent, getattr(sent, "dtype", None)))

    def test_an_error_is_the_same_here_and_the_next_question_is_answered(self):
        defect = "a defect of salbench: "
        for kind, *sent, text in [(InputError, InputError, "a.off: bad", "a.off: bad"), (UnreadableError, UnreadableError, "no", "no"),
                                  (StorageError, StorageError, "full", "cow.off: full"), (InputError, ValueError, "two\nlines", "two lines"),
                                  (MemoryError, MemoryError, "no memory for it; close"), (StorageError, ImportError, "lib.so", "cow.off: a library cannot be "),
                                  (StorageError, OSError, 24, "Too many", "a", "cow.off: a: cannot be read: Too many"), (InputError, KeyError, 1, f"{defect}KeyError: 1"),
                                  (InputError, OSError, 13, "Denied", "a", "a: cannot be read: Denied")]:
            with self.subTest(sent), self.assertRaises(kind) as raised:
                self.pool.ask(asking(fail, *sent))
            self.assertIs(type(raised.exception), kind)
            self.assertTrue(str(raised.exception).startswith(text), raised.exception)
        self.assertRaisesRegex(InputError, f"^{defect}AttributeError", self.pool.ask, Question("workers_test:nothing", (), "cow.off"))
        self.assertEqual(self.pool.ask(asking(same, 1)), (1,))

    def test_one_that_dies_fails_its_question_and_one_that_is_killed_is_replaced_once(self):
        outside, damaged = "cow.off: the process that reads it was ended from outside, twice (signal ", "cow.off: damaged: the process that reads it crashed "
        for signals, kind, said in [("9", None, ""), ("15", None, ""), ("1", None, ""), ("9 15", NotRead, f"{outside}15: Terminated); run it again, with more"),
                                    ("11", InputError, f"{damaged}(signal 11: Segmentation fault); write the file again"), ("9 6", InputError, damaged),
                                    ("24", InputError, "cow.off: damaged: reading took more than 60 s")]:
            (self.folder / "signals").write_text(signals)
            question = asking(die, str(self.folder / "signals"))
            with self.subTest(signals):
                if kind:
                    with self.assertRaisesRegex(kind, f"^{re.escape(said)}"):
                        self.pool.ask(question)
                self.assertEqual(self.pool.ask(question), "alive", "by the next")

    def test_one_that_cannot_begin_is_a_system_in_trouble(self):
        for start, said in (("raise SystemExit(1)", r"could not begin \(status 1\); see above"), ("import os; os.abort()", r"could not begin \(signal 6: ")):
            with self.subTest(start), mock.patch.object(workers, "_START", start), self.assertRaisesRegex(StorageError, said):
                self.pool.ask(asking(same))
        with mock.patch("subprocess.Popen", side_effect=BlockingIOError(11, "Resource temporarily unavailable")):
            self.assertRaisesRegex(StorageError, "cow.off: no process to read it: Resource", self.pool.ask, asking(same))

    def test_what_it_prints_is_no_answer_and_nothing_is_there_to_read(self):
        code = "import workers_test as w; print(repr(w.workers.asked(w.asking(w.say))))"
        done = subprocess.run([sys.executable, "-B", "-c", code], capture_output=True, text=True, timeout=100, env=os.environ | HERE)
        self.assertEqual((done.stdout, done.stderr), ("''\n", "printed\nfrom another program\nwarning: odd\n"))

    def test_each_question_has_its_own_limits(self):
        (self.folder / "large").write_bytes(bytes(5_000_000))
        time_of_small, memory, core = self.pool.ask(asking(limits))
        time_of_large, _, _ = self.pool.ask(asking(limits, files=[str(self.folder / "large"), "none"]))
        _, memory_of_map, _ = self.pool.ask(asking(limits, of_map=True))
        self.assertIn(time_of_large - time_of_small - 5, (0, 1))
        self.assertEqual((time_of_small // 10, core), (6, 0))
        self.assertLess(memory_of_map - BYTES_OF_A_MAP, memory)
        self.assertRaises(MemoryError, self.pool.ask, Question("builtins:bytearray", (2 << 30,), "map.h5", of_map=True))

    def test_processor_time_beyond_the_limit_ends_the_process(self):
        code = (
            "import resource, time\nfrom salbench.system import limits\nwhile time.process_time() < 1.5: pass\nfor seconds in 60, 1:\n"
            "    limits.limit(seconds)\n    print(resource.getrlimit(resource.RLIMIT_CPU)[0], flush=True)\nwhile True: pass"
        )
        done = subprocess.run([sys.executable, "-P", "-c", code], capture_output=True, text=True, timeout=100)
        self.assertEqual(done.returncode, -signal.SIGXCPU, done.stderr)
        first, last = map(int, done.stdout.split())
        self.assertGreater(first, 61, "beyond the time it has used")
        self.assertLess(last, first, "the last one counts")

    def test_threads_ask_at_once_and_a_forked_child_asks_its_own(self):
        with ThreadPoolExecutor(4) as threads:
            self.assertEqual([*threads.map(lambda k: self.pool.ask(asking(same, k)), range(40))], [(k,) for k in range(40)])
        child = multiprocessing.get_context("fork").Process(target=lambda: os._exit(self.pool.ask(asking(same, 7))[0]))
        child.start()
        child.join()
        self.assertEqual((child.exitcode, self.pool.ask(asking(same, 8))), (7, (8,)))

    def waiting(self, then):
        """A question, and a thread that calls `then` as soon as it is at work."""
        os.mkfifo(self.folder / "at_work")
        thread = threading.Thread(target=lambda: ((self.folder / "at_work").read_bytes(), then()))
        thread.start()
        self.addCleanup(thread.join)
        return asking(wait, str(self.folder / "at_work"))

    def test_who_asks_is_interrupted_when_all_are_to_end(self):
        self.assertRaises(Interrupted, self.pool.ask, self.waiting(self.pool.end_all))
        self.assertRaises(Interrupted, self.pool.ask, asking(same))
        self.pool.begin()
        self.assertEqual(self.pool.ask(asking(same, 1)), (1,))

    def test_an_answer_that_nobody_waited_for_is_not_that_to_the_next(self):
        with self.assertRaises(KeyboardInterrupt):
            self.pool.ask(self.waiting(lambda: os.kill(os.getpid(), signal.SIGINT)))
        self.assertEqual(self.pool.ask(asking(same, 1)), (1,))

    def test_all_are_asked(self):
        questions = [asking(same, 0), asking(fail, InputError, "bad"), asking(fail, MemoryError), Question("os:abort", (), "cow.off")]
        questions += [Question("os:getpid", (), "")] * 12
        found = {}
        complete = ask_all(questions, lambda number, *answer: found.update({number: answer}), 3)
        self.assertEqual((complete, sorted(found), found[0], found[1]), (True, [*range(16)], ((0,), ""), (None, "bad")))
        self.assertRegex(found[2][1] + found[3][1], "no memory for it.*cow.off: damaged")
        self.assertTrue(ask_all([], fail))

    def test_a_system_in_trouble_ends_all(self):
        (self.folder / "signals").write_text("9 9")
        killed = [asking(die, str(self.folder / "signals"))] + [asking(same)] * 200
        self.assertRaises(NotRead, ask_all, killed, lambda *_: None, 1)
        self.assertRaisesRegex(StorageError, "full", ask_all, [asking(fail, StorageError, "full")] * 200, lambda *_: None, 2)
        self.assertRaisesRegex(OSError, "disk full", ask_all, [asking(same)] * 200, lambda *_: fail(OSError, "disk full"), 2)

    def test_control_c_lets_questions_at_work_end(self):
        interrupt, seen = lambda: os.kill(os.getpid(), signal.SIGINT), []
        complete = ask_all([asking(same, 1)] * 200, lambda *answer: (seen.append(answer), len(seen) == 1 and (interrupt(), time.sleep(.2))), 1)
        self.assertEqual((complete, len(seen) < 5, seen[-1][1:]), (False, True, ((1,), "")))
