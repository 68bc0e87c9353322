# SPDX-License-Identifier: GPL-3.0-or-later
"""The ground truth of an item, from files of every kind that a description may tell of."""

import numpy as np

from support import FACES, NAN, POINTS, WithArchive, lines, npy, obj, off, sphere

MAPS = "places: [{meshes: 'off/*', truth: {saliency: 'maps/{item}.csv'}}]\n"
PICKS = "places: [{meshes: 'off/*', truth: {picks: 'clicks/{item}_{participant}.pid'}}]\n"
MASKED = ("places:\n  - meshes: off/*\n    truth: {saliency: 'fix/{item}_{view}.txt', mask: 'seen/{item}_{view}_visibility.txt'}\n"
          "    views: %s\n")


class Saliency(WithArchive):
    def setUp(self):
        super().setUp()
        self.write({"off/cat.off": off(), "maps/cat.csv": "1\n2\n3\n4\n"})

    def test_values_per_vertex_of_any_file(self):
        for content, more in [("1\n2\n3\n4\n", ""), ("id,s\n3,4\n1,2\n0,1\n2,3\n", "values: {column: s}\n"), (npy(np.arange(1.0, 5)), ""),
                              ("x;s\nx;1\ny;2\nz;3\nw;4\n", "values: {column: 2}\n")]:
            self.write({"maps/cat.csv": content})
            form = self.read(MAPS + more)
            self.equal(form.truths[0].saliency, [1, 2, 3, 4])
            self.equal(form.faces, FACES)
            self.assertEqual((form.truths[0].picks, form.truths[0].as_read, form.truths[0].viewers), ((), (), None))

    def test_what_was_not_seen(self):
        for content, unseen in [("1\n-1\n3\n4\n", "-1"), ("1\nNaN\n3\n4\n", "nan"), (npy([1.0, -1, 3, 4]), "-1.0"), (npy([1.0, NAN, 3, 4]), "nan")]:
            self.write({"maps/cat.csv": content})
            self.equal(self.truth(MAPS + f"values: {{unseen: {unseen}}}\n").saliency, [1, NAN, 3, 4])

    def test_values_per_face_are_carried_to_vertices_and_kept(self):
        faces = np.vstack([[0, 0, 1], FACES])  # one without area has its line all the same
        self.write({"off/cat.off": off(faces=faces), "maps/cat.csv": lines([77, 0, 1, 2, 3])})
        truth = self.truth(MAPS + "values: {per: face}\n")
        self.equal(truth.face_values, [77, 0, 1, 2, 3])
        area = np.array([1, 1, 3 ** 0.5, 1])
        around = [[0, 1, 3], [0, 1, 2], [0, 2, 3], [1, 2, 3]]
        np.testing.assert_allclose(truth.saliency, [np.average([0, 1, 2, 3], weights=area * np.isin(range(4), near)) for near in around])
        self.write({"maps/cat.csv": "nan\nnan\n1\nnan\nnan\n"})
        truth = self.truth(MAPS + "values: {per: face, unseen: nan}\n")
        self.equal(truth.saliency, [1, 1, NAN, 1])
        self.equal(truth.face_values, [NAN, NAN, 1, NAN, NAN])

    def test_values_per_point_are_those_of_the_nearest(self):
        near = POINTS * 1000 + 1
        rows = [f"{x},{y},{z},{value}" for (x, y, z), value in zip(near.tolist(), [5, 6, 7, 8])][:3]
        self.write({"maps/cat.csv": "x,y,z,s\n" + "\n".join(rows)})
        point = MAPS + "values: {per: point, points: [x, y, z], column: s%s}\n"
        truth = self.truth(point % ", scale: 0.001")
        self.equal(truth.saliency, [5, 6, 7, NAN])
        self.equal(truth.as_read[0].points, 0.001 * near[:3])
        self.assertEqual((truth.as_read[0].file, truth.as_read[0].per), ("cat.csv", "point"))
        self.assertEqual(self.error_of(lambda: self.read(point % "")), "ROOT/maps/cat.csv: no point of the shape has a value; expected are values of "
                                                                       "what was seen, and points within max_distance of it")
        self.equal(self.truth(point % ", scale: 0.001, max_distance: 10").saliency, [5, 6, 7, 5])

    def test_positives_of_densities(self):
        points, faces = sphere()
        density = np.arange(len(points)) % 7.0
        density[:9] = NAN
        self.write({"off/cat.off": off(points, faces), "maps/cat.csv": lines(density)})
        for rule, positive in [("above mean", density > np.nanmean(density)),
                               ("top 20%", density >= np.sort(density[9:])[-int(np.ceil(0.2 * len(density[9:])))])]:
            truth = self.truth(MAPS + f"values: {{unseen: nan, positives: {rule}}}\n")
            self.equal(truth.picks[0], np.flatnonzero(positive))
        self.write({"maps/cat.csv": lines(np.full(len(points), 5.0))})
        self.assertEqual(self.truth(MAPS + "values: {positives: top 20%}\n").picks, ())

    def test_viewers_make_the_ground_truth(self):
        viewers = MAPS.replace("{item}", "{item}_{viewer}")
        maps = np.array([[1, 2, 3, NAN], [2, 2, 9, NAN], [6, 5, NAN, NAN]])
        self.write({f"maps/cat_{k}.csv": lines(one) for k, one in enumerate(maps)})
        form = self.read(viewers + "values: {unseen: nan}\n")
        self.equal(form.truths[0].saliency, [3, 3, 6, NAN])
        self.equal(form.truths[0].viewers, maps)
        self.assertEqual((form.about["viewers"], form.truths[0].as_read), ("0\n1\n2", ()))

    def test_viewers_are_told_apart_in_each_view(self):
        maps = {("front", "ann"): [1, 2, 3, NAN], ("front", "bob"): [3, 2, NAN, NAN], ("back", "ann"): [0, 1, 1, 5]}
        self.write({f"maps/cat_{view}_{viewer}.csv": lines(np.array(one)) for (view, viewer), one in maps.items()})
        self.write({"masks/cat_front.txt": "1\n0\n1\n1\n", "masks/cat_back.txt": "1\n1\n1\n1\n"})
        layout = ("places: [{meshes: 'off/*', views: scored, truth: {saliency: 'maps/{item}_{view}_{viewer}.csv', "
                  "mask: 'masks/{item}_{view}.txt'}}]\nvalues: {unseen: nan}\n")
        form, back = self.read(layout, "cat_front"), self.truth(layout, "cat_back")
        front, = form.truths
        self.assertEqual((front.view, back.view, form.about["viewers"]), ("front", "back", "ann\nbob"))
        self.equal(front.viewers, [[1, NAN, 3, NAN], [3, NAN, NAN, NAN]])
        self.equal(front.saliency, [2, NAN, 3, NAN])
        self.assertIsNone(back.viewers)
        self.equal(back.saliency, [0, 1, 1, 5])

    def test_one_viewer_is_no_group(self):
        self.write({"maps/cat_a.csv": "1\n2\n3\n4\n"})
        truth = self.truth(MAPS.replace("{item}", "{item}_{viewer}"))
        self.assertIsNone(truth.viewers)
        self.equal(truth.saliency, [1, 2, 3, 4])

    def test_polygons_are_split_and_counted(self):
        self.write({"off/cat.off": "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n3 0 2 1\n"})
        form = self.read(MAPS)
        self.assertEqual((form.polygons, form.faces.tolist()), ((1, 0), [[0, 1, 2], [0, 2, 3], [0, 2, 1]]))

    def test_a_value_per_polygon_is_that_of_its_triangles(self):
        """Files of the three formats, with faces of three to six corners; values may be of polygons or of triangles."""
        points = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [2, 1, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1.0], [0, 2, 1]])
        polygons = [[0, 1, 4, 5], [6, 0, 5], [1, 2, 3, 4], [7, 5, 6], [0, 6, 2, 1], [7, 6, 0, 2, 3, 5]]
        triangles = [k for k, corners in enumerate(polygons) for _ in corners[2:]]
        plain = "".join(f"{x} {y} {z}\n" for x, y, z in points) + "".join(f"{len(corners)} {' '.join(map(str, corners))}\n" for corners in polygons)
        written = {"off": f"OFF\n8 6 0\n{plain}", "ply": "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
                   f"element face 6\nproperty list uchar int vertex_indices\nend_header\n{plain}",
                   "obj": "".join(f"v {x} {y} {z}\n" for x, y, z in points) + "".join(f"f {' '.join(str(k + 1) for k in corners)}\n" for corners in polygons)}
        values, numbered = np.array([5, 1, 4, 2, 3, 0.5]), "face,s\n" + "".join(f"{k},{v}\n" for k, v in [(5, 0.5), (0, 5), (4, 3), (1, 1), (2, 4), (3, 2)])
        (self.root / "off/cat.off").unlink()
        for ending, mesh in written.items():
            self.write({f"off/cat.{ending}": mesh})
            for content, more in [(lines(values), ""), (lines(values[triangles]), ""), (npy(values), ""), (numbered, ", column: s")]:
                self.write({"maps/cat.csv": content})
                form = self.read(MAPS + f"values: {{per: face{more}}}\n")
                self.equal(form.truths[0].face_values, values[triangles])
                np.testing.assert_allclose(form.truths[0].saliency, self.truth_of_triangles(form, values[triangles]))
            self.write({"maps/cat.csv": "5\n1\n-1\n2\n3\n0.5\n"})
            self.equal(self.truth(MAPS + "values: {per: face, unseen: -1}\n").face_values, np.where(np.array(triangles) == 2, NAN, values[triangles]))
            (self.root / f"off/cat.{ending}").unlink()
        self.write({"off/cat.off": written["off"]})
        for count, per, wrong in [
                (5, "face", "5 values, but the mesh has 6 faces, split into 12 triangles"), (6, "vertex", "6 values, but the mesh has 8 vertices, and 6 faces, split "
                 "into 12 triangles: if they are of faces, write `values: {per: face}`"), (12, "vertex", "12 values, but the mesh has 8 vertices, and 6 faces, split into 12 "
                 "triangles: if they are of faces, write `values: {per: face}`"), (7, "vertex", "7 values, but the mesh has 8 vertices")]:
            for content in (lines(np.ones(count)), npy(np.ones(count))):
                self.write({"maps/cat.csv": content})
                self.assertTrue(self.error_of(lambda: self.truth(MAPS + f"values: {{per: {per}, unseen: -1}}\n")).endswith(wrong), count)
        self.write({"maps/cat.csv": lines(values), "seen/cat.txt": "1\n0\n1\n1\n1\n0\n"})
        masked = MAPS.replace("csv'", "csv', mask: 'seen/{item}.txt'") + "values: {per: face}\n"
        self.equal(self.truth(masked).face_values, np.where(np.isin(triangles, [1, 5]), NAN, values[triangles]))

    @staticmethod
    def truth_of_triangles(form, values):
        """Means around each vertex, by area."""
        corners = form.points[form.faces]
        areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        around = [(form.faces == k).any(axis=1) for k in range(len(form.points))]
        return [np.average(values[near], weights=areas[near]) for near in around]

    def test_what_the_form_says_of_its_sources(self):
        about = self.read(MAPS + "licence: ask\nclasses: folder\nsplits: {items: {test: [cat]}}\n").about
        self.assertEqual({key: about[key] for key in ("item", "class", "split", "source", "licence")},
                         {"item": "cat", "class": "off", "split": "test", "source": "own", "licence": "ask"})
        self.assertRegex(about["source_files"], r"^[0-9a-f]{32}  maps/cat.csv\n[0-9a-f]{32}  off/cat.off\n$")


