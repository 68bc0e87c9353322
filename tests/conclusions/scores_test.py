# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of anybody's scores: what is read of them, and what is refused, with its line. Slips that would pass for results, on the command line and
in Python."""

import contextlib
import io

import numpy as np
import pandas

from salbench import __main__, stats
from salbench.conclusions import tables
from salbench.conclusions.scores import read_results, read_scores
from salbench.system.csv import read_csv, require
from salbench.system.errors import InputError
from support import AUC, InAFolder


class FileTest(InAFolder):
    def write(self, text, name="scores.csv"):
        path = self.folder / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    def refused(self, message, read, *arguments, **options):
        with self.assertRaises(InputError) as caught:
            read(*arguments, **options)
        self.assertEqual(str(caught.exception), f"{self.folder}/{message}")


class Csv(FileTest):
    def test_texts_and_numbers(self):
        table = read_csv(self.write('# one\n# two\na,b\n\n"x, ""y""\n",\r\n,1e-3\nz,nan\nNA,NA\n'), {"b"}.__contains__)
        self.assertEqual(table.attrs["remarks"], ["one", "two"])
        self.assertEqual(table["a"].tolist(), ['x, "y"\n', "", "z", "NA"])
        np.testing.assert_array_equal(table["b"], [np.nan, 1e-3, np.nan, np.nan])
        self.assertEqual(table.index.tolist(), [5, 7, 8, 9])

    def test_remarks_are_whole_lines_and_all_of_them_are_warned_of(self):
        path = self.write('# PARTIAL: 1 of 2, so far\n\n#SIMULATED: by "chance\nitem,model,auc\n1,A,.5\n1,B,x\n')
        self.assertEqual(read_csv(path).attrs["remarks"], ["PARTIAL: 1 of 2, so far", 'SIMULATED: by "chance'])
        self.assertEqual(read_csv(path).index.tolist(), [5, 6])
        self.refused("scores.csv:6: 'x' is not a number", read_csv, path, {"auc"}.__contains__)
        notes = read_scores(self.write("# a, b\n# c\nitem,model,auc\n1,A,.5\n"))[1]
        self.assertEqual([note.split(": ", 1)[1] for note in notes], ["a, b", "c"])

    def test_a_column_of_remarks_is_none_of_the_table(self):
        for text in ("item,model,auc,remarks\n1,A,.5,x | y || z\n1,B,.5,x | y || z\n", "# x\nitem,model,auc,remarks\n1,A,.5,\n1,B,.5,y || z\n",
                     "item,remarks,model,auc\n1,x,A,.5\n1,y || z | x,B,.5\n", "# x\n# y | z\nitem,model,auc\n1,A,.5\n1,B,.5\n"):
            path = self.write(text)
            for numeric in ((), ("auc",)):
                table = read_csv(path, numeric.__contains__)
                self.assertEqual((list(table), table.attrs["remarks"]), (["item", "model", "auc"], ["x", "y | z"]), text)
            self.assertEqual((read_scores(path)[1], read_results(path, [AUC])[1]), ([f"{path}: x", f"{path}: y | z"], ["x", "y | z"]), text)
        rows = "".join(f"{k},A,.5,of row {k}\n" for k in range(12))
        notes = read_scores(self.write("item,model,auc,remarks\n" + rows))[1]
        self.assertEqual([note.split(": ", 1)[1] for note in notes[-2:]] + [len(notes)], ["of row 9", "and 2 further remarks", 11])
        self.assertEqual(read_scores(self.write("item,model,remarks\n1,A,.5\n"), ["remarks"])[0].frame["remarks"].tolist(), [.5], "if it is asked for")

    def test_tables_have_their_remarks_in_a_last_column(self):
        frame = pandas.DataFrame({"model": ["A", "B"], "auc": [.5, 1]})
        for remarks, expected in (((), "model,auc\nA,0.5\nB,1\n"), (["x, y"], 'model,auc,remarks\nA,0.5,"x, y"\nB,1,"x, y"\n'),
                                  (["a | b", "|", "||c d|"], "model,auc,remarks\nA,0.5,a || b | || | ||||c d||\nB,1,a || b | || | ||||c d||\n")):
            self.assertEqual(tables.csv(frame, remarks), expected)
            self.assertEqual(read_csv(self.write(expected)).attrs["remarks"], list(remarks))
        self.assertEqual(tables.csv(frame[:0], ["x"]), "model,auc,remarks\n")

    def test_any_bytes_are_a_name(self):
        self.assertEqual(read_csv(self.write(b"\xef\xbb\xbfa\n\xff\n"))["a"].tolist(), ["\udcff"])

    def test_what_is_wrong_is_named_with_its_line(self):
        for text, message in (
                ("", "the file is empty, where a line of column names is expected"),
                ("a;b\n1;2\n", ":1: separated by ';': save it with commas between fields and decimal points"),
                ("a\tb\n", ":1: separated by '\\t': save it with commas between fields and decimal points"),
                ("a,b\n".encode("utf-16"), "is in UTF-16: save it as UTF-8"),
                ("a,b\n1,2\n1\n", ":3: the line has 1 fields, the header 2"), ("a,a\n", ':1: two columns are named "a"'),
                ('a\n1\n"2\n', ":3: a quote opens a field that nothing closes"), ("a,b\n1,x\n", ":2: 'x' is not a number"),
                ('a,b\n"1"x,2\n', ":2: there is text after the quote that closes a field")):
            separator = "" if message.startswith(":") else ": "
            self.refused(f"scores.csv{separator}{message}", read_csv, self.write(text), {"b"}.__contains__)
        for cell in ("1_000", " 1", "1 ", "\t1", "１"):  # Python takes them for numbers
            self.refused(f"scores.csv:2: '{cell}' is not a number", read_csv, self.write(f"a,b\n.5,{cell}\n"), {"a", "b"}.__contains__)
        self.refused('scores.csv: there is no column "c"; there are "a", "b"', require, read_csv(self.write("a,b\n")), "c")


class ScoreFiles(FileTest):
    def values(self, text, **options):
        found = read_scores(self.write(text), **options)[0]
        return found.frame[[metric.name for metric in found.metrics]].values.tolist()

    def test_rows_with_a_view_are_scans(self):
        scores, notes = read_scores(self.write(",item,view,model,nss,auc\n0,1,,LS,2,.5\n1,1,3,LS,,.7\n"))
        self.assertEqual(scores.frame["dataset"].tolist(), ["meshes", "scans"])
        self.assertEqual([metric.name for metric in scores.metrics], ["auc", "nss"], "in the program's order")
        np.testing.assert_array_equal(scores.frame[["auc", "nss"]], [[.5, 2], [.7, np.nan]])
        self.assertEqual(notes, [])

    def test_lcc_is_a_magnitude_and_is_not_made_of_cc(self):
        self.assertEqual(self.values("item,model,cc\n1,LS,-.5\n"), [[-.5]])
        self.assertEqual(self.values("item,model,cc,lcc\n1,LS,-.5,-.25\n"), [[-.5, .25]])

    def test_other_columns_count_if_they_are_named(self):
        text = "item,model,auc,mine,error\n1,LS,.5,3,4\n"
        path = self.write(text)
        self.assertEqual(read_scores(path)[1], [f"{path}: columns that are no metrics of the program were left out: mine, error; name them "
                                                "with --higher or --lower"])
        scores, _ = read_scores(path, ["mine"], ["error"])
        self.assertEqual([(metric.name, metric.higher_is_better) for metric in scores.metrics],
                         [("auc", True), ("mine", True), ("error", False)])
        self.assertEqual(self.values(text, higher=["mine"], lower=["error"]), [[.5, 3, 4]])

    def test_columns_of_names_are_no_scores(self):
        path = self.write("item,class,model,auc\n1,cup,LS,.5\n")
        for name in ("item", "model", "class", "view"):
            with self.assertRaisesRegex(InputError, f"^--higher {name}: is a column of names"):
                read_scores(path, [name])
            with self.assertRaisesRegex(InputError, f"^--lower {name}: is a column of names"):
                read_scores(path, lower=[name])

    def test_classes_come_from_a_file_of_their_own(self):
        path, classes = self.write("item,model,auc\n1,LS,.5\n2,LS,.5\n"), self.write("item,class\n1,cup\n", "classes.csv")
        scores, notes = read_scores(path, classes=classes)
        self.assertEqual(scores.frame["class"].tolist(), ["cup", ""])
        self.assertRegex(notes[0], 'classes.csv: .* 1 of the items, such as "2"')
        self.refused("classes.csv:3: item '1' has a class already", read_scores, path, classes=self.write("item,class\n1,cup\n1,ant\n", "classes.csv"))

    def test_bad_tables_are_refused_by_line(self):
        for text, message in (
                ("item,model\n1,LS\n", ": no column is a metric; name the columns of scores with --higher or --lower; there are item, model"),
                ("model,auc\nLS,.5\n", ': there is no column "item"; there are "model", "auc"'),
                ("item,model,auc\n1,LS,good\n", ":2: 'good' is not a number"),
                ("item,model,auc\n1,LS,inf\n", ":2: auc is infinite: no score can be"),
                ("item,model,auc\n1,LS,.5\n1,LS,.6\n", ":3: a second row of item '1', model 'LS'"),
                ("item,view,model,auc\n1,7,LS,.5\n1,7,LS,.6\n", ":3: a second row of item '1', view 7, model 'LS'"),
                ("dataset,item,model,auc\nshapes,1,LS,.5\n", ":2: data set 'shapes', expected one of meshes, scans, clouds"),
                ("item,model,auc\n", ": no scores below the names of the columns")):
            self.refused("scores.csv" + message, read_scores, self.write(text))
        self.refused("scores.csv: no column 'mine'", read_scores, self.write("item,model,auc\n1,LS,.5\n"), ["mine"])

    def test_results_of_a_run_have_its_metrics_alone_and_may_have_no_rows(self):
        known = read_scores(self.write("item,model,cc,auc\n1,LS,.5,.5\n"))[0].metrics
        chosen = [metric for metric in known if metric.name == "cc"]
        scores, remarks = read_results(self.write("# PARTIAL: so far\ndataset,item,class,view,model,cc,auc,n_points,n_picks\n"), chosen)
        self.assertEqual((scores.metrics, len(scores.frame), remarks), (tuple(chosen), 0, ["PARTIAL: so far"]))


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


class SlipsTest(InAFolder):
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
