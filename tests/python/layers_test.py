# SPDX-License-Identifier: GPL-3.0-or-later
"""The layers of the Python package, as tests/layers.sh holds those of C++: what a part imports of the package, also within functions."""

import ast
import sys
import unittest
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[2] / "python/salbench"
ONLY = {  # beside itself and what is compiled
    "system": set(),
    "pages": {"conclusions", "system"},
    "shapes": {"pages", "system"},
    "models": {"datasets", "shapes", "system"},
    "datasets": {"shapes", "system"},
    "conclusions": {"_version", "models", "runs", "system"},
    "runs": {"__main__", "conclusions", "datasets", "leaderboard", "models", "shapes", "system"},
    "report": {"conclusions", "pages", "runs", "system"},
    "leaderboard": {"conclusions", "models", "pages", "runs", "shapes", "system"},
}
NEVER = {"": {"commands", "report"}}  # modules of the package itself, but for the one that starts subcommands
STARTS_SUBCOMMANDS = "__main__.py"


def imported(text):
    """(line, part of the package) of each import; the package as a whole is "salbench"."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom) and node.level == 0:
            names = [f"{node.module}.{name.name}" for name in node.names]
        elif isinstance(node, ast.Import):
            names = [name.name for name in node.names]
        else:
            continue
        for first, *others in (name.split(".") for name in names):
            if first == "salbench":
                yield node.lineno, others[0] if others else first


def modules():
    """Each module of the package, by its name: the file."""
    inside = {path: path.relative_to(PACKAGE.parent).with_suffix("").parts for path in PACKAGE.rglob("*.py")}
    return {".".join(parts[:-1] if parts[-1] == "__init__" else parts): path for path, parts in inside.items()}


def imports_of(text, known):
    """The modules, of those known, that a text imports: also within functions, and for types alone."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom):
            for name in node.names:
                whole = f"{node.module}.{name.name}"
                yield from {whole if whole in known else node.module} & known
        elif isinstance(node, ast.Import):
            yield from {name.name for name in node.names} & known


def circles(imports):
    """Groups of modules each of which leads to all others of its group, by the modules that each imports."""
    def reached(start):
        found, left = set(), [start]
        while left:
            for name in imports[left.pop()] - found:
                found.add(name)
                left.append(name)
        return found

    reach = {name: reached(name) for name in imports}
    return sorted({tuple(sorted({name} | {other for other in reach[name] if name in reach[other]})) for name in imports if name in reach[name]})


def breaches(part, text):
    """part: a subpackage, or "" for the package itself."""
    for line, name in imported(text):
        if name in NEVER.get(part, ()) or (part in ONLY and name not in (part, "_core", *ONLY[part])):
            yield line, name


class Layers(unittest.TestCase):
    def test_each_part_imports_what_stands_above_it(self):
        found = []
        for path in sorted(PACKAGE.rglob("*.py")):
            inside = path.relative_to(PACKAGE)
            if str(inside) != STARTS_SUBCOMMANDS:
                part = inside.parts[0] if len(inside.parts) > 1 else ""
                found += [f"{inside}:{line}: imports {name}" for line, name in breaches(part, path.read_text(encoding="utf-8"))]
        self.assertEqual(found, [])

    def test_no_modules_import_each_other(self):
        """The package itself and __main__, which import whatever they are asked for, are no part of a circle."""
        known = modules()
        imports = {name: set(imports_of(path.read_text(encoding="utf-8"), known.keys())) - {"salbench"} for name, path in known.items()
                   if name not in ("salbench", "salbench.__main__")}
        self.assertEqual(circles(imports), [])
        text = "def f():\n    from salbench import a\nif TYPE_CHECKING:\n    from salbench.b import B\n"
        self.assertEqual(set(imports_of(text, {"salbench.a", "salbench.b"})), {"salbench.a", "salbench.b"})
        self.assertEqual(circles({"a": {"b"}, "b": {"c"}, "c": {"b", "d"}, "d": set(), "e": {"e"}}), [("b", "c"), ("e",)])

    def test_conclusions_stand_on_arrays_and_frames(self):
        """Few libraries; and files are the matter of some modules alone."""
        for path in (PACKAGE / "conclusions").glob("*.py"):
            nodes = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
            found = [name for node in nodes if isinstance(node, (ast.Import, ast.ImportFrom))
                     for name in ([node.module] if isinstance(node, ast.ImportFrom) else [alias.name for alias in node.names])]
            tops = {name.split(".")[0] for name in found}
            self.assertLessEqual(tops - sys.stdlib_module_names, {"numpy", "pandas", "scipy", "salbench", "yaml"}, path.name)
            if path.stem not in ("folders", "papers", "scores", "parallel", "__init__"):
                self.assertFalse(tops & {"pathlib", "os", "yaml", "tempfile"}, path.name)

    def test_no_import_is_relative(self):
        for path in PACKAGE.rglob("*.py"):
            nodes = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
            self.assertFalse([node.lineno for node in nodes if isinstance(node, ast.ImportFrom) and node.level], path)