class Views(WithArchive):
    def setUp(self):
        super().setUp()
        self.write({"off/cat.off": off(), "fix/cat_1.txt": "1\n2\n3\n4\n", "seen/cat_1_visibility.txt": "1\n1\n0\n1\n",
                    "fix/cat_2.txt": "5\n0\n0\n8\n", "seen/cat_2_visibility.txt": "1\n1\n1\n0\n"})

    def test_are_averaged_where_they_have_a_vertex_seen(self):
        truth = self.truth(MASKED % "averaged")
        self.equal(truth.saliency, [3, 1, 0, 4])
        self.assertIsNone(truth.viewers, "views are no people")
        self.equal([one.mask for one in truth.as_read], [[1, 1, 0, 1], [1, 1, 1, 0]])
        self.equal(truth.as_read[1].values, [5, 0, 0, 8])

    def test_are_items_of_their_own_if_they_are_scored(self):
        for name, expected in [("cat_1", [1, 2, NAN, 4]), ("cat_2", [5, 0, 0, NAN])]:
            form = self.read(MASKED % "scored", name)
            self.equal(form.truths[0].saliency, expected)
            self.assertEqual((form.truths[0].view, form.about["item"]), (name[-1], "cat"))

    def test_no_two_have_one_name(self):
        self.write({"off/cat_1.off": off(), "seen/cat/1_2.txt": "1\n2\n3\n4\n", "seen/cat_1/2.txt": "1\n2\n3\n4\n"})
        scored = "places: [{meshes: 'off/*', views: scored, truth: {saliency: 'seen/{item}/{view}.txt'}}]\n"
        self.assertEqual(self.error_of(lambda: self.list(scored)), "ROOT/off/cat.off and ROOT/off/cat_1.off have an item cat_1_2 each; rename a file")

    def test_one_mask_may_be_that_of_all_views(self):
        self.write({"seen/cat.txt": "0\n1\n1\n1\n"})
        one = "places: [{meshes: 'off/*', truth: {saliency: 'fix/{item}_{view}.txt', mask: 'seen/{item}.txt'}}]\n"
        self.equal(self.truth(one).saliency, [NAN, 1, 1.5, 6])

    def test_a_mask_is_of_faces_where_values_are(self):
        self.write({"seen/cat_1_visibility.txt": "0\n1\n0\n0\n"})
        (self.root / "fix/cat_2.txt").unlink()
        truth = self.truth(MASKED % "averaged" + "values: {per: face}\n")
        self.equal(truth.face_values, [NAN, 2, NAN, NAN])
        self.equal(truth.saliency, [2, 2, NAN, 2])
        self.equal(truth.as_read[0].values, [1, 2, 3, 4])
        self.assertEqual(len(self.list(MASKED % "averaged").notes), 1, "a mask without ground truth")

    def test_picks_where_nothing_was_seen_do_not_count(self):
        self.write({"clicks/cat_0.pid": "2\n1\n", "clicks/cat_1.pid": "2\n"})
        both = MASKED.replace("visibility.txt'}", "visibility.txt', picks: 'clicks/{item}_{participant}.pid'}")
        self.assertEqual([one.tolist() for one in self.truth(both % "scored", "cat_1").picks], [[1], []])


