# SPDX-License-Identifier: GPL-3.0-or-later
"""A run on recordings of gaze, from the one form to the report: its page of people, its recipe, and where they looked on each shape."""

import tempfile
import types
import unittest
from pathlib import Path

import numpy as np

import salbench
import support
from salbench.datasets import Recording, write
from salbench.report import own_export, recording as recording_page
from salbench.report.exports import Shapes
from salbench.report.report import Report
from salbench.report.results import Shown
from salbench.system.progress import nothing

POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0.2], [0.4, 1.2, 0.6]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 4, 3], [1, 2, 4], [2, 3, 5], [3, 4, 5], [2, 5, 4]])


def recording(people, size, misses, lost):
    """Everybody looks at two vertices from (3, 3, 3); those who miss look away. Of the last person, more samples are lost."""
    eye, rows = np.array([3.0, 3, 3]), {name: [] for name in ("person", "time", "valid", "origins", "directions")}
    for k in range(people):
        for step in range(60):  # half a second on each
            towards = (size * 0.9 * POINTS[4 if step < 30 else 5] - eye) * (-1 if k in misses else 1)
            for name, value in (("person", k), ("time", step * 1000 / 60), ("valid", step % 20 > 0 and (k < people - 1 or step >= lost)), ("origins", eye),
                                ("directions", towards / np.linalg.norm(towards))):
                rows[name].append(value)
    return Recording(tuple(f"P{k + 1}" for k in range(people)), **{name: np.array(values) for name, values in rows.items()})


