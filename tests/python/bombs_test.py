# SPDX-License-Identifier: GPL-3.0-or-later
"""YAML that asks for more time, memory or stack than any record or configuration can need, through each door: it ends in a line, within a limit on
memory and processor time. Readers by themselves: files_test.py, tests/pipeline/section_test.cpp."""

import os
import resource
from unittest import mock

import toy
from salbench import conclusions  # noqa: F401: what the subcommands import is there before they start
from salbench.report import drawing, write  # noqa: F401
from tests.support import forked

MOST_BYTES, MOST_SECONDS = 3 << 30, 20


def multiplied(leaf, pattern):
    """a0 is a leaf, and each of the others is nine of the one before."""
    return f"a0: &a0 {leaf}\n" + "".join(f"a{i}: &a{i} {pattern(i - 1)}\n" for i in range(1, 30))


DEEP = 20_000
BOMBS = {
    "lists of aliases": multiplied("[x, x]", lambda i: f"[{', '.join([f'*a{i}'] * 9)}]") + "KEY: *a29\n",
    "a mapping in itself": "KEY: &m {models: *m, file: *m}\n",
    "braces": "KEY: " + "{a: " * DEEP + "}" * DEEP + "\n",
    "a large scalar": "KEY: " + "x" * (40 << 20) + "\n",
    "many keys": "".join(f"k{i}: 1\n" for i in range(60_000)),
    "half a line": "KEY: {a: [b, 'c\n",
}


class Bombs(toy.InAFolder):
    def limited(self):
        os.chdir(self.folder)
        resource.setrlimit(resource.RLIMIT_AS, (MOST_BYTES, MOST_BYTES))
        resource.setrlimit(resource.RLIMIT_CPU, (MOST_SECONDS, MOST_SECONDS + 1))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

    def ended(self, name, bomb, key, *words):
        """A subcommand over a file."""
        (self.folder / name).write_text(bomb.replace("KEY", key))
        with mock.patch("salbench.report.drawing.Drawing.real"):
            return forked.salbench(*words, before=self.limited)

    def test_in_configurations(self):
        for name, bomb in BOMBS.items():
            done = self.ended("c.yaml", bomb, "models", "plan", "c.yaml", "--data", self.folder)
            with self.subTest(name):
                self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr[:2000])
                self.assertLess(len(done.stderr), 150_000)
                self.assertRegex(done.stderr, "^error: (c.yaml|models|data)")

    def test_in_the_record_of_a_run(self):
        """run.yaml is a part of the results, which anybody may hand on."""
        (self.folder / "out").mkdir()
        (self.folder / "out/results.csv").write_text("dataset,item,class,view,model,cc,n_points,n_picks\nmeshes,1,,,LS,.5,9,0\n")
        for name, bomb in BOMBS.items():
            done = self.ended("out/run.yaml", bomb, "configuration", "conclude", "out")
            with self.subTest(name):
                self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1), done.stderr[:2000])
                self.assertRegex(done.stderr[:1500], r"^error: out/run.yaml(:\d+)?: .*\n$")
        for name, status in (("half a line", 0), ("a large scalar", 2)):  # a report shows scores without their record
            done = self.ended("out/run.yaml", BOMBS[name], "configuration", "report", "out", "--to", "page")
            self.assertEqual((done.returncode, done.stderr.count("\n")), (status, status // 2), done.stderr[:2000])

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
