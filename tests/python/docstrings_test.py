# SPDX-License-Identifier: GPL-3.0-or-later
"""Every example in a docstring runs; every public function has one, and a signature."""

import doctest
import importlib
import inspect
import pkgutil
import subprocess
import unittest

import salbench
import toy


def modules():
    return [importlib.import_module(f"salbench.{row.name}") for row in pkgutil.iter_modules(salbench.__path__)
            if row.name != "_core"]


class Docstrings(unittest.TestCase):
    def test_examples(self):
        ran = 0
        for module in [salbench, *modules()]:
            result = doctest.testmod(module)
            self.assertEqual(result.failed, 0, module.__name__)
            ran += result.attempted
        self.assertGreater(ran, 0)

    def test_functions_say_what_they_take(self):
        for name in salbench.__all__:
            what = getattr(salbench, name)
            if inspect.isfunction(what):
                for parameter in inspect.signature(what).parameters:
                    self.assertIn(parameter, what.__doc__, name)

    def test_types(self):
        ended = subprocess.run(["mypy", "--strict", "--no-error-summary", "--cache-dir=/dev/null", "python/salbench"], cwd=toy.ROOT,
                               capture_output=True, text=True)
        self.assertEqual(ended.stdout, "")
        self.assertEqual(ended.returncode, 0, ended.stderr)


if __name__ == "__main__":
    unittest.main()