class OfRecordings(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        root = Path(cls.folder.name)
        shapes = [types.SimpleNamespace(id=name, points=POINTS * size, faces=FACES, recording=recording(4, size, [2], lost))
                  for name, size, lost in (("ant", 1, 40), ("bee", 0.8, 45))]
        write(root / "set", shapes)
        (root / "gaze.yaml").write_text("dataset: {layout: hdf5, scans: false}\nmetrics: [cc]\nmodels: {RS: , HS: }\ngaze: {degrees: 4}\n"
                                        "picture: {}\n")
        salbench.run(root / "gaze.yaml", data=root / "set", cache=root / "cache", out=root / "out")
        cls.root, cls.out, cls.report = root, root / "out", root / "report"
        with support.without_figures():
            status, errors = support.make(cls.out, cls.report, "--picks")
        assert status == 0, errors

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_the_table_counts_what_became_of_each_persons_samples(self):
        lines = (self.out / "gaze.csv").read_text().splitlines()
        self.assertEqual(lines[0], "item,class,person,samples,lost,fixations,hits,snapped,missed,seconds,recorded,tracked,left_out,remarks")
        self.assertEqual([line.split(",")[:9] for line in lines[1:4]],
                         [["ant", "", "P1", "60", "3", "2", "2", "0", "0"], ["ant", "", "P2", "60", "3", "2", "2", "0", "0"],
                          ["ant", "", "P3", "60", "3", "2", "0", "0", "2"]])

    def test_fixations_of_a_shape_are_where_people_look_who_count(self):
        file = self.root / "ant.h5"
        own_export.export(self.out / "run.yaml", ["ant"], file, nothing)
        shapes = Shapes([file])
        everybody = shapes.shapes["ant"].fixations
        report = Report(Shown(self.out), None, shapes)
        places = shapes.shapes["ant"].fixations
        self.assertEqual((len(everybody), len(places)), (5, 4))
        self.assertNotIn("dots", report.alt(shapes.shapes["ant"], "ground truth", "Ground truth"))  # without --picks
        for place, looked_at in zip(places, [*POINTS[4:], *POINTS[4:]]):
            eye = np.array([3.0, 3, 3])
            np.testing.assert_allclose(np.cross(place - eye, 0.9 * looked_at - eye), 0, atol=1e-6)

    def test_the_recipe_is_in_the_record_and_on_one_page_to_which_the_banners_of_others_lead(self):
        recipe = ("most_lost: 0.5, least_seconds: 0.5, degrees: 4, radius: 0, spread: geodesic, mass: duration, weight: people, picks: none, "
                  "visible: ignored")
        self.assertIn(f"ground_truth: {{version: 3, {recipe}}}}}\n", (self.out / "run.yaml").read_text())
        self.assertNotIn(recipe, (self.out / "results.csv").read_text())
        for page in self.report.rglob("*.html"):
            root = "../" * (len(page.relative_to(self.report).parts) - 1)
            self.assertIn(f'Ground truth: computed from recordings of gaze: <a href="{root}recording.html">how</a>', page.read_text(), page)
            self.assertEqual(recipe in page.read_text(), page.name == "recording.html", page)

    def test_a_data_set_has_what_a_run_makes_by_default(self):
        shapes = salbench.Dataset("hdf5", self.root / "set", items="scored")
        self.assertEqual(shapes.ids, ("ant", "bee"))
        ant = shapes["ant"]
        self.assertEqual(len(ant.viewers), 2, "who looked at it")
        (self.root / "default.yaml").write_text("dataset: {layout: hdf5, scans: false}\nmetrics: [cc]\nmodels: {RS: }\n")
        salbench.run(self.root / "default.yaml", data=self.root / "set", cache=self.root / "cache", out=self.root / "default")
        computed = salbench.Cache(self.root / "cache")["ant"].all("ground_truth")[-1]
        np.testing.assert_array_equal(ant.ground_truth, computed["saliency"])
        np.testing.assert_array_equal(ant.viewers, computed["viewers"])

    def test_the_page_names_people_and_who_looked_at_nothing(self):
        rows = support.rows(support.page(self.report, "recording.html"), "people-recorded")
        self.assertEqual(rows[1], ["P1", "120", "5.0 6", "1.9", "4", "0.0 0", "0", "1.9", "2 of 2", ""])
        self.assertEqual([row[-2:] for row in rows], [["2 of 2", "lost 68 to 75 % (2 shapes)"], ["2 of 2", ""], ["2 of 2", ""],
                                                      ["0 of 2 on no shape", "no fixation on the shape (2 shapes)"]])

    def test_the_page_has_the_remarks_of_the_record(self):
        rows = support.rows(support.page(self.report, "recording.html"), "remarks")
        self.assertEqual({item for item, _ in rows}, {"ant", "bee"})
        self.assertIn("have no fixation on the shape: P3 (0 of 2)", rows[0][1])
        self.assertEqual(rows, [[remark["item"], remark["remark"]] for remark in Shown(self.out).record["remarks"]])

    def test_reasons_that_differ_in_their_number_are_one(self):
        said = recording_page.reasons(["lost 73 %", "tracked for 0.4 s", "lost 100 %", "no fixation on the shape", "lost 70 %"])
        self.assertEqual(said, "lost 70 to 100 % (3 shapes), tracked for 0.4 s, no fixation on the shape")

    def test_the_first_page_counts_people_whose_gaze_is_in_the_ground_truth(self):
        self.assertIn("2 participants per shape", support.page(self.report, "index.html"))

    def test_recorded_fixations_have_no_samples_that_could_be_lost(self):
        table = Shown(self.out).table("gaze").assign(tracked=float("nan"))
        report = types.SimpleNamespace(results=types.SimpleNamespace(table=lambda name: table))
        self.assertEqual([(cell.text, cell.below) for cell in recording_page.of_shape(report, "ant").rows[0][1:4]], [("60", ""), ("–", ""), ("–", "")])
        self.assertTrue(recording_page.by_person(recording_page.people_of(report))[["lost", "tracked"]].isna().all(axis=None))

    def test_a_shape_shows_where_people_looked(self):
        page = (self.report / "shapes/ant.html").read_text()
        self.assertIn("dots: where people looked", page)
        self.assertIn("People whose gaze on this shape was recorded", page)
