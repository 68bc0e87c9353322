# SPDX-License-Identifier: GPL-3.0-or-later
"""Every block of code of README.md, CONTRIBUTING.md and docs/ runs, page by page and in order, beside a small data set.

sh      run by bash
python  executed; the blocks of a page share their names. A data set reads every item of the folder `study`
yaml    a configuration, read by `salbench config`, or a model's card
cpp     compiled (docs/add_a_model.md)
text    not run

A block whose first line is a comment with the name of a file becomes that file, for the blocks after it.
"""

import contextlib
import io
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import matplotlib.font_manager  # noqa: F401  or each report would look for fonts, in a folder of its own
import salbench.leaderboard.commands  # noqa: F401  and with it libraries that each command would import
import salbench.report.report  # noqa: F401
from salbench import datasets
from tests.support import forked
from tests.support.without_figures import without_figures

import pages


class Runner:
    def __init__(self, folder, commands):
        """commands: the folder of `salbench`."""
        self.folder = folder
        self.environment = pages.workspace(folder)
        self.environment["PATH"] = f"{commands}:{self.environment['PATH']}"
        self.names = {"__name__": "page"}
        self.source = folder / "page.cpp"
        self.count = 0

    def program(self, *arguments):
        return subprocess.run(["salbench", *arguments], cwd=self.folder, env=self.environment, capture_output=True, text=True)

    def sh(self, block):
        done = subprocess.run(["bash", "-euo", "pipefail", "-c", block.text], cwd=self.folder, env=self.environment,
                              stdin=subprocess.DEVNULL, capture_output=True, text=True)
        return "" if done.returncode == 0 else f"exit status {done.returncode}: {done.stdout}{done.stderr}"

    def python(self, block):
        self.count += 1
        path = self.folder / f"block_{self.count}.py"  # a file, since inspect looks for the source of functions
        path.write_text(block.text)
        with contextlib.redirect_stdout(io.StringIO()):
            exec(compile(block.text, str(path), "exec"), self.names)  # noqa: S102: our own text
        if is_data_set(block):
            mine = datasets.Dataset(self.names["items"], self.names["read"])
            return "".join(f"{item.name}: no ground truth" for item in mine.items(self.folder / "study").items if mine.read(item).ground_truth is None)
        return ""

    def yaml(self, block):
        path = self.folder / (block.file or "block.yaml")
        path.parent.mkdir(exist_ok=True)
        path.write_text(block.text)
        if path.name == "card.yaml":  # read by the commands after it
            return ""
        done = self.program("config", path)
        return done.stderr if done.returncode else ""

    def cpp(self, block):
        """Added to the file that a page makes of its blocks."""
        if not self.source.exists():
            self.source.write_text('#include "pipeline/rules/models.h"\nnamespace salbench {}\nusing namespace salbench;\nstruct XsOptions;\n')
        with open(self.source, "a", encoding="utf-8") as file:
            file.write(re.sub(r"^ +(model_row\(.*\)),$", r"const ModelRow row = \1;", block.text, flags=re.M))
        return ""

    def compiled(self):
        """Errors of the compiler for the block's C++ file, if there is one."""
        line = ["g++", "-std=c++20", "-fsyntax-only", "-I", pages.ROOT, "-I/usr/include/eigen3", self.source]
        return subprocess.run(line, capture_output=True, text=True).stderr if self.source.exists() else ""

    def text(self, block):
        return ""

    def run(self, block):
        if block.file and block.language == "python":
            (self.folder / block.file).write_text(block.text)
            done = self.program("inspect", block.file, "--data", "study") if is_data_set(block) else None
            return done.stdout + done.stderr if done and done.returncode else ""
        return getattr(self, block.language)(block)


def is_data_set(block):
    return "\ndef items(root):\n" in block.text


class Blocks(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        cls.commands = cls.enterClassContext(tempfile.TemporaryDirectory())
        report = f"import os, sys; os.execv('{cls.commands}/salbench', ['salbench', *sys.argv[2:]])"
        for context in (without_figures(), mock.patch("salbench.report.shape_files.METHOD", 0),  # pictures with the least effort
                        mock.patch("salbench.runs.results._IN_PROCESS", report), forked.named(cls.commands)):
            cls.enterClassContext(context)

    def check(self, page):
        with tempfile.TemporaryDirectory() as name, contextlib.chdir(name), mock.patch.object(sys, "path", [name, *sys.path]):
            self.addCleanup(sys.modules.pop, "mine", None)  # of a page that imports what it wrote
            runner = Runner(Path(name), self.commands)
            for block in pages.blocks(page):
                with self.subTest(line=block.line):
                    self.assertIn(block.language, ("sh", "python", "yaml", "cpp", "text"))
                    self.assertEqual(runner.run(block), "")
            self.assertEqual(runner.compiled(), "")

    def test_no_block_hides_in_an_indentation(self):
        for page in pages.PAGES:
            hidden = [line for line in re.findall(r"\n\n((?: {4}|\t)[^\n]+)", pages.prose(page))]
            self.assertEqual(hidden, [], page.name)

    def test_a_block_that_fails_is_seen(self):
        with tempfile.TemporaryDirectory() as name:
            runner = Runner(Path(name), self.commands)
            for language, text in (("sh", "false | true\n"), ("yaml", "models: {LS: {foci: 1}}\n"), ("python", "# bad.py\n\ndef items(root):\n    return []\n"),
                                   ("cpp", "int a = missing;\n")):
                self.assertNotEqual(runner.run(pages.Block(language, text, 1)) or runner.compiled(), "", text)
            with self.assertRaises(NameError):
                runner.run(pages.Block("python", "missing\n", 1))


def test_of(page):
    return lambda self: self.check(page)


for page in pages.PAGES:
    if pages.blocks(page):
        setattr(Blocks, f"test_{page.stem.lower()}", test_of(page))
