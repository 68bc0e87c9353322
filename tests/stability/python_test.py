# SPDX-License-Identifier: GPL-3.0-or-later
"""Calls of the Python package that were right stay right: python.txt has its names and signatures."""

import dis
import inspect
import math
import unittest

import salbench

import support

MODULES = (salbench, salbench.metrics, salbench.models, salbench.datasets)  # with all that their __all__ lists
FURTHER = (("salbench.stats.conclude", salbench.stats.conclude), ("salbench.stats.Conclusions", salbench.stats.Conclusions))


def signature(what):
    """Without types; none of what cannot be called."""
    found = inspect.signature(what)
    bare = [each.replace(annotation=each.empty, default=[] if repr(each.default) == "<factory>" else each.default) for each in found.parameters.values()]
    return found.replace(parameters=bare, return_annotation=found.empty)


def members(kind):
    """Public methods and fields of a class, and what it makes of itself when it is made; those of tuples and such left out."""
    named = {name for each in kind.__mro__ for name in [*vars(each), *vars(each).get("__annotations__", {})]}
    if inspect.isfunction(kind.__init__):
        named |= {step.argval for step in dis.get_instructions(kind.__init__) if step.opname == "STORE_ATTR"}
    return sorted(name for name in named - set(dir(tuple)) - set(dir(dict)) if name[0] != "_")


def lines():
    """NAME or NAME(PARAMETERS) of everything public."""
    named = [(f"{module.__name__}.{name}", getattr(module, name)) for module in MODULES for name in module.__all__] + list(FURTHER)
    for name, what in named:
        if not inspect.ismodule(what):
            yield f"{name}{signature(what)}" if callable(what) else name
        if inspect.isclass(what):
            for member in members(what):
                value = inspect.getattr_static(what, member, None)
                yield f"{name}.{member}{signature(value)}" if inspect.isfunction(value) else f"{name}.{member}"


def parsed(line):
    """Name and signature of a line; None of a name that is no function."""
    name, bracket, parameters = line.partition("(")
    if not bracket:
        return name, None
    names = {"inf": math.inf}
    exec(f"def function({parameters}: pass", names)  # noqa: S102: our own text
    return name, signature(names["function"])


def breaks(old, today):
    """Calls by the old signature that today's refuses; empty: none. New parameters need a default, behind the old ones."""
    if old is None:
        return ""
    if today is None:
        return "is no function any more"
    needed = {name for name, each in old.parameters.items() if each.default is each.empty}
    today = today.replace(parameters=[each.replace(default=each.empty) if each.name in needed else each for each in today.parameters.values()])
    added = [each for each in today.parameters.values() if each.name not in old.parameters]
    if {name: each for name, each in today.parameters.items() if name in old.parameters} != dict(old.parameters):
        return "lacks a parameter, or has another kind or default of it"
    before, now = ([each for each in them.parameters.values() if each.kind == each.POSITIONAL_OR_KEYWORD] for them in (old, today))
    if now[:len(before)] != before:
        return "takes places in another order"
    further = [each.name for each in added if each.default is each.empty and each.kind not in (each.VAR_POSITIONAL, each.VAR_KEYWORD)]
    return f"needs {', '.join(further)}" if further else ""


class Python(unittest.TestCase):
    def test_what_was_public_is_and_takes_what_it_took(self):
        today = dict(map(parsed, lines()))
        for line in (support.EXAMPLES / "python.txt").read_text(encoding="utf-8").splitlines():
            name, old = parsed(line)
            with self.subTest(name):
                self.assertIn(name, today)
                self.assertEqual(breaks(old, today[name]), "")

    def test_a_break_is_seen(self):
        old = "f(a, b=1, *, c=2)"
        for today, expected in (("f(a, b=1, d=None, *, e=3, c=2, **more)", ""), ("f(a=0, b=1, *, c=2)", ""), ("f(a, b=1, *, c=3)", "lacks"), ("f(b=1, *, c=2)", "lacks"),
                                ("f(a, d=None, b=1, *, c=2)", "takes"), ("f(a, b=1, *, c=2, d)", "needs d"), ("f", "is no")):
            self.assertTrue(breaks(parsed(old)[1], parsed(today)[1]).startswith(expected), today)
