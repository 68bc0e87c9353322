# SPDX-License-Identifier: GPL-3.0-or-later
"""Archives in which something is missing or wrong: one error that names file, line and remedy, and the other items go on. Each case is an
archive, what is changed in it, and what its items then say."""

from salbench import datasets
from salbench.datasets.records import InputError
from archives_test import MINIATURES
from support import POINTS, WithArchive, npy, off

NAMES = ("ant", "bee", "cat", "dog", "eel")
FLAT = {f"off/{name}.off": off() for name in NAMES} | {f"maps/{name}.csv": "0\n1\n2\n3\n" for name in NAMES}
MAPS = "places: [{meshes: 'off/*', truth: {saliency: 'maps/{item}.csv'}}]\n"
PICKS = "places: [{meshes: 'off/*', truth: {picks: 'clicks/{item}_{participant}.pid'}}]\n"
FIXATIONS, MASK = "FixationMaps/bunny_300norm.txt", "CentricityAndVisibilityMaps/bunny_300_visibility.txt"
POINT = MAPS + "values: {per: point, points: [x, y, z], column: s, max_distance: 100}\n"

CASES = (  # layout, files (None: removed), problems by item; all other items are read
    ("3dva", {}, {}),
    ("3dva", {MASK: None}, {"bunny_300": f"ROOT/{MASK}: is missing, the mask of ROOT/{FIXATIONS}: add it, or take its ground truth away (layout 3dva)"}),
    ("3dva", {FIXATIONS: None}, {"bunny_300": f"ROOT/{FIXATIONS}: is missing, the ground truth of the view that ROOT/{MASK} is the mask of: add it, "
                                              "or take the mask away (layout 3dva)"}),
    ("3dva", {FIXATIONS: "1\n2\n3\n4\n5\n"}, {"bunny_300": f"ROOT/{FIXATIONS}:5: the file has 5 values, but the mesh has 4 vertices"}),
    ("3dva", {MASK: "1\n0\n1\n"}, {"bunny_300": f"ROOT/{MASK}:3: the file has 3 values, but the mesh has 4 vertices"}),
    ("3dva", {MASK: "1\n1\n0.5\n1\n"}, {"bunny_300": f"ROOT/{MASK}:3: a mask has 0 for hidden and 1 for seen, and nothing else"}),
    ("3dva", {MASK: "0\n0\n0\n0\n"}, {"bunny_300": f"ROOT/{MASK}: hides everything: nothing is left to be scored; correct it, or take it and its "
                                                   "ground truth away"}),
    (MAPS, {"maps/cat.csv": "1\n2\n3\n"}, {"cat": "ROOT/maps/cat.csv:3: the file has 3 values, but the mesh has 4 vertices"}),
    (MAPS + "values: {per: face}\n", {"maps/cat.csv": "1\n2\n3\n"}, {"cat": "ROOT/maps/cat.csv:3: the file has 3 values, but the mesh has 4 faces"}),
    (MAPS + "values: {per: face}\n", {"off/cat.xyz": "".join(f"{k} {k % 3} {k % 2}\n" for k in range(9)), "off/cat.off": None},
     {"cat": "ROOT/maps/cat.csv: has values per face, but ROOT/off/cat.xyz is a point cloud, which has none"}),
    (MAPS + "values: {unseen: 0}\n", {"maps/cat.csv": "0\n0\n0\n0\n"}, {"cat": "ROOT/maps/cat.csv: no point of the shape has a value; expected are "
                                                                               "values of what was seen, and points within max_distance of it"}),
    (MAPS, {"off/cat.off": "OFF\n4 4\n0 0\n"}, {"cat": "ROOT/off/cat.off:3: "}),
    (MAPS, {"off/cat.off": ""}, {"cat": "ROOT/off/cat.off: the file is empty"}),
    (MAPS, {"maps/cat.csv": npy([1.0, 2, 3])}, {"cat": "ROOT/maps/cat.csv: the file has 3 values, but the mesh has 4 vertices"}),
    (MAPS, {"maps/cat.csv": npy([1.0, 2, float("inf"), 3])}, {"cat": "ROOT/maps/cat.csv: value 2 (0-based) is inf, expected a finite number"}),
    (POINT, {f"maps/{name}.csv": "x,y,z,s\n1,1,1,5\n" for name in NAMES} | {"maps/cat.csv": "x,y,z,s\n1,1,1,1\n1e300,0,0,2\n", "maps/dog.csv": "x,y,z,s\n",
                                                                          "maps/eel.csv": npy([1.0])},
     {"cat": "ROOT/maps/cat.csv:3: a coordinate is larger than 1e50: scale the mesh", "dog": "ROOT/maps/dog.csv:1: the file has no values",
      "eel": "ROOT/maps/eel.csv: values per point stand in columns beside x, y and z: write them as text"}),
    (PICKS, {"clicks/cat_0.pid": "4\n1\n", "clicks/dog_0.pid": "1\n0\n", "clicks/eel_0.pid": "", "clicks/eel_1.pid": "# nobody\n"},
     {"cat": "ROOT/clicks/cat_0.pid:1: vertex 4 is out of range: the mesh has 4 vertices, numbered from 0",
      "eel": "ROOT/clicks/eel_0.pid: nobody picked a point and there is no saliency file; remove the empty .pid files"}),
    (MAPS + "splits: {file: splits.csv}\n", {"splits.csv": "item,split\nant,train\nbee,test\nant,test\nbee,test\ncat,val\n"},
     {"ant": "ROOT/splits.csv:4: 'ant' is in the split 'test', and by ROOT/splits.csv:2 in 'train': keep one of them"}),
    ("meshmamba", {"SaliencyMap/non_texture/Apple_v01.csv": "1\n2\n"}, {"Apple_v01": "ROOT/SaliencyMap/non_texture/Apple_v01.csv:2: the file has 2 values, but the "
                                                                                    "mesh has "}),
)


