# SPDX-License-Identifier: GPL-3.0-or-later
"""Subcommands of the package, ended in the middle of their work, and two of them at once: no process and no scratch folder is left, what they
say leads on, and the next call makes what this one would have made."""

import shlex
import shutil
import signal
import tempfile
import unittest
from pathlib import Path
from typing import NamedTuple

from salbench import conclusions  # noqa: F401: what the subcommands import is there before they start
from salbench.leaderboard import site  # noqa: F401
from salbench.report import write  # noqa: F401
from tests.support import forked, toy_data
from tests.support.shapes import lines
from tests.support.stopped import Stopped

# Shapes are drawn, figures are not: those take most of the time, and it is shapes that are drawn in several processes.
WITHOUT_FIGURES = """
from salbench.report import drawing, style
drawing.Drawing.real = lambda _: None
style.save = lambda _: (b"", b"")
"""
IN_A_WORKER = """
from salbench.system import workers
workers._START = HERE + '''
import sys
sys.path.insert(0, sys.argv[1])
from salbench.datasets import sets
from salbench.system import workers
sets.Dataset.read = before(sets.Dataset.read)
workers.serve(*map(int, sys.argv[2:]))
'''
"""
BEFORE_A_CHECK = "from salbench.leaderboard import submission\nsubmission.checked = before(submission.checked)"
IN_A_DRAWING = WITHOUT_FIGURES + "from salbench.report import shape_files\nshape_files.draw = before(shape_files.draw)"
AT_THE_IMPORT = """
import sys
class Finder:
    def find_spec(self, name, *_):
        if name == "salbench.commands.report":
            here()
sys.meta_path.insert(0, Finder())
"""
BY_THE_KEYBOARD, BY_KILL, WITH_ITS_TERMINAL = (signal.SIGINT, True), (signal.SIGTERM, False), (signal.SIGHUP, False)
BEFORE_THE_DOCUMENT = "from salbench.conclusions import folders\nfolders.write_document = before(folders.write_document)"


class Command(NamedTuple):
    patch: str  # where it stops
    words: list  # the command line
    makes: Path | None  # a file or a folder; None for what is printed
    signals: tuple  # (number, whether all of its processes get it) of those that ask
    reads_on: bool = False  # what is being read when a signal asks is read to its end
    is_quiet: bool = False  # says nothing but that it was ended
    has_scratch: bool = True
    quick: str = ""  # what every call of it does otherwise than a user's


def everything(path):
    files = [path] if path.is_file() else [file for file in path.rglob("*") if file.is_file()]
    return {str(file.relative_to(path)): file.read_bytes() for file in files}


