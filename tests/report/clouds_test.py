# SPDX-License-Identifier: GPL-3.0-or-later
"""Point clouds in the report: tables and figures of their own, a page per cloud, and the viewer."""

import fcntl
import json
import re
import unittest

import h5py
import numpy
import pandas

import fixture
import support
from salbench.report import exports, viewer

CLOUDS = [("kitten", ""), ("oni", ""), ("ball", "")]


def with_clouds(folder):
    """A results folder over meshes, scans and clouds, with an export."""
    both = pandas.concat([fixture.results_table(fixture.eight_meshes()),
                          fixture.results_table(CLOUDS, ("LS", "CS", "PS", "MS", "RS"), datasets=("clouds",))], ignore_index=True)
    out = folder / "clouds"
    fixture.write_results(out, fixture.eight_meshes(), results=both, failed=[("ball", "map.MS", "too thin")])
    fixture.histograms(("LS", "CS", "PS", "MS", "RS"), 5).to_csv(out / "mean_histograms_clouds.csv", index=False)
    write_export(out / "shapes.h5")
    return out


def write_export(path, viewpoint=True):
    """A mesh, its scan, and two clouds."""
    fixture.write_export(path, fixture.eight_meshes()[:1], views=1, pictures=False)
    random = numpy.random.default_rng(9)
    points = fixture.sphere()[0]
    with h5py.File(path, "a") as file:
        for item, category in CLOUDS[:2]:
            cloud = file.create_group(item)
            cloud.attrs.update({"dataset": "clouds", "item": item, "class": category})
            points = random.permutation(points)
            cloud["cloud/points"] = points
            cloud["cloud/viewpoint"] = numpy.array([[0, 0, 6.0]]) if viewpoint else numpy.zeros((0, 3))
            cloud["cloud_normals/normals"] = points / numpy.linalg.norm(points, axis=1, keepdims=True)
            fixture.fill(cloud, "cloud_ground_truth", points, ("LS", "CS", "PS", "MS", "RS"), random)
        fixture.add_pictures(file, 64)


class CloudsTest(support.ReportTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.out = with_clouds(cls.folder)
        cls.to = cls.report("clouds")

    def test_views_of_meshes_are_not_counted_as_meshes(self):
        out, models, items = self.folder / "views", ("LS", "RS"), fixture.eight_meshes()
        table = pandas.concat([fixture.results_table(items, models, datasets=("meshes",)).assign(view=view) for view in "ab"], ignore_index=True)
        fixture.write_results(out, items, models, results=table)
        with support.without_figures():
            support.make(out, self.folder / "of views")
        self.assertIn("16 views of 8 meshes with ground truth", support.page(self.folder / "of views"))

    def test_index_has_a_part_of_their_own(self):
        index = support.page(self.to)
        self.assertIn("8 meshes, 96 scans, 3 point clouds with ground truth", index)
        part = support.section(index, "clouds")
        self.assertNotIn("Missing:", part)
        for text in (*(f"figures/{support.drawn(self.to, f'figures/{name}').name}" for name in ("ranking-clouds.svg", "performance-clouds-auc.svg",
                                                                                            "examples-clouds.pdf")),
                     "AUC on point clouds, best model first"):
            self.assertIn(text, part)
        self.assertIn("figures/distributions-clouds-", index)
        datasets = {row[1] for row in support.rows(index, "means")}
        self.assertEqual(datasets, {"Meshes", "Scans", "Point clouds"})

    def test_a_page_per_cloud_has_scores_ranks_and_pictures_and_no_scans(self):
        page = support.page(self.to, "shapes/kitten.html")
        self.assertIn("<h1>Point cloud kitten", page)
        self.assertIn("Scores of the point cloud, best in bold; below, its place among all point clouds", page)
        self.assertEqual([row[0] for row in support.rows(page, "mesh-scores")], ["LS", "CS", "PS", "MS", "RS"])
        self.assertRegex(page, r"of 3\b")
        self.assertIn("pictures/kitten/point-cloud-LS-after", page)
        self.assertNotIn("Its scans", page)
        mesh = support.page(self.to, "shapes/1.html")
        self.assertIn("<h1>Mesh 1, human", mesh)
        self.assertIn("Its scans", mesh)

    def test_a_cloud_that_is_in_no_export_has_a_page_that_says_so(self):
        page = support.page(self.to, "shapes/ball.html")
        self.assertIn("<h1>Point cloud ball", page)
        self.assertIn("map.MS failed on ball: too thin", page)
        self.assertIn("No export given to the report holds this shape", page)

    def test_the_viewer_gets_points_without_faces(self):
        script = support.drawn(self.to, "shapes/kitten.js").read_text(encoding="utf-8")
        description = json.loads(re.match(r'salbench\.give\("kitten", (\{.*?\}), "', script)[1])
        self.assertEqual(description["faces"], 0)
        self.assertEqual(description["title"], "Point cloud")
        self.assertTrue(description["shaded"])
        self.assertEqual(description["maps"][0], "Ground truth")


class SpacingTest(unittest.TestCase):
    def test_does_not_depend_on_the_order_of_the_points(self):
        grid = numpy.stack(numpy.meshgrid(numpy.arange(20.0), numpy.arange(20.0), [0.0]), -1).reshape(-1, 3)
        self.assertAlmostEqual(viewer.spacing_in_any_order(grid), 1)
        self.assertAlmostEqual(viewer.spacing_in_any_order(numpy.random.default_rng(1).permutation(grid)), 1)
        self.assertEqual(viewer.spacing_in_any_order(grid[:1]), 0)


class ShadeTest(support.ReportTest):
    def test_without_a_viewpoint_points_are_lit_from_the_camera_of_the_picture(self):
        path = self.folder / "shapes.h5"
        write_export(path, viewpoint=False)
        with open(path) as locked:
            fcntl.flock(locked, fcntl.LOCK_EX)  # where a file system has no locks, taking one fails, too
            shapes = exports.Shapes([path])
        shape = shapes.itself("oni")
        self.assertIsNone(shape.seen_from())
        self.assertEqual(len(shape.shade(shape.eye(shape.picture())[0])), len(shape.points))
