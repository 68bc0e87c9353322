# SPDX-License-Identifier: GPL-3.0-or-later
"""Every example in a docstring runs; every public function has one, and a signature."""

import ast
import doctest
import importlib
import inspect
import os
import pathlib
import pkgutil
import subprocess
import unittest

import salbench
import toy
from salbench import _core


def modules():
    return [importlib.import_module(row.name) for row in pkgutil.walk_packages(salbench.__path__, "salbench.")
            if row.name not in ("salbench._core", "salbench.__main__")]


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

    def test_signatures_name_arrays_in_a_word(self):
        self.assertIn("prediction: array_like, ground_truth: array_like | salbench.shapes.shape.Shape | None", str(inspect.signature(salbench.score)))
        functions = [getattr(salbench, name) for name in salbench.__all__]
        functions += [getattr(salbench.models, name) for name in salbench.models.__all__]
        functions += [getattr(what, name) for what in functions if inspect.isclass(what) for name in vars(what)]
        shown = 0
        for function in filter(callable, functions):
            try:
                text = str(inspect.signature(function))
            except (TypeError, ValueError):
                continue
            self.assertNotRegex(text, "_SupportsArray|_NestedSequence|dtype", function)
            shown += 1
        self.assertGreater(shown, 50)

    def test_types(self):
        """Checks types of the package, and those that users see; with what was learnt of unchanged files the last time, which is kept in the build."""
        line = ["mypy", "--strict", "--no-error-summary", f"--cache-dir={pathlib.Path(toy.PROGRAM).parent / 'mypy'}", "python/salbench",
                "tests/python/typed_use.py"]
        lines = subprocess.run(line, cwd=toy.ROOT, capture_output=True, text=True, env=os.environ | {"MYPYPATH": "python"}).stdout.splitlines()
        self.assertEqual(len(lines), 1, lines)
        self.assertIn('typed_use.py:23: error: Argument "threads" to "run" has incompatible type "str"', lines[0])

    def test_the_stub_of_what_is_compiled_has_its_names(self):
        def plain(names):
            return {name for name in names if not name.startswith("_")}

        stub = ast.parse((toy.ROOT / "python/salbench/_core.pyi").read_text(encoding="utf-8"))
        classes = {node.name: {part.name for part in node.body} for node in stub.body if isinstance(node, ast.ClassDef)}
        functions = {node.name for node in stub.body if isinstance(node, ast.FunctionDef)}
        values = {node.target.id for node in stub.body if isinstance(node, ast.AnnAssign)}
        self.assertEqual(plain({*classes, *functions, *values}), plain(vars(_core)))
        for name, parts in classes.items():
            self.assertEqual(plain(parts), plain(vars(getattr(_core, name))), name)
