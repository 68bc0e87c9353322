# SPDX-License-Identifier: GPL-3.0-or-later
"""Results folders that lack something: the report says what is missing where it would stand, and still opens."""

import atexit
import functools
import re
import shutil
import tempfile
from pathlib import Path

import pandas

import fixture
import support

ITEMS = fixture.eight_meshes()[:6]  # as few as are ranked
SCORES = fixture.results_table(ITEMS, views=2)
METRICS = {"small": ("auc", "cc"), "with a menu": ("auc", "nss", "lcc", "cc")}  # a fourth stands on a page of its own
PEOPLE = ("human_curve_differences.csv", "human_equivalents.csv", "human_share.csv", "human_reliability.csv")
OF_NO_PAGE = ("ranking_agreement.csv", "human_curve_differences.csv")  # for whoever reads tables
OTHERS = ("per_class.csv", "significance.csv", "ranking.csv", "ranking_agreement.csv", "human_curve.csv", *PEOPLE, "mean_histograms_meshes.csv")
READ_FIRST = ("results.csv", "summary.csv", "per_class.csv", "significance.csv", "ranking.csv", "human_share.csv")  # which tables stand on alone
NO_TABLES = (b"", b"\xff\xfe\x00\x01garbage\n\n,,,\n", b"one,two\n1,2\n")


@functools.cache
def sound(name):
    """The folder of results that are to be spoilt."""
    folder = Path(tempfile.mkdtemp())
    atexit.register(shutil.rmtree, folder)
    if name == "whole":
        fixture.write_results(folder, ITEMS, results=SCORES)
    else:
        scores = fixture.with_metrics(fixture.results_table(ITEMS[:2], ("LS", "RS"), views=1), METRICS[name])
        fixture.write_results(folder, ITEMS[:2], ("LS", "RS"), results=scores, extra=fixture.metric_lines(METRICS[name]))
    return folder


class BadInputTest(support.ReportTest):
    """Small folders."""
    words = ()  # of the command

    def full(self, name, **options):
        if options:
            fixture.write_results(self.folder / name, ITEMS, **{"results": SCORES, **options})
        else:
            shutil.copytree(sound("whole"), self.folder / name)
        return self.folder / name

    def small(self, name, of="small"):
        """Two meshes, two scans, two models, two or four metrics."""
        return Path(shutil.copytree(sound(of), self.folder / name))

    def made(self, name):
        """Makes the report; every page is complete HTML. Returns the index."""
        to = self.report(name, *self.words)
        for path in to.rglob("*.html"):
            self.assertTrue(path.read_text(encoding="utf-8").rstrip().endswith("</html>"), path)
        return support.page(to)

    def expect_named(self, files, index):
        """Pages say of each file that it is not what a run wrote, and of those that tables stand on alone that they are none."""
        for file, content in files.items():
            if file == "run.yaml":
                said = "protocol the scores are|run.yaml is missing"
            elif file.startswith("mean_histograms"):  # of which conclusions have no digest
                continue
            else:
                said = rf"{file}[\w., ]* changed after conclusions were drawn"
                if file in READ_FIRST and content in NO_TABLES:
                    self.assertTrue(re.search(f"{file} (cannot be read|has no column)", index), file)
            self.assertTrue(re.search(said, index), file)


