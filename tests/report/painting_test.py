# SPDX-License-Identifier: GPL-3.0-or-later
"""Painting a map on a picture, and what the viewer is given."""

import base64
import json
import re
import zlib

import h5py
import numpy
from PIL import Image

import fixture
import salbench
import support
from salbench.report.exports import Picture, Shapes, unit_range
from salbench.report.painting import LIGHTEST, Canvas, palette, project, visible, with_dots
from salbench.report.shape_files import TRUTH, differences


def picture_of(points, faces=None, size=64, **more):
    return Picture(**{name: values.copy() for name, values in vars(salbench.picture(points, faces, size=size, **more)).items()})


class Painting(support.ReportTest):
    def setUp(self):
        self.points, self.faces = fixture.sphere()

    def test_a_linear_map_is_painted_as_interpolated(self):
        picture = picture_of(self.points, self.faces)
        row, column = numpy.argwhere(picture.primitive >= 0)[200]
        values = numpy.linspace(0, 1, len(self.points))
        corners = self.faces[picture.primitive[row, column]]
        expected = (values[corners] * picture.weights[row, column]).sum()
        canvas = Canvas(picture, self.faces)
        at = numpy.searchsorted(canvas.seen, row * 64 + column)
        self.assertAlmostEqual(canvas.values(values)[at], expected, places=6)

    def test_nothing_is_transparent_and_shade_darkens(self):
        picture = picture_of(self.points, self.faces)
        picture.shade[:], picture.coverage[:] = 128, numpy.where(picture.primitive < 0, 0, 255)
        image = numpy.asarray(Canvas(picture, self.faces).paint(numpy.ones(len(self.points))))
        self.assertTrue((image[picture.primitive < 0, 3] == 0).all() and (image[picture.primitive >= 0, 3] == 255).all())
        shade = LIGHTEST + (1 - LIGHTEST) * 128 / 255
        self.assertTrue((image[picture.primitive >= 0, :3] == (palette()[255] * shade).round()).all())

    def test_a_scan_takes_the_values_of_its_points(self):
        picture = picture_of(self.points, normals=self.points / numpy.linalg.norm(self.points, axis=1, keepdims=True))
        values = numpy.linspace(0, 1, len(self.points))
        seen = picture.primitive >= 0
        self.assertTrue((Canvas(picture, None).values(values) == values[picture.primitive[seen]].astype(numpy.float32)).all())

    def test_projected_points_fall_on_faces_that_have_them(self):
        picture = picture_of(self.points, self.faces, size=200)
        front = numpy.unique(self.faces[picture.primitive[picture.primitive >= 0]])
        at, depth = project(self.points[front], picture.view_projection, (200, 200))
        self.assertTrue(((at >= 0) & (at < 200)).all())
        self.assertTrue((depth > 0).all())
        # Not all: some corners of faces at the rim lie behind it.
        self.assertGreater(len(visible(picture, self.points[front])), 0.8 * len(front))

    def test_picks_on_the_far_side_are_not_seen(self):
        picture = picture_of(self.points, self.faces, size=200)
        far = numpy.argsort(self.points @ picture.camera()[0])[:20]
        self.assertEqual(len(visible(picture, self.points[far])), 0)

    def test_partly_covered_pixels_are_partly_transparent(self):
        picture = picture_of(self.points, self.faces)
        picture.coverage = numpy.full(picture.primitive.shape, 51, numpy.uint8)
        picture.shade[:] = 255
        image = numpy.asarray(Canvas(picture, self.faces).paint(numpy.zeros(len(self.points))))
        self.assertTrue((image[picture.primitive >= 0] == [*palette()[0], 51]).all())

    def test_the_camera_is_found_in_the_matrix(self):
        """A camera at (1, 2, 5) looks along -z with twice the focal length; then y and z are exchanged."""
        picture, looking = picture_of(self.points, self.faces), numpy.array([[2.0, 0, 0, -2], [0, 2, 0, -4], [0, 0, -1, 3], [0, 0, -1, 5]])
        for order, eye, up in (([0, 1, 2, 3], (1, 2, 5), "y"), ([0, 2, 1, 3], (1, 5, 2), "z")):
            picture.view_projection[:] = looking[:, order]
            numpy.testing.assert_allclose(picture.camera()[0], eye, atol=1e-9)
            self.assertEqual(picture.camera()[1], up)

    def test_dots_are_drawn_where_they_belong(self):
        image = with_dots(Image.new("RGBA", (100, 100), (0, 0, 0, 0)), numpy.array([[30.0, 70.0]]))
        changed = numpy.argwhere(numpy.asarray(image).any(axis=2))
        self.assertTrue((abs(changed.mean(axis=0) - [70, 30]) < 1).all())

    def test_maps_are_scaled_to_the_unit_range(self):
        self.assertEqual(unit_range(numpy.array([2.0, 4.0, 3.0])).tolist(), [0, 1, 0.5])
        self.assertEqual(unit_range(numpy.array([7.0, 7.0])).tolist(), [0, 0])
        self.assertEqual(unit_range(numpy.array([numpy.nan, 1.0, 0.0])).tolist(), [0, 1, 0])

    def test_differences_are_of_ranks_with_signs(self):
        truth, values = numpy.array([0.0, 0.0, 0.0, 1.0]), numpy.array([0.9, 0.1, 0.0, 0.2])
        found = differences({TRUTH: truth, ("LS", "before"): values, ("LS", "after"): values, ("CS", "before"): values[:3]})
        self.assertEqual({key: numpy.round(of, 6).tolist() for key, of in found.items()},
                         {("LS", "difference"): [1, 0.333333, 0, -0.333333]})

    def test_a_difference_is_blue_where_only_people_look(self):
        picture = picture_of(self.points, self.faces)
        picture.shade[:] = 255
        colours = [numpy.asarray(Canvas(picture, self.faces).paint(numpy.full(len(self.points), value), "diverging"))[32, 32, :3].tolist()
                   for value in (-1, 0, 1)]
        self.assertGreater(colours[0][2], colours[0][0] + 50)
        self.assertLess(numpy.ptp(colours[1]), 4)
        self.assertGreater(colours[2][0], colours[2][2] + 50)

    def test_viewer_data_undo_to_the_shape(self):
        """The steps of viewer.js's unpack() give back points, faces and maps."""
        out = support.make_full(self.folder / "viewer", meshes=1)
        to = self.report("viewer", out=out)
        text = support.drawn(to, "shapes/1_2.js").read_text() + support.drawn(to, "shapes/1.js").read_text()
        calls = re.findall(r"salbench\.give\((\".*?\"), (\{.*?\}), \"(.*?)\"\);", text)
        self.assertEqual([json.loads(call[0]) for call in calls], ["1_2", "1"])
        with h5py.File(out / "shapes.h5") as file:
            mesh, description = file["1"], json.loads(calls[1][1])
            steps = [numpy.linalg.norm(numpy.diff(points, axis=0), axis=1) for points in (file["1_2/scan/points"][:], mesh["mesh/vertices"][:])]
            numpy.testing.assert_allclose([json.loads(call[1])["spacing"] for call in calls], [*map(numpy.median, steps)])
            data = zlib.decompress(base64.b64decode(calls[1][2]))
            n, f = description["points"], description["faces"]
            axes = numpy.frombuffer(data, "<u2", 3 * n).reshape(3, n).cumsum(axis=1, dtype="<u2")
            points = axes.T / 65535 * description["edge"] + description["corner"]
            self.assertLess(abs(points - mesh["mesh/vertices"][:]).max(), 1e-4)
            faces = numpy.frombuffer(data, "<i4", 3 * f, 6 * n).cumsum(dtype="<i4").reshape(f, 3)
            self.assertTrue((faces == mesh["mesh/faces"][:]).all())
            maps = numpy.frombuffer(data, numpy.uint8, offset=6 * n + 12 * f).reshape(len(description["maps"]), n)
            at = description["maps"].index("LS, after matching")
            self.assertLessEqual(abs(maps[at] / 255 - unit_range(mesh["matched.LS/saliency"][:])).max(), 0.5 / 255 + 1e-9)

    def test_every_exported_shape_is_found(self):
        path = self.folder / "some.h5"
        fixture.write_export(path, fixture.eight_meshes()[:1], views=2, pictures=False)
        shapes = Shapes([path])
        self.assertEqual(shapes.items, ["1"])
        self.assertEqual([shape.view for shape in shapes.scans("1")], ["0", "1"])
