# SPDX-License-Identifier: GPL-3.0-or-later
"""A report that is written again leaves nothing of the one before, and nothing of the user's is removed."""

import shutil
import unittest
import unittest.mock

import fixture
import support
from salbench.report.folder import LIST

ITEMS = fixture.eight_meshes()[:3]
OWN = {"notes.html": "my own notes", "data/notes.txt": "more", "figures/mine/plot.svg": "<svg/>", "thesis.tex": "years of work"}


def files_of(folder):
    """Path within the folder -> content."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


class WrittenAgain(support.ReportTest):
    @classmethod
    def setUpClass(cls):
        """A rich run and another to compare with, and a poor one of the same name, to be reported in the same place."""
        super().setUpClass()
        table = fixture.with_metrics(fixture.results_table(ITEMS, views=2), (*fixture.METRICS, "kl", "Sim"))
        cls.rich = cls.folder / "rich" / "out"
        fixture.write_results(cls.rich, ITEMS, results=table, extra=fixture.metric_lines((*fixture.METRICS, "kl", "Sim")))
        fixture.write_export(cls.rich / "shapes.h5", ITEMS[:2], views=2)
        cls.poor = cls.folder / "poor" / "out"
        models = fixture.MODELS[:2]
        fixture.write_results(cls.poor, ITEMS[2:], models, results=fixture.results_table(ITEMS[2:], models, views=1)[
            ["dataset", "item", "class", "view", "model", "auc", "n_points", "n_picks"]],
            extra='metrics:\n  auc: {unit: "1", better: higher}\n')
        cls.fresh = cls.made(cls, cls.poor, "fresh")

    def made(self, out, name, *arguments):
        with support.without_figures():
            status, errors = support.make(out, self.folder / name, *arguments)
        assert status == 0, errors
        return files_of(self.folder / name)

    def add_own(self, name):
        for path, text in OWN.items():
            (self.folder / name / path).parent.mkdir(exist_ok=True)
            (self.folder / name / path).write_text(text)

    def expect_fresh_and_own(self, name):
        files = files_of(self.folder / name)
        self.assertEqual({path: files.pop(path, b"").decode() for path in OWN}, OWN)
        self.assertEqual(sorted(files), sorted(self.fresh))
        self.assertEqual([path for path in files if files[path] != self.fresh[path]], [])

    def test_what_only_the_call_before_wrote_is_gone(self):
        before = self.made(self.rich, "again", "--compare", self.poor)
        self.assertTrue({"comparison.html", "metrics.html", "data/comparison.js", "shapes/1.html"} <= set(before))
        self.assertEqual(sorted(before[LIST].decode().splitlines() + [LIST]), sorted(before))
        self.add_own("again")
        self.made(self.poor, "again")
        self.expect_fresh_and_own("again")
        self.assertFalse((self.folder / "again/pictures/1").exists())

    def test_a_call_that_was_ended_leaves_nothing_that_stays(self):
        with support.without_figures(), unittest.mock.patch("salbench.report.run_page.blocks", side_effect=KeyboardInterrupt):
            status, errors = support.make(self.rich, self.folder / "ended", "--compare", self.poor)
        self.assertEqual(status, 130)
        self.assertIn(f"To go on:\n  salbench report {self.rich} --to {self.folder / 'ended'} --compare {self.poor}\n", errors)
        self.assertTrue((self.folder / "ended/comparison.html").exists())
        self.add_own("ended")
        self.made(self.poor, "ended")
        self.expect_fresh_and_own("ended")

    def test_a_report_of_version_0_1_0_which_left_no_list(self):
        self.made(self.rich, "older", "--compare", self.poor)
        (self.folder / "older" / LIST).unlink()
        (self.folder / "older" / "notes.html").write_text("my own notes")
        self.made(self.poor, "older")
        self.assertEqual(sorted(files_of(self.folder / "older")), sorted([*self.fresh, "notes.html"]))

    def test_a_list_that_names_other_files(self):
        precious = self.folder / "precious"
        precious.write_text("years of work")
        self.made(self.poor, "spoilt")
        (self.folder / "spoilt" / LIST).write_text(f"../precious\n{precious}\ndata\n\n.\n\0\n")
        shutil.rmtree(self.folder / "spoilt/shapes")
        self.made(self.poor, "spoilt")
        self.assertEqual(precious.read_text(), "years of work")
        self.assertEqual(sorted(files_of(self.folder / "spoilt")), sorted(self.fresh))


if __name__ == "__main__":
    unittest.main()