class Ended(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = folder = Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        data, out, mine, submissions = (folder / name for name in ("data set", "out", "mine", "submissions"))
        truths = toy_data.study(data, range(1, 7))
        config = folder / "toy.yaml"
        config.write_text("dataset: {scans: false}\nmodels: {RS: }\npicture: {size: 32}\n")
        over = ["--data", data, "--cache", folder / "cache", "--threads", "2"]
        cls.salbench("run", config, *over, "--out", out, "--quiet")
        cls.salbench("export", config, *over, "--for-report", "--items", "1,2", "--to", out / "shapes.h5", "--quiet")
        mine.mkdir()
        submissions.mkdir()
        for name, truth in truths.items():
            (mine / f"{name}.val").write_text(lines(truth))
        (mine / "card.yaml").write_text("name: MINE\ncitation: c\nlicence: l\ntraining_data: none\ntest_overlap: none\ndate: 2026-01-01\n")
        made, with_model = folder / "made", folder / "with_model.yaml"
        made.mkdir()
        (made / "card.yaml").write_text("name: CENTRE\ncitation: c\nlicence: l\ntraining_data: none\ntest_overlap: none\n")
        with_model.write_text("dataset: {scans: false}\nmodels: {CENTRE: {model: CB}}\n")
        cls.salbench("submit", made, "--to", folder / "made.zip", "-c", with_model, *over, "--quiet")
        cls.commands = {
            "import": Command(IN_A_WORKER, ["zaragoza", "--data", data, "--to", folder / "to"], folder / "to",
                              (BY_KILL,), reads_on=True, has_scratch=False),
            "inspect": Command(IN_A_WORKER, ["zaragoza", "--data", data], None, (WITH_ITS_TERMINAL,), reads_on=True,
                               has_scratch=False),
            "report": Command(IN_A_DRAWING, [out, "--processes", "2", "--to", folder / "pages"], folder / "pages",
                              (BY_THE_KEYBOARD,), is_quiet=True, quick=WITHOUT_FIGURES),
            "conclude": Command(BEFORE_THE_DOCUMENT, [out, "--out", folder / "tables", "--quiet"], folder / "tables",
                                (WITH_ITS_TERMINAL,), is_quiet=True, has_scratch=False),
            "submit": Command(BEFORE_A_CHECK, [mine, "--to", submissions / "mine.zip", "-c", config, *over], submissions,
                              (BY_THE_KEYBOARD,)),
            "leaderboard": Command(BEFORE_A_CHECK, [submissions, "--to", folder / "site", "-c", config, *over],
                                   folder / "site", (BY_KILL,)),
            "reproduce": Command(BEFORE_A_CHECK, [folder / "made.zip", "--to", folder / "again", "--data", data, "--threads", "2"],
                                 folder / "again", (BY_THE_KEYBOARD,)),
        }
        cls.whole = {name: cls.called(name) for name in cls.commands}

    @classmethod
    def line(cls, name):
        return [*map(str, (name, *cls.commands[name].words))]

    @classmethod
    def salbench(cls, *words, **how):
        done = forked.salbench(*words, **how)
        assert (done.returncode, done.stderr.count("Traceback")) == (0, 0), done.stderr
        return done.stdout

    @classmethod
    def called(cls, name, **environment):
        """Output of a call that is not interrupted."""
        printed = cls.salbench(*cls.line(name), before=lambda: exec(cls.commands[name].quick), **environment)
        makes = cls.commands[name].makes
        return printed if makes is None else everything(makes)

    def stopped(self, name):
        """Before anything is made."""
        makes = self.commands[name].makes
        if makes and name != "submit":  # which has the folder that leaderboard reads
            shutil.rmtree(makes, ignore_errors=True)
        return Stopped(self.commands[name].patch, *self.line(name))

    def test_by_a_signal_that_asks_and_then_by_force(self):
        """The run after both makes what an undisturbed run makes."""
        for name, command in self.commands.items():
            for number, to_all in command.signals:
                with self.subTest(name, number=number), self.stopped(name) as call:
                    call.signal(number, to_all)
                    if command.reads_on:
                        call.go()
                    status, errors = call.ended()
                    self.assertEqual((status, call.scratch_left(), errors.count("Traceback")), (130, [], 0), errors)
                    self.assertIn(f"o go on:\n  salbench {shlex.join(self.line(name))}\n", errors)
                    if command.is_quiet:
                        self.assertEqual(errors.count("\n"), 3, errors)
                    if name == "import":
                        self.assertNotEqual(everything(command.makes), {}, "what was read is kept")
            with self.subTest(name), Stopped(command.patch, *self.line(name), in_a_fork=True) as call:
                call.signal(signal.SIGKILL)
                self.assertEqual(call.ended()[0], -signal.SIGKILL)
                self.assertEqual(call.scratch_left() != [], command.has_scratch)
                self.assertEqual(self.called(name, TMPDIR=str(call.scratch)), self.whole[name])
                self.assertEqual(call.scratch_left(), [])

    def test_two_at_once_write_whole_files(self):
        for name, status in (("report", 3), ("conclude", 0)):  # a report is replaced as a whole, and the first call is told so
            with self.subTest(name), self.stopped(name) as first:
                self.assertEqual(self.called(name), self.whole[name])
                first.go()
                self.assertEqual(first.ended()[0], status)
            self.assertEqual(everything(self.commands[name].makes), self.whole[name])

    def test_two_submit_at_once(self):
        self.commands["submit"].words[2].unlink()
        with self.stopped("submit") as first:
            self.assertEqual(self.called("submit"), self.whole["submit"])
            first.go()
            self.assertEqual(first.ended()[0], 0)
        self.assertEqual(everything(self.commands["submit"].makes), self.whole["submit"])

    def test_while_modules_are_imported(self):
        """Before the command itself begins: it ends when that does."""
        patch = self.folder / "patch"
        (self.folder / "sitecustomize.py").write_text(f"import os\nwhile not os.path.exists({str(patch)!r}): pass\nexec(open({str(patch)!r}).read())\n")
        call = Stopped("", *self.line("report"), line=[toy_data.PROGRAM], PYTHONPATH=str(self.folder))
        (self.folder / "written").write_text(f"{call.here}\n{AT_THE_IMPORT}")
        (self.folder / "written").rename(patch)
        self.addCleanup((self.folder / "sitecustomize.py").unlink)
        with call:
            call.signal(signal.SIGINT)
            call.go()
            status, errors = call.ended()
        self.assertEqual((status, errors.count("Traceback")), (130, 0), errors)