class People(WithArchive):
    def setUp(self):
        super().setUp()
        self.write({"off/cat.off": off()})

    def picks(self, layout):
        return [one.tolist() for one in self.truth(layout).picks]

    def test_a_participant_without_picks_counts(self):
        self.write({"clicks/cat_0.pid": "3\n", "clicks/cat_10.pid": "1\n1\n", "clicks/cat_2.pid": ""})
        self.assertEqual(self.picks(PICKS + "indices: {base: 0}\nvalues: {column: 1}\n"), [[3], [], [1, 1]])

    def test_indices_may_be_numbered_from_one(self):
        self.write({"clicks/cat_0.pid": "4\n1\n"})
        self.assertEqual(self.picks(PICKS + "indices: {base: 1}\n"), [[3, 0]])


class Columns(WithArchive):
    OWN = ("domain: points\nplaces: [{meshes: 'Gaze/*'}]\ncolumns: {position: [1, 2, 3], normal: [4, 5, 6], density: 7, flag: 8, "
           "normalise_normals: true, padding: any%s}\n")

    def setUp(self):
        super().setUp()
        self.around = np.arange(12.0)  # points on a helix, with directions twenty times as long as normals
        out = np.stack([np.cos(self.around), np.sin(self.around), 0 * self.around], 1)
        self.points = out + np.outer(self.around, [0, 0, 0.1])
        table = np.column_stack([self.points, 20 * out, 0.5 * self.around, self.around % 5 == 2])
        self.rows = [" ".join(map(repr, row)) for row in table.tolist()]
        self.normals = out

    def read_rows(self, layout):
        self.write({"Gaze/cat.txt": "\n".join(self.rows)})
        return self.read(layout)

    def test_position_normal_density_and_flag(self):
        form = self.read_rows(self.OWN % "")
        self.equal(form.points, self.points)
        np.testing.assert_allclose(form.normals, self.normals, rtol=0, atol=1e-15)
        self.equal(form.truths[0].saliency, 0.5 * self.around)
        self.assertEqual(([one.tolist() for one in form.truths[0].picks], form.faces), ([[2, 7]], None))

    def test_padding_and_duplicates_are_left_out_with_their_truth(self):
        zeros = " ".join("0" * 8)
        self.rows = [*self.rows[:4], self.rows[2], *self.rows[4:], zeros, self.rows[1], self.rows[1], zeros, zeros]
        form = self.read_rows(self.OWN % ", duplicates: dropped")
        self.assertEqual(form.left_out.tolist(), [4, 13, 14, 15, 16, 17])
        self.equal(form.points, self.points)
        self.equal(form.truths[0].saliency, 0.5 * self.around)
        self.assertEqual([one.tolist() for one in form.truths[0].picks], [[2, 7]])
        for padding, left_out in [("none", []), ("zeros", [16, 17]), ("copies", [14, 15, 16, 17])]:
            own = (self.OWN % "").replace("any", padding).replace("normal: [4, 5, 6], ", "")
            self.assertEqual(self.read_rows(own).left_out.tolist(), left_out, padding)

    def test_a_header_names_columns(self):
        self.write({"Gaze/cat.csv": "d,x,y,z\n" + "".join(f"{k},{k % 2},{k % 3},{k}\n" for k in range(9))})
        form = self.read("places: [{meshes: 'Gaze/*'}]\ncolumns: {position: [x, y, z], density: d}\n")
        self.equal(form.points[5], [1, 2, 5])
        self.equal(form.truths[0].saliency, np.arange(9))

    def test_values_beside_a_cloud_count_the_rows_of_its_file(self):
        self.rows.insert(1, "0 0 0 0 0 0 0 0")
        self.rows.append(self.rows[0])
        self.write({"maps/cat.txt": lines(np.arange(14.0)), "clicks/cat_0.pid": "2\n0\n"})
        own = ("places: [{meshes: 'Gaze/*', truth: {saliency: 'maps/{item}.txt', picks: 'clicks/{item}_{participant}.pid'}}]\n"
               "columns: {position: [1, 2, 3], padding: copies}\n")
        truth = self.read_rows(own).truths[0]
        self.equal(truth.saliency, np.arange(13))
        self.assertEqual([one.tolist() for one in truth.picks], [[2, 0]])
        self.write({"clicks/cat_0.pid": "2\n13\n"})
        self.assertIn("participant 0 picked point 13 (0-based), which has no position", self.error_of(lambda: self.read(own)))

    def test_wrong_rows_are_named(self):
        named = "places: [{meshes: 'Gaze/*'}]\ncolumns: {position: [1, 2, 3], normal: [4, 5, 6], density: 7}\n"
        self.assertEqual(self.error_of(lambda: self.read_rows(named)), "ROOT/Gaze/cat.txt:1: the normal has length 20, not 1: are these colours? name the "
                         "columns of the normals, or none; for directions of any length add `normalise_normals: true`")
        for row, wrong in [("1 1 1 1 0 0 0.5 0.5", "the flag is neither 0 nor 1"), ("1 1 1 1 0 0 0.5", "7 columns, but the first line has 8"),
                           ("1e51 1 1 1 0 0 0 0", "a coordinate is larger than 1e50"), ("nan 1 1 1 0 0 0 0", '"nan" is not a finite number')]:
            self.rows[3] = row
            self.assertTrue(self.error_of(lambda: self.read_rows(self.OWN % "")).startswith(f"ROOT/Gaze/cat.txt:4: {wrong}"), row)
        self.rows = [row[:-3] + "0" for row in self.rows[:3] + self.rows[4:]]
        own = "places: [{meshes: 'Gaze/*'}]\ncolumns: {position: [1, 2, 3], flag: 8}\n"
        self.assertEqual(self.error_of(lambda: self.read_rows(own)), "ROOT/Gaze/cat.txt: no point has its flag set: there is nothing to compare with")


    def test_colours_are_no_normals(self):
        """They have length 1 within 1 %, or 0 where none is known."""
        named = "places: [{meshes: 'Gaze/*'}]\ncolumns: {position: [1, 2, 3], normal: [4, 5, 6]}\n"
        random = np.random.default_rng(5).random((12, 3))
        for name, columns, wrong in [
                ("unit", self.normals, None), ("rounded", self.normals * 0.9901, None), ("longer", self.normals * 1.0099, None),
                ("none known", self.normals * 0, None), ("too short", self.normals * 0.9899, "1: the normal has length 0.99"),
                ("too long", self.normals * 1.0101, "1: the normal has length 1.01"), ("one of them", np.where(self.around[:, None] == 7, 0.5, self.normals), "8: the normal"),
                ("random colours", random, "1: the normal"), ("random colours up to 255", 255 * random, "1: the normal"),
                ("one grey", np.full((12, 3), 0.5), "1: the normal has length 0.866"), ("greys", np.outer(self.around / 11, [1, 1, 1]), "2: the normal"),
                ("white", np.ones((12, 3)), "1: the normal has length 1.73"), ("yellow among red", np.where(self.around[:, None] == 4, [1, 1, 0], [1, 0, 0]), "5: the normal")]:
            self.rows = [" ".join(map(repr, row)) for row in np.column_stack([self.points, columns]).tolist()]
            with self.subTest(name):
                if wrong is None:
                    found = self.read_rows(named).normals
                    self.equal(found is None, name == "none known")
                else:
                    self.assertIn(f"ROOT/Gaze/cat.txt:{wrong}", self.error_of(lambda: self.read_rows(named)))


class Obj(WithArchive):
    def test_textures_of_a_mesh_do_no_harm(self):
        self.write({"off/cat.obj": "mtllib cat.mtl\n" + obj(), "maps/cat.csv": "1\n2\n3\n4\n"})
        self.equal(self.read(MAPS).points, POINTS)
