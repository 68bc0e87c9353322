# SPDX-License-Identifier: GPL-3.0-or-later
"""Every block of code of README.md, CONTRIBUTING.md and docs/ runs, page by page and in order, beside a small data set.

sh      run by bash
python  executed; the blocks of a page share their names
yaml    a configuration, read by `salbench config`; the description of a data set, read by `salbench inspect`; or a model's card
cpp     compiled (docs/add_a_model.md)
text    not run

A block whose first line is a comment with the name of a file becomes that file, for the blocks after it.
"""

import contextlib
import io
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

import yaml

import pages

# Keys of a description of a data set (docs/data_sets.md); every other block of YAML is a configuration.
DESCRIPTION = {"domain", "classes", "licence", "ground_truth", "places", "values", "indices", "splits", "columns"}


class Runner:
    def __init__(self, folder):
        self.folder = folder
        self.environment = pages.workspace(folder)
        self.names = {"__name__": "page"}
        self.source = folder / "page.cpp"
        self.count = 0

    def program(self, *arguments):
        return subprocess.run([pages.PROGRAM, *arguments], cwd=self.folder, env=self.environment, capture_output=True, text=True)

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
        return ""

    def yaml(self, block):
        path = self.folder / (block.file or "block.yaml")
        path.parent.mkdir(exist_ok=True)
        path.write_text(block.text)
        if path.name == "card.yaml":  # read by the commands after it
            return ""
        if not DESCRIPTION & set(yaml.safe_load(block.text)):
            done = self.program("config", path)
            return done.stderr if done.returncode else ""
        if "places" not in yaml.safe_load(block.text):
            path.write_text(block.text + "places: [{meshes: '*.off'}]\n")
        done = self.program("inspect", path, "--data", self.folder / "toy")
        # What it names is not there, which is known once it has been read.
        return done.stderr if done.returncode == 2 and "meshes found" not in done.stderr else ""

    def cpp(self, block):
        """Added to the file that a page makes of its blocks."""
        if not self.source.exists():
            self.source.write_text('#include "pipeline/rules/models.h"\nnamespace salbench {}\nusing namespace salbench;\nstruct XsOptions;\n')
        with open(self.source, "a", encoding="utf-8") as file:
            file.write(re.sub(r"^ +(model_row\(.*\)),$", r"const ModelRow row = \1;", block.text, flags=re.M))
        return ""

    def compiled(self):
        """What the compiler says of that file, if there is one."""
        line = ["g++", "-std=c++20", "-fsyntax-only", "-I", pages.ROOT, "-I/usr/include/eigen3", self.source]
        return subprocess.run(line, capture_output=True, text=True).stderr if self.source.exists() else ""

    def text(self, block):
        return ""

    def run(self, block):
        if block.file and block.language == "python":
            (self.folder / block.file).write_text(block.text)
            return ""
        return getattr(self, block.language)(block)


class Blocks(unittest.TestCase):
    def check(self, page):
        with tempfile.TemporaryDirectory() as name, contextlib.chdir(name):
            runner = Runner(Path(name))
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
            runner = Runner(Path(name))
            for language, text in (("sh", "false | true\n"), ("yaml", "models: {LS: {foci: 1}}\n"), ("yaml", "values: {pre: face}\n"),
                                   ("cpp", "int a = missing;\n")):
                self.assertNotEqual(runner.run(pages.Block(language, text, 1)) or runner.compiled(), "", text)
            with self.assertRaises(NameError):
                runner.run(pages.Block("python", "missing\n", 1))


def test_of(page):
    return lambda self: self.check(page)


for page in pages.PAGES:
    if pages.blocks(page):
        setattr(Blocks, f"test_{page.stem.lower()}", test_of(page))
