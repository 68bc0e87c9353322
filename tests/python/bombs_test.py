# SPDX-License-Identifier: GPL-3.0-or-later
"""YAML that asks for more time, memory or stack than any record or configuration can need: each ends in a line, within a limit on memory and
processor time. Those of configurations' own reader are in tests/pipeline/section_test.cpp."""

import os
import resource
import subprocess
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import toy
from salbench import conclusions  # noqa: F401: what the subcommands import is there before they start
from salbench.report import drawing, write  # noqa: F401
from tests.support import forked

MOST_BYTES, MOST_SECONDS = 3 << 30, 20


def multiplied(leaf, pattern):
    """a0 is a leaf, and each of the others is nine of the one before."""
    return f"a0: &a0 {leaf}\n" + "".join(f"a{i}: &a{i} {pattern(i - 1)}\n" for i in range(1, 30))


LISTS = multiplied("[x, x]", lambda i: f"[{', '.join([f'*a{i}'] * 9)}]")
MAPPINGS = multiplied("{file: x}", lambda i: f"{{{', '.join(f'k{j}: *a{i}' for j in range(9))}}}")
MANY = "x: &x {LS: }\ny: &y [" + "*x, " * 5000 + "]\n"
DEEP = 20_000
BOMBS = {
    "lists of aliases": LISTS + "{key}: *a29\n",
    "mappings of aliases": MAPPINGS + "{key}: *a29\n",
    "many aliases of a mapping": MANY + "{key}: *y\n",
    "a mapping in itself": "{key}: &m {{models: *m, file: *m}}\n",
    "a list in itself": "{key}: &m [*m, *m]\n",
    "merged": "a: &a {{file: x}}\n{key}: {{<<: *a}}\n",
    "an alias of nothing": "{key}: *nothing\n",
    "brackets": "{key}: " + "[" * DEEP,
    "brackets that close": "{key}: " + "[" * DEEP + "]" * DEEP + "\n",
    "braces": "{key}: " + "{{a: " * DEEP + "}}" * DEEP + "\n",
    "dashes": "{key}:\n" + "- " * DEEP + "x\n",
    "steps": "".join(" " * i + "a:\n" for i in range(1000)),
    "questions": "? " * DEEP,
    "a large scalar": "{key}: " + "x" * (40 << 20) + "\n",
    "a large key": "x" * (40 << 20) + ": 1\n",
    "a large comment": "#" + "x" * (40 << 20) + "\n{key}: [\n",
    "a long number": "{key}: " + "9" * 900_000 + "\n",
    "many keys": "".join(f"k{i}: 1\n" for i in range(60_000)),
    "a tag of Python": "{key}: !!python/object/apply:os.system [touch bombed]\n",
    "a tag of its own": "{key}: !x [y]\n",
    "text with a byte that is none": "{key}: caf\udce9 [\n",
    "half a line": "{key}: {{a: [b, 'c\n",
    "a day that there is not": "{key}: 2026-02-30\n",
}


class Bombs(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def limited(self):
        os.chdir(self.folder)
        resource.setrlimit(resource.RLIMIT_AS, (MOST_BYTES, MOST_BYTES))
        resource.setrlimit(resource.RLIMIT_CPU, (MOST_SECONDS, MOST_SECONDS + 1))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

    def ended(self, *words):
        """A subcommand of the package, or of the program."""
        if words[0] == "plan":
            return subprocess.run([toy.PROGRAM, *words], capture_output=True, text=True, errors="replace", preexec_fn=self.limited)
        return forked.salbench(*words, before=self.limited)

    def write(self, name, bomb, key):
        text = bomb.replace("{key}", key).replace("{{", "{").replace("}}", "}")
        (self.folder / name).write_text(text, encoding="utf-8", errors="surrogateescape")

    def test_in_configurations(self):
        toy.meshes(self.folder / "data", 1)
        for name, bomb in BOMBS.items():
            self.write("c.yaml", bomb, "models")
            done = self.ended("plan", "c.yaml", "--data", "data")
            with self.subTest(name):
                lines = done.stderr.splitlines()  # the first errors, each in one
                self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr[:2000])
                self.assertLessEqual(len(lines), 100, done.stderr[:2000])
                for line in lines:
                    self.assertRegex(line, "^error: (c.yaml|models|data)")
                    self.assertLess(len(line), 1500)
        self.assertFalse((self.folder / "bombed").exists())

    def test_in_the_record_of_a_run(self):
        """run.yaml is a part of the results, which anybody may hand on."""
        (self.folder / "out").mkdir()
        (self.folder / "out/results.csv").write_text("dataset,item,class,view,model,cc,n_points,n_picks\nmeshes,1,,,LS,.5,9,0\n")
        for name, bomb in BOMBS.items():
            self.write("out/run.yaml", bomb, "configuration")
            for words in (("conclude", "out"), ("report", "out", "--to", "page")):
                with self.subTest(name, command=words[0]), mock.patch("salbench.report.drawing.Drawing.real"):
                    done = self.ended(*words)
                    if words[0] == "conclude":
                        is_text = "configuration is" in done.stderr
                    if words[0] == "report" and not is_text:  # which shows scores without their record
                        self.assertEqual((done.returncode, done.stderr), (0, ""))
                        continue
                    self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1), done.stderr[:2000])
                    self.assertRegex(done.stderr, r"^error: out/run.yaml(:\d+)?: ")
                    self.assertLess(len(done.stderr), 1500)
        self.assertFalse((self.folder / "bombed").exists())

    def test_in_memory(self):
        import salbench

        deep = inner = {}
        for _ in range(100_000):
            inner["models"] = inner = {}
        circle = {}
        circle["models"] = circle
        for name, config, said in (("deep", deep, "config: is nested too deeply"), ("a circle", circle, "Circular reference"),
                                   ("large", {"cache": "x" * (2 << 20)}, "config:1: more than the 1048576 bytes that can be read"),
                                   ("long", {"metrics": {"names": ["cc"] * 10**6}}, "config:1: more than the 1048576 bytes that can be read")):
            for work in (lambda: salbench.run(config, data=self.folder), lambda: salbench.cross_validate(len, self.folder, config)):  # noqa: B023
                with self.subTest(name), self.assertRaisesRegex(ValueError, said):
                    work()
