# SPDX-License-Identifier: GPL-3.0-or-later
"""Options over the program's own table of subcommands: each that one takes does something there."""

import importlib
import os
import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

import salbench.leaderboard.commands  # noqa: F401  and with it libraries that each call would import
from salbench.commands import SUBCOMMANDS, parsing
from tests.support import forked, toy_data
from tests.support.cache_files import count_artefacts

# Minimal arguments of each subcommand; CONFIG is replaced by the configuration of the toy.
WORDS = {"run": ["CONFIG"], "export": ["CONFIG", "--to", "all.h5"], "plan": ["CONFIG"], "config": ["CONFIG"], "verify": ["CONFIG", "--deep"],
         "gc": ["CONFIG", "--dry-run"]}
# Subcommands that do not read a configuration first.
OTHER_WORDS = {"conclude": ["OUT"], "import": ["LAYOUT", "--data", "x", "--to", "x"], "inspect": ["LAYOUT", "--data", "x"],
               "submit": ["MINE", "--data", "x", "--to", "x"], "leaderboard": ["FOLDER", "--data", "x", "--to", "x"],
               "reproduce": ["CARD", "--data", "x"], "report": ["OUT"]}
PATHS = {"CONFIG", "DIR", "DIR|FILE", "FILE", "FILE.h5", "FOLDER", "MINE", "OUT", "OUT|SCORES.csv", "TO"}  # as the help calls them


def parser_of(name):
    parser = parsing.Parser(name, SUBCOMMANDS[name])
    importlib.import_module(f"salbench.commands.{name if name != 'import' else 'import_'}").add_arguments(parser)
    return parser


def options_of(name):
    """Its actions by the name of an option, or by what stands for a positional argument in the help."""
    return {action.option_strings[-1] if action.option_strings else action.metavar: action for action in parser_of(name)._actions}


class OptionsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        holder = tempfile.TemporaryDirectory(prefix="options ")
        cls.addClassCleanup(holder.cleanup)
        cls.folder, cls.program = Path(holder.name), None
        cls.config = cls.folder / "toy.yaml"
        toy_data.study(cls.folder / "data", (1, 2))

    def setUp(self):
        self.config.write_text("dataset: {scans: false}\nmodels: {PS: , RS: }\n")

    def said(self, *words):
        if self.program:
            return subprocess.run([self.program, *words], capture_output=True, text=True, cwd=self.folder)
        return forked.salbench(*words, before=lambda: os.chdir(self.folder))

    def salbench(self, name, *further):
        """The subcommand over the folders of the toy."""
        folders = [(f"--{part}", self.folder / part) for part in ("data", "cache", "out")]
        words = [word for option, folder in folders if option in options_of(name) and option not in further for word in (option, folder)]
        return self.said(name, *(self.config if word == "CONFIG" else word for word in WORDS[name]), *words, *further)

    def test_models_may_be_the_floors_of_the_configuration(self):
        def models(names):
            done = self.salbench("run", "--models", names, "--quiet")
            self.assertEqual(done.returncode, 0, done.stderr)
            return {line.split(",")[4] for line in (self.folder / "out/results.csv").read_text().splitlines()[1:]}

        self.config.write_text("dataset: {scans: false}\nmodels: {PS: , CB: , RS: , NV: }\n")
        self.assertEqual(models("floors"), {"CB", "RS", "NV"})
        self.assertEqual(models("PS,floors,CB"), {"PS", "CB", "RS", "NV"})
        self.config.write_text("dataset: {scans: false}\nmodels: {PS: }\n")
        done = self.salbench("run", "--models", "floors")
        self.assertEqual((done.returncode, done.stderr.startswith("error: --models floors: ")), (2, True), done.stderr)

    def test_each_subcommand_has_a_smallest_form_here(self):
        self.assertEqual(set(SUBCOMMANDS), {*WORDS, *OTHER_WORDS})

    def test_those_that_a_subcommand_takes_are_used_by_it(self):
        """One that is not looked at would be accepted with any value, and its user believe in it."""
        self.assertEqual(self.salbench("run").returncode, 0)
        (self.folder / "no folder").write_text("text")
        unusable = {"--data": "/no/such/data", "--cache": "no folder", "--out": "no folder", "--items": "nobody", "--split": "nosuch",
                    "--reference": "/no/such.csv", "--shard": "9/8", "--models": "NOSUCH", "--format": "nosuch"}
        for name in WORDS:
            for option in options_of(name):
                with self.subTest(name, option=option):
                    if option in unusable:
                        done = self.salbench(name, option, unusable[option])
                        self.assertIn(unusable[option], done.stdout + done.stderr)
                    if option == "--quiet":
                        loud, quiet = self.salbench(name), self.salbench(name, "--quiet")
                        self.assertEqual(quiet.returncode, loud.returncode, loud.stderr)
                        self.assertLess(len(quiet.stdout), len(loud.stdout))

    def test_those_that_a_subcommand_does_not_use_are_refused(self):
        for name, option in (("plan", "--quiet"), ("plan", "--threads"), ("export", "--out")):
            done = self.salbench(name, option, "1")
            self.assertEqual(done.returncode, 2)
            self.assertIn(f"there is no option '{option}'", done.stderr)

    def test_threads_are_for_what_computes(self):
        for name in WORDS:
            with self.subTest(name):
                shutil.rmtree(self.folder / "cache", ignore_errors=True)
                self.assertNotEqual(self.salbench(name).returncode, 70)
                has_computed = (self.folder / "cache").exists() and count_artefacts(self.folder / "cache") > 0
                self.assertEqual("--threads" in options_of(name), has_computed)

    def test_those_that_do_nothing_without_another_or_with_it_are_refused(self):
        found = set()
        for name in WORDS:
            for option, verb, other in parser_of(name)._rules:
                with self.subTest(name, option=option, verb=verb, other=other):
                    found.add(f"{name} {option} {verb} {other}")
                    words = [word for word in WORDS[name] if verb == "excludes" or word not in (other, "--deep")]
                    others = [] if verb == "requires" else [other]
                    for word in (option, *others):
                        if word.startswith("-"):
                            words.append(word)
                        if options_of(name)[word].nargs != 0:
                            words.append("1")
                    done = self.said(name, *words)  # CONFIG is not read before
                    self.assertEqual(done.returncode, 2)
                    self.assertIn(f"{option} {verb} {other}", done.stderr)
        self.assertLessEqual({"verify --sample requires --deep", "run --matched requires --maps", "plan --out excludes --graph"}, found)

    def test_an_empty_path_is_refused(self):
        """It would be the present folder, or as good as no option at all."""
        found = set()
        for name, smallest in (WORDS | OTHER_WORDS).items():
            for option, action in options_of(name).items():
                if action.metavar not in PATHS:
                    continue
                with self.subTest(name, option=option):
                    found.add(action.metavar)
                    words = [*smallest]
                    if option[0] != "-":
                        words[0] = ""
                    elif option in words:
                        words[words.index(option) + 1] = ""
                    else:
                        words += [option, ""]
                    done = self.said(name, *words)
                    self.assertEqual((done.returncode, done.stderr.startswith(f"error: {option}: ")), (2, True), done.stderr)
        self.assertEqual(found, PATHS)

    def test_examples_have_no_other_options(self):
        for name, known in SUBCOMMANDS.items():
            for words, _ in known.examples:
                for option in re.findall("--[a-z-]+", words):
                    with self.subTest(name, option=option):
                        self.assertIn(option, options_of(name))

    def test_an_empty_split_takes_all_items_whatever_the_configuration_takes(self):
        own = self.folder / "sets.py"
        own.write_text("from salbench.datasets import Item\ndef items(root):\n"
                       "    return [Item(name, [f'{root}/Meshes/{name}.off'], split=split) for name, split in (('1', 'train'), ('2', 'test'))]\n")
        self.config.write_text(f"dataset: {{scans: false, layout: '{own}', split: test}}\nmodels: {{PS: , RS: }}\n")
        for further, meshes in (([], "1 mesh"), (["--split", "train"], "1 mesh"), (["--split", ""], "2 meshes")):
            self.assertIn(f"data set: {meshes}", self.salbench("plan", *further).stdout)

    def test_names_of_configurations_are_found_by_a_program_that_lies_anywhere(self):
        """In a folder of its own, neither installed nor in a checkout."""
        program, self.config = shutil.copy(toy_data.PROGRAM, self.folder / "salbench"), "shrec07_meshes"
        for name in WORDS:
            self.program = program if name == "run" else None
            with self.subTest(name):
                done = self.salbench(name)
                self.assertNotIn("shrec07_meshes", done.stderr)
                self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("layout: 3dva", self.said("config", "protocols/3dva").stdout)
        self.assertIn("did you mean 'shrec07_meshes'?", self.said("config", "shrec07_mesh").stderr)