class Cases(WithArchive):
    def test_each_fails_its_items_alone(self):
        for layout, changed, problems in CASES:
            self.setUp()
            files = (MINIATURES[layout][0] if layout in MINIATURES else FLAT) | changed
            self.write({name: content for name, content in files.items() if content is not None})
            with self.subTest(layout=layout, changed=list(changed)):
                items = self.list(layout).items
                self.assertLessEqual(set(problems), {item.name for item in items})
                for item in items:
                    if item.name in problems:
                        self.assertTrue(item.truth)
                        found = self.error_of(lambda: self.read(layout, item.name))
                        self.assertTrue(found.startswith(problems[item.name]), found)
                    else:
                        self.read(layout, item.name)

    def test_a_problem_of_the_ground_truth_leaves_the_shape(self):
        self.write({name: content for name, content in MINIATURES["3dva"][0].items() if name != MASK})
        item = self.list("3dva").items[0]
        form = datasets.read("3dva", str(self.root), item)
        self.equal(form.points, POINTS)
        self.assertEqual((form.truths, len(item.files), item.truth), ((), 1, True))

    def test_what_is_no_file(self):
        self.write(FLAT)
        for replace, wrong in [(lambda path: path.mkdir(), "is a folder, where a file is expected"),
                               (lambda path: path.symlink_to("/nowhere"), "cannot be read: No such file"),
                               (lambda path: path.symlink_to("/dev/zero"), "is not a regular file")]:
            path = self.root / "maps/cat.csv"
            path.rmdir() if path.is_dir() else path.unlink()
            replace(path)
            row = next(row for row in self.list(MAPS).items if row.name in ("cat", "bee"))
            row.files = tuple(type(file)(file.name, file.path.replace("bee", "cat")) for file in row.files)  # a folder is not listed
            with self.assertRaisesRegex(InputError, f"maps/cat.csv: {wrong}"):
                datasets.read(self._layout(MAPS), str(self.root), row)
        with open(self.root / "off/dog.off", "wb") as sparse:
            sparse.truncate((2 << 30) + 1)
        self.assertEqual(self.error_of(lambda: self.read(MAPS, "dog")), "ROOT/off/dog.off: 2147483649 bytes: at most 2147483648 can be read; simplify the shape, "
                                                                        "or copy the file again if it should be smaller")


