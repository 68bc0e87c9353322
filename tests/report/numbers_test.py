# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers that cannot be computed with: infinite, huge or missing ones count as undefined, the report says so, and nothing is
written to the error stream."""

import shutil
import unittest
import warnings
from pathlib import Path

import h5py
import numpy
import pandas

import fixture
import support
from salbench import conclusions
from salbench.report.exports import unit_range
from salbench.report.results import Shown, number_of
from tests.support import forked

ITEMS = fixture.eight_meshes()[:3]
MODELS = ("LS", "HS", "RS")
NAMES = ("auc", "cc", "kl")


class Splits(unittest.TestCase):
    def test_conclusions_are_those_of_all_splits_together(self):
        folder = Path(self.enterContext(support.tempfile.TemporaryDirectory()))

        def write_summary(*rows):
            known = pandas.DataFrame([("meshes", split, "PS", "cc", n, mean) for split, n, mean in rows],
                                     columns=["dataset", "split", "model", "metric", "n", "mean"])
            known.reindex(columns=dict.fromkeys([*known, *conclusions.empty("summary")])).to_csv(folder / "summary.csv", index=False)
        write_summary(("", 3, 0.5), ("train", 2, 0.4), ("test", 1, 0.7))
        (folder / "results.csv").write_text("dataset,split,item,class,view,model,cc\nmeshes,train,a,,,PS,0.1\nmeshes,test,b,,,PS,0.7\n")
        results = Shown(folder)
        self.assertEqual(list(results.table("summary")["mean"]), [0.5])
        self.assertEqual(list(results.table("results")["split"]), ["train", "test"])
        write_summary(("test", 1, 0.7))
        self.assertEqual(list(Shown(folder).table("summary")["mean"]), [0.7])


class Numbers(unittest.TestCase):
    def test_of_a_table_are_counted_where_they_cannot_be_used(self):
        folder = Path(self.enterContext(support.tempfile.TemporaryDirectory()))
        (folder / "run.yaml").write_text("")
        (folder / "mean_histograms_meshes.csv").write_text("bin_left,a,b\n0,inf,\n1,-inf,\n2,1e150,\n3,-1e151,nan\n")
        results = Shown(folder)
        table = results.table("mean_histograms_meshes")
        self.assertEqual(results.unusable, ["mean_histograms_meshes.csv holds 3 numbers that are infinite or beyond 1e+150: they count as undefined."])
        self.assertEqual(table["a"].dropna().tolist(), [1e150])
        self.assertTrue(table["b"].isna().all())

    def test_of_run_yaml(self):
        self.assertEqual([number_of(text, -1) for text in ("2.5", "inf", "-1e200", "x", None)], [2.5, -1, -1, -1, -1])
        self.assertNotEqual(number_of("nan"), number_of("nan"))

    def test_the_range_of_a_map_does_not_overflow(self):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            self.assertEqual(unit_range([-1.7e308, 0, 1.7e308]).tolist(), [0, 0.5, 1])
            self.assertEqual(unit_range([5e-324, 5e-324]).tolist(), [0, 0])


class OddNumbers(support.ReportTest):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        results = fixture.with_metrics(fixture.results_table(ITEMS, MODELS, views=1), NAMES)
        cls.whole = cls.folder / "whole"
        fixture.write_results(cls.whole, ITEMS, MODELS, results=results, extra=fixture.metric_lines(NAMES))
        fixture.write_costs(cls.whole)

    def odd(self, name, file, rows, *values):
        """A copy of the results with these values, in turns, in the rows of every column of numbers."""
        out = self.folder / name
        if not out.exists():
            shutil.copytree(self.whole, out)
        table = pandas.read_csv(out / file, dtype=str, keep_default_na=False)
        for place, at in enumerate(range(len(table))[rows]):
            for column in table:
                if conclusions.type_of(Path(file).stem, column) != "str":
                    table.loc[at, column] = values[place % len(values)]
        table.to_csv(out / file, index=False)
        return out

    def expect_quiet(self, name, out):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            self.assertEqual(support.make(out, self.folder / f"{name}-report"), (0, ""))
        for path in (self.folder / f"{name}-report").rglob("*.html"):
            self.assertNotRegex(path.read_text(encoding="utf-8"), r">\s*[-−]?(inf|nan)\b", path)
        return self.folder / f"{name}-report"

    def test_in_each_table(self):
        """Every table in every case; six tables in a report, two in each case."""
        files = sorted(path.name for path in self.whole.glob("*.csv"))
        cases = ((slice(None), ["inf", "1e308", "-1e308", "0.5"]), (slice(None), [""]), (slice(None), ["0"]))
        for at in range(0, len(files), 2):
            name = f"odd-{files[at]}"
            for place, (rows, values) in enumerate(cases):
                for one in (at, at + 1):
                    out = self.odd(name, files[(one + 5 * place) % len(files)], rows, *values)
            with self.subTest(name), support.without_figures():
                self.expect_quiet(name, out)

    def test_the_report_says_so_and_shows_a_dash(self):
        out = self.odd("said", "results.csv", slice(0, 2), "inf")
        with support.without_figures():
            to = self.expect_quiet("said", out)
        cells = len(NAMES) + 2  # with two counts
        for path in ("index.html", "run.html", "shapes/1.html"):
            self.assertIn(f"results.csv holds {2 * cells} numbers that are infinite", support.page(to, path))
        self.assertEqual(support.rows(support.page(to, "shapes/1.html"), "mesh-scores")[0][:2], ["LS", "–"])

    def test_drawn_by_the_command_nothing_is_on_its_error_stream(self):
        for file in ("results.csv", "summary.csv", "per_class.csv", "human_curve.csv", "mean_histograms_meshes.csv", "costs.csv"):
            out = self.odd("drawn", file, slice(0, None, 5), "inf", "", "-1e308")
        with h5py.File(out / "shapes.h5", "w"):
            pass
        fixture.write_export(out / "shapes.h5", ITEMS, MODELS, views=1, size=32)
        with h5py.File(out / "shapes.h5", "r+") as file:
            file["1/map.LS/saliency"][:2] = 1.7e308, -1.7e308
            file["1_0/scan/points"][0] = file["1_0/scan/camera"][()]
            file["2/picture/weights"][...] = 0
            file["2/picture/view_projection"][...] = 0
            file["3/ground_truth/saliency"][...] = numpy.nan
            file["3/picture/view_projection"][3] = 0
        done = forked.salbench("report", out, "--to", self.folder / "drawn-report", "--quiet", "--metrics", "auc",
                               before=lambda: warnings.simplefilter("error", RuntimeWarning))
        self.assertEqual(done.stderr, "")
        self.assertEqual(done.returncode, 0)