class BadInput(BadInputTest):
    def test_no_results_folder_is_one_line_and_status_2(self):
        (self.folder / "empty").mkdir()
        (self.folder / "file").write_text("x")
        for name in ("nowhere", "empty", "file"):
            status, errors = support.make(self.folder / name, self.folder / "to")
            self.assertEqual(status, 2)
            self.assertEqual(len(errors.strip().splitlines()), 1)
            self.assertIn(name, errors)
        self.assertFalse((self.folder / "to").exists())

    def test_each_file_may_be_missing(self):
        """Alone those that all pages read, the others in three groups."""
        for names in (("results.csv",), ("summary.csv",), ("run.yaml", *OTHERS[1::3]), ("mean_histograms_scans.csv", *OTHERS[::3]), OTHERS[2::3]):
            with self.subTest(names):
                folder = f"without-{names[0]}"
                out = self.small(folder, "with a menu")
                for name in names:
                    (out / name).unlink()
                index = self.made(folder)
                run = support.page(self.folder / f"{folder}-report", "run.html")
                if names == ("summary.csv",):  # without which the report draws conclusions again
                    self.assertTrue((out / "summary.csv").is_file())
                    continue
                for name in filter(lambda name: name not in OF_NO_PAGE, names):
                    self.assertIn(f"{name} is ", run if name == "run.yaml" else index)

    def test_each_table_may_be_empty_or_no_table(self):
        """Every file with every content: alone the tables that all pages read, the others by halves."""
        halves = (("results.csv",), ("summary.csv",), ("run.yaml", *OTHERS[::2]), OTHERS[1::2])
        spoilt = [dict.fromkeys(half, content) for half in halves for content in NO_TABLES]
        for files in spoilt:
            with self.subTest(files):
                out = self.small("spoilt")
                for name, content in files.items():
                    (out / name).write_bytes(content)
                self.expect_named(files, self.made("spoilt"))
                shutil.rmtree(out)

    def test_a_run_that_was_ended_before_its_end(self):
        out = self.small("ended")
        (out / "run.yaml").write_text("# a run is under way, or was ended before its end\nprogram: salbench 2.0.0\nconfiguration: {seed: 1}\n")
        index = self.made("ended")  # beside the tables of the run before it
        run = support.page(self.folder / "ended-report", "run.html")
        self.assertEqual((run.count("was ended before its end"), run.count("<section"), "the-configuration" in run, "Missing" in run), (1, 1, True, False))
        self.assertIn("results.csv may be of an earlier run", index)
        self.assertNotIn('id="table-', support.page(self.folder / "ended-report", "statistics.html"))
        self.assertEqual(support.make(out, self.folder / "to", "--figure", "shapes=1")[0], 2)
        for path in out.glob("*.csv"):
            path.unlink()
        index = self.made("ended")
        self.assertIn("results.csv is not in the results folder", index)
        self.assertIn("The run did not end", index)

    def test_every_page_says_what_is_special_about_a_run(self):
        out = self.small("edited")
        for name, before, after in (("run.yaml", "results: finished", "results: partial, 3 of 8 shapes have all scores"),
                                    ("results.csv", ",0.", ",0.9"), ("summary.csv", ",0.", ",0.9")):
            (out / name).write_text((out / name).read_text().replace(before, after, 1))
        self.made("edited")
        self.expect_everywhere("edited", "partial, 3 of 8 shapes")
        self.expect_everywhere("edited", "results.csv, summary.csv changed after conclusions were drawn")

    def expect_everywhere(self, name, said):
        for path in (self.folder / f"{name}-report").rglob("*.html"):
            self.assertIn(said, path.read_text(encoding="utf-8"), path)

    def test_simulated_participants_have_no_verdicts_and_every_page_says_so(self):
        self.full("simulated", simulated=True)
        self.report("simulated", "--metrics", "auc")
        self.expect_everywhere("simulated", "Simulated participants")
        self.assertIn("SIMULATED", (self.folder / "simulated-report/data/classes-meshes-auc.tex").read_text())

    def test_a_ground_truth_may_have_the_word_simulated_in_its_name(self):
        out = self.small("museum")
        (out / "run.yaml").write_text("# TRUTH: gaze of people in a simulated museum\n" + (out / "run.yaml").read_text())
        self.made("museum")
        page = support.page(self.folder / "museum-report")
        self.assertIn("TRUTH: gaze of people in a simulated museum", page)
        self.assertNotIn("the program made the ground truth", page)
        self.assertNotIn("changed after conclusions", page)

    def test_failed_items_stand_with_their_causes(self):
        failed = [(item, "map.LS", "no faces: this is a point cloud <here>") for item in "34"]
        (self.small("failed") / "run.yaml").write_text(fixture.run_yaml(("LS", "RS"), simulated=False, failed=failed))
        self.made("failed")
        run = support.page(self.folder / "failed-report", "run.html")
        self.assertEqual(support.rows(run, "failed"), [["map.LS", "2", "3, 4", "no faces: this is a point cloud <here>"]])
        facts = dict(support.rows(run, "facts"))
        self.assertEqual((facts["threads"], facts["data set: participants"]), ("2", "22 to 25 participants per shape"))
        self.assertNotIn("host", facts)  # a report is sent to others

    def test_exports_that_cannot_be_used(self):
        out = self.small("export")
        (self.folder / "text.h5").write_text("not HDF5")
        fixture.write_export(self.folder / "cut.h5", ITEMS[:1], views=1)
        whole = (self.folder / "cut.h5").read_bytes()
        (self.folder / "cut.h5").write_bytes(whole[: len(whole) // 2])
        for name in ("text.h5", "cut.h5"):
            status, errors = support.make(out, self.folder / "to", "--export", self.folder / name)
            self.assertEqual((status, errors.count("\n"), name in errors), (2, 1, True), errors)

    def test_an_export_without_pictures(self):
        """Nothing is written outside the folder, either."""
        out = self.small("unpainted")
        fixture.write_export(out / "shapes.h5", ITEMS[:1], views=1, pictures=False)
        before = {path: path.stat().st_mtime_ns for path in out.rglob("*")}
        self.made("unpainted")
        self.assertEqual(before, {path: path.stat().st_mtime_ns for path in out.rglob("*")})
        shape = support.page(self.folder / "unpainted-report", "shapes/1.html")
        self.assertIn("holds no picture of mesh 1", shape)
        self.assertIn('class="viewer"', shape)


class OddNumbers(BadInputTest):
    figures = staticmethod(support.without_drawing)
    words = ("--metrics", "auc")

    def test_each_table_may_be_cut_short(self):
        for names in (("results.csv",), ("summary.csv",), ("run.yaml", *OTHERS[::2]), OTHERS[1::2]):
            with self.subTest(names):
                folder = f"cut-{names[0]}"
                out = self.small(folder)
                for path in map(out.__truediv__, names):
                    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2 + 3])
                index = self.made(folder)
                self.expect_named(dict.fromkeys(name for name in names if name != "run.yaml"), index)  # half of which is a record, too

    def test_an_older_version_without_later_columns(self):
        out = self.full("older")
        results = SCORES.drop(columns=["lcc", "auc_exact"])
        results.to_csv(out / "results.csv", index=False)
        self.words = ()  # all metrics
        index = self.made("older")
        self.assertIn("has no column lcc", index)

    def test_tables_from_before_units_of_inference(self):
        out = self.full("before-units")
        for name, later in (("summary", ["bca95_low", "bca95_high", "n_shapes", "n_own_shapes", "own_mean"]),
                            ("significance", ["n_shapes", "ci95_low", "ci95_high", "t_p"])):
            table = pandas.read_csv(out / f"{name}.csv").drop(columns=later)
            table.to_csv(out / f"{name}.csv", index=False)
        (out / "per_class.csv").write_text("dataset,class,model,n,auc_mean,auc_ci95\nmeshes,human,LS,2,0.6,0.01\n")
        for name in ("ranking", "ranking_agreement"):
            (out / f"{name}.csv").unlink()
        index = self.made("before-units")
        for name in ("summary", "significance", "per_class"):
            self.assertRegex(index, rf"{name}\.csv has no column [a-z0-9_, ]*: an older version of the program wrote it; run salbench")
        self.assertIn("ranking.csv is not in the results folder: run salbench again", index)
        self.assertNotIn("run salbench again", support.page(self.folder / "before-units-report", "shapes/1.html"))

    def test_one_shape_without_a_class(self):
        item = [("7", "")]
        fixture.write_results(self.folder / "classless", item, ("LS", "RS"), results=fixture.results_table(item, ("LS", "RS"), views=1))
        self.made("classless")
        to = self.folder / "classless-report"
        self.assertFalse((to / "classes.html").exists())
        self.assertNotIn("classes.html", support.page(to, "paper.html"))

    def test_one_model(self):
        fixture.write_results(self.folder / "one-model", ITEMS, ("LS",), results=fixture.results_table(ITEMS, ("LS",), views=1))
        self.assertIn("it takes two models", self.made("one-model"))

    def test_references_alone(self):
        """The mean over the competitors has no row, where there is none of them."""
        out = self.folder / "references"
        fixture.write_results(out, ITEMS, ("RS",), results=fixture.results_table(ITEMS, ("RS",), views=1))
        table = pandas.read_csv(out / "per_class.csv")
        table[table["model"] != "Avg"].to_csv(out / "per_class.csv", index=False)
        self.assertIn("No shape has scores: there is nothing to compare.", self.made("references"))

    def test_no_ground_truth(self):
        out = self.full("no-truth")
        for name in ("results", "summary", "per_class", "significance", "ranking", "ranking_agreement"):
            path = out / f"{name}.csv"
            path.write_text(path.read_text().splitlines()[0] + "\n")
        index = self.made("no-truth")
        self.assertIn("no shape of the run has ground truth", index)

    def test_scores_that_are_not_numbers(self):
        """Scores of one mesh, and of all scans."""
        results = SCORES.copy()
        results.loc[results["item"] == "3", ["auc", "nss"]] = float("nan")
        results.loc[results["dataset"] == "scans", list(fixture.METRICS)] = float("nan")
        self.full("nan", results=results)
        self.assertNotIn(">nan<", self.made("nan"))