class Splits(WithArchive):
    def setUp(self):
        super().setUp()
        self.write(FLAT)

    def splits(self, text):
        return {item.name: item.split for item in self.list(MAPS + text).items}

    def test_a_table_names_the_split_of_each_item(self):
        self.write({"splits.csv": "item,split\nbee,test\nant,train\neel,val\ncat,train\ndog,\n"})
        self.assertEqual(self.splits("splits: {file: splits.csv}\n"), dict(zip(NAMES, ("train", "test", "train", "", "val"))))
        listed = self.list(MAPS + "splits: {file: splits.csv}\n")
        self.assertEqual((listed.read, listed.splits_where, listed.no_splits), ([str(self.root / "splits.csv")], f"{self.own}:2", ""))
        self.assertEqual(listed.notes, [f"1 of 5 items are in no split ({self.own}:2): dog"])
        self.write({"splits.csv": "name,part\nbee,test\n"})
        self.assertEqual(self.splits("splits: {file: splits.csv, item: name, split: part}\n")["bee"], "test")
        self.assertEqual(self.error_of(lambda: self.splits("splits: {file: splits.csv}\n")),
                         'ROOT/splits.csv: there is no column "item"; there are "name", "part"')

    def test_wrong_tables_are_named_with_their_line(self):
        for text, wrong in [("item,split\n\nant\n", "3: the line has 1 fields, the header 2"), ("item,item\n", '1: two columns are named "item"'),
                            ('item,split\n"a,1\n', "2: a quote opens a field that nothing closes"),
                            ('item,split\n"a"b\n', "2: there is text after the quote that closes a field"),
                            ("", " the file is empty, where a line of column names is expected")]:
            self.write({"splits.csv": text})
            self.assertEqual(self.error_of(lambda: self.list(MAPS + "splits: {file: splits.csv}\n")), f"ROOT/splits.csv:{wrong}")

    def test_the_first_lines_of_a_list_are_one_split(self):
        self.write({"paths.txt": "rgb/dog.obj\nD:\\data\\ant.obj,maps/ant.csv\n\nbee\n\"rgb, old/eel.obj\",maps/eel.csv\nrgb/cat.obj\n"})
        for shares, last_in_train in [("{train: 80%, test: 0.2}", 4), ("{train: 0.5, test: 0.5}", 2), ("{train: 1}", 5)]:
            order = ("dog", "ant", "bee", "eel", "cat")
            self.assertEqual(self.splits(f"splits: {{list: paths.txt, shares: {shares}}}\n"),
                             {name: "train" if order.index(name) < last_in_train else "test" for name in NAMES})

    def test_a_description_may_name_the_items(self):
        self.assertEqual(self.splits("splits:\n  items:\n    train: [ant, bee, cat]\n    test: [dog, eel]\n"),
                         dict(zip(NAMES, ("train", "train", "train", "test", "test"))))

    def test_names_that_are_no_items_are_noted_with_their_lines(self):
        self.write({"splits.csv": "item,split\nant,test\nbe,test\ncat,train\ndogg,train\nee,test\n"})
        listed = self.list(MAPS + "splits: {file: splits.csv}\n")
        where = str(self.root / "splits.csv")
        self.assertEqual(listed.notes[0], f"{where}:3: the split 'test' names 'be', which is no item of the data set (3 such names): correct the name, "
                                          "or add its files")
        self.assertEqual([(one["split"], one["name"], one["where"]) for one in listed.unknown],
                         [("test", "be", f"{where}:3"), ("train", "dogg", f"{where}:5"), ("test", "ee", f"{where}:6")])

    def test_the_file_may_be_missing(self):
        listed = self.list(MAPS + "splits: {file: splits.csv}\n")
        self.assertEqual((listed.no_splits, listed.notes), (f"{self.root}/splits.csv: is missing ({self.own}:2)", []))
