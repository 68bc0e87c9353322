# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables with slips that would pass for results: each is refused with its line, or has the right answer; on the command line and in Python."""

import contextlib
import io
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pandas

from salbench import __main__, stats

ROWS = [(str(item), model, .5 + .01 * (item % 7) + (.1 if model == "A" else 0) + .001 * (item % 3)) for item in range(1, 61) for model in "ABC"]


def table(*more, change=lambda item, model, value: (item, model, value), columns="item,model,auc"):
    rows = [change(*row) for row in ROWS]
    return columns + "\n" + "".join(",".join(f'"{cell}"' if isinstance(cell, str) else repr(cell) for cell in row) + "\n" for row in [*rows, *more])


def of_item_3(value):
    return table(change=lambda item, model, own: (item, model, value if (item, model) == ("3", "B") else own))


REFUSED = {  # what, its table, further arguments, what is said
    "a score whose square overflows": (table(columns="item,model,nss", change=lambda i, m, v: (i, m, 1e308 if i == "3" else v)), (),
                                       r":8: nss is 1e\+308, the largest of all: squares of such numbers cannot be computed"),
    "scores whose squares vanish": (table(change=lambda i, m, v: (i, m, v * 1e-310)), (), "auc is .*e-311, the largest of all: squares"),
    "percent": (table(change=lambda i, m, v: (i, m, 100 * v)), (), ":2: auc is 61.1, and can be 0 to 1: is it in percent"),
    "a row of a stray model": (table(("3", "D", .9)), (), ":182: model 'D' has auc on 1 of 60 meshes, and models are compared on the shapes that all"),
    "one item in two spellings": (table(change=lambda i, m, v: ("0" + i if m == "B" else i, m, v)), (), ":3: item '01' is '1' of a row above in ano"),
    "a blank behind a model": (table(change=lambda i, m, v: (i, m + " " * (i == "3"), v)), (), ":8: model 'A ' is 'A' of a row above in another sp"),
    "a model that is called as the mean": (table(change=lambda i, m, v: (i, m.replace("C", "Avg"), v)), (), ":4: model 'Avg' is the mean over all models"),
    "a model without a name": (table(("3", "", .9)), (), ":182: the row names no model"),
    "an item without a name": (table(("", "A", .9)), (), ":182: the row names no item"),
    "a line break in a name": (table(("3", "a\nb", .9)), (), r"model 'a\\nb' has a comma, a line break or another control character"),
    "a comma in a model": (table(change=lambda i, m, v: (i, m.replace("C", "C, D"), v)), (), ":4: model 'C, D' has a comma"),
    "an item in two classes": (table(columns="item,model,auc,class", change=lambda i, m, v: (i, m, v, "cup" if (i, m) != ("3", "B") else "ant")), (),
                               ":9: item '3' is of class 'ant' here, and of class 'cup' above"),
    "classes that are not there": (table(), ("--unit", "class"), "unit class: no item has a class"),
    "a metric turned round": (table(), ("--lower", "auc"), "--lower auc: higher values of it would be better"),
    "a column in both directions": (table(columns="item,model,mine"), ("--lower", "mine", "--higher", "mine"), "--lower mine: both higher and lower"),
}


class SlipsTest(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def call(self, text, *arguments):
        (self.folder / "scores.csv").write_text(text)
        errors = io.StringIO()
        with contextlib.redirect_stderr(errors), contextlib.redirect_stdout(io.StringIO()):
            status = __main__.main(["conclude", str(self.folder / "scores.csv"), "--out", str(self.folder / "out"), "--quiet", *arguments])
        return status, errors.getvalue()

    def test_each_is_refused(self):
        for what, (text, arguments, said) in REFUSED.items():
            with self.subTest(what):
                status, errors = self.call(text, *arguments)
                self.assertEqual((status, errors.count("\n")), (2, 1), errors)
                self.assertRegex(errors, said)

    def test_python_refuses_the_same(self):
        for what, (text, arguments, _) in REFUSED.items():
            options = {f"{name[2:]}_is_better" if name != "--unit" else "unit": value for name, value in zip(arguments[::2], arguments[1::2])}
            with self.subTest(what), self.assertRaises(ValueError):
                stats.conclude(pandas.read_csv(io.StringIO(text), dtype={"item": str, "model": str}), **options)

    def test_what_only_looks_like_a_slip_passes(self):
        self.assertEqual(self.call(table())[0], 0)
        self.assertEqual(self.call(table(columns="item,model,mine"), "--higher", "mine,mine")[0], 0)
        self.assertEqual(self.call(table(), "--higher", "auc")[0], 0)
        self.assertEqual(self.call(of_item_3(1 + 1e-12))[0], 0)
        commas = table(columns="item,model,auc,class", change=lambda i, m, v: (f"cup, {i}", m, v, "cups, mugs"))
        self.assertEqual(self.call(commas)[0], 0)
        splits = table(columns="item,model,auc,split", change=lambda i, m, v: (i, m, v, "train" if int(i) > 20 else "test"))
        self.assertEqual(self.call("\n".join(line for line in splits.splitlines() if '"C"' not in line or "test" in line))[0], 0)

    def test_scores_that_are_0_but_for_rounding_lead_nobody(self):
        text = table(columns="item,model,auc,nss", change=lambda i, m, v: (i, m, v, 1e-310 if m == "A" else 0.0 if i != "1" else 1.0))
        self.assertEqual(self.call(text)[0], 0)
        leaders = pandas.read_csv(self.folder / "out/leaders.csv")
        self.assertEqual(leaders["verdict"][2], "not told apart")

    def test_python_has_leaders_and_the_compact_table(self):
        scores = pandas.read_csv(io.StringIO(table()), dtype={"item": str})
        found = stats.conclude(scores)
        self.assertEqual(list(found.leaders["leaders"])[1:], ["A"])
        self.assertEqual(list(found.compact["model"]), ["A", "B", "C"])
        none = scores.assign(model=scores["model"].where(scores["model"] != "B", np.nan))
        with self.assertRaisesRegex(ValueError, "^table:1: the row names no model$"):
            stats.conclude(none)
        unscored = scores.assign(auc=scores["auc"].where(scores["model"] != "B"))  # a model without scores ranks nowhere, and keeps nobody from it
        self.assertEqual(list(stats.conclude(unscored).ranking["n"]), [60, 60])
