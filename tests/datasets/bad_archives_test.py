# SPDX-License-Identifier: GPL-3.0-or-later
"""Archives in which something is missing or wrong: one error that names file and remedy, and the other items go on. Splits, and what is wrong with
these."""

from salbench.datasets import files, reading, splits
from salbench.datasets.records import Item, Listing
from archives_test import MINIATURES, SPHERE, lines
from support import WithArchive, off

NAMES = ("ant", "bee", "cat", "dog", "eel")
FIXATIONS, MASK = "FixationMaps/bunny_300norm.txt", "CentricityAndVisibilityMaps/bunny_300_visibility.txt"

CASES = (  # set, files (None: removed), problems by item; all other items are read
    ("3dva", {}, {}),
    ("3dva", {MASK: None}, {"bunny_300": f"ROOT/{MASK}: is missing, the mask of ROOT/{FIXATIONS}"}),
    ("3dva", {FIXATIONS: None}, {"bunny_300": f"ROOT/{FIXATIONS}: is missing, the ground truth of the view that ROOT/{MASK}"}),
    ("sal3d", {"Gaze/cow.txt": "1 2 3 0 0 1 0.5\n"}, {"cow": "ROOT/Gaze/cow.txt:1: the line has 7 columns, expected 8"}),
    ("sal3d", {"Gaze/cow.txt": "0 0 0 0 0 1 0.5 1\n\n1 2 3 0 0 1 0.5 0.5\n"}, {"cow": "ROOT/Gaze/cow.txt:3: the flag in column 8 is neither 0 nor 1"}),
    ("sal3d", {"Gaze/cow.txt": "0 0 0 0 0 1 0.5 1\n1e51 2 3 0 0 1 0.5 0\n"}, {"cow": "ROOT/Gaze/cow.txt:2: a coordinate is larger than 1e50"}),
    ("sal3d", {"splits.csv": "item,split\ncow,test\nant,train\ncow,train\n"},
     {"cow": "ROOT/splits.csv:4: 'cow' is in the split 'train', and by ROOT/splits.csv:2 in 'test'"}),
    ("alexiou", {"Densities/amphoriskos.txt": lines(SPHERE[0][:, 0])}, {"amphoriskos": "ROOT/Densities/amphoriskos.txt: the file has 156 values, but 157 are"}),
)


class Cases(WithArchive):
    def test_each_fails_its_items_alone(self):
        for name, changed, problems in CASES:
            self.setUp()
            self.write(MINIATURES[name][0])
            self.write(changed)
            with self.subTest(name, changed=list(changed)):
                items = self.list(name).items
                self.assertLessEqual(set(problems), {item.name for item in items})
                for item in items:
                    self.assertTrue(item.truth)
                    if item.name in problems:
                        found = self.error_of(self.read, name, item.name)
                        self.assertTrue(found.startswith(problems[item.name]), found)
                    else:
                        self.read(name, item.name)

    def test_two_files_of_one_name(self):
        self.write(MINIATURES["3dva"][0] | {"3DModels-Simplif/bunny.ply": "ply\n"})
        self.assertIn("ROOT/3DModels-Simplif/bunny.off and ROOT/3DModels-Simplif/bunny.ply", self.error_of(self.list, "3dva"))

    def test_what_is_no_file(self):
        path = self.write({"a.off": off()})
        for replace, wrong in [(path.mkdir, "is a folder, where a file is expected"), (lambda: path.symlink_to("/dev/zero"), "is not a regular file")]:
            path.rmdir() if path.is_dir() else path.unlink()
            replace()
            self.assertIn(f"ROOT/a.off: {wrong}", self.error_of(reading.mesh, path))
        path.unlink()
        with open(path, "wb") as sparse:
            sparse.truncate((2 << 30) + 1)
        self.assertIn("ROOT/a.off: 2147483649 bytes: at most 2147483648 can be read", self.error_of(reading.mesh, path))

    def test_a_folder_that_cannot_be_listed(self):
        self.assertEqual(files.list_folder(str(self.root / "absent")), [])
        self.assertEqual(self.error_of(files.first, self.root / "absent", ["*"]), "ROOT/absent: there is no such folder")


class Splits(WithArchive):
    def listing(self):
        return Listing([Item(name, [f"{name}.off"]) for name in NAMES])

    def parts(self, listing):
        return {item.name: item.split for item in listing.items}

    def test_a_table_names_the_split_of_each_item(self):
        path = self.write({"splits.csv": "\ufeffitem,split\nbee,test\nant,train\neel,val\ncat,train\ndog,\n"})
        found = splits.from_table(self.listing(), path)
        self.assertEqual(self.parts(found), dict(zip(NAMES, ("train", "test", "train", "", "val"))))
        self.assertEqual((found.read, found.splits_where, found.no_splits, found.notes), ([str(path)], str(path), "", []))
        for text in ("item;split\nbee;test\n", "# a\nsplit\titem\ntest\tbee.off\n"):
            self.write({"splits.csv": text})
            self.assertEqual(self.parts(splits.from_table(self.listing(), path))["bee"], "test", text)
        self.write({"splits.csv": "name,part\nbee,test\n"})
        self.assertEqual(self.parts(splits.from_table(self.listing(), path, "name", "part"))["bee"], "test")
        self.assertEqual(self.error_of(splits.from_table, self.listing(), path), 'ROOT/splits.csv: there is no column "item"; there are "name", "part"')

    def test_wrong_tables_are_named_with_their_line(self):
        for text, wrong in [("item,split\n\nant\n", "3: the line has 1 fields, the header 2"), ("item,item\n", '1: two columns are named "item"'),
                            ('item,split\n"a,1\n', "2: a quote opens a field that nothing closes"),
                            ("", " the file is empty, where a line of column names is expected")]:
            path = self.write({"splits.csv": text})
            self.assertEqual(self.error_of(splits.from_table, self.listing(), path), f"ROOT/splits.csv:{wrong}")

    def test_the_first_lines_of_a_list_are_one_split(self):
        path = self.write({"paths.txt": "/rgb/dog.obj\nD:\\data\\ant.obj,maps/ant.csv\n\nbee\n\"rgb, old/eel.obj\",maps/eel.csv\nrgb/cat.obj\n"})
        order = ("dog", "ant", "bee", "eel", "cat")
        for shares, last_in_train in [({"train": 0.8, "test": 0.2}, 4), ({"train": 0.5, "test": 0.5}, 2), ({"train": 1}, 5)]:
            self.assertEqual(self.parts(splits.from_list(self.listing(), path, shares)),
                             {name: "train" if order.index(name) < last_in_train else "test" for name in NAMES})

    def test_names_may_be_given(self):
        found = splits.from_names(self.listing(), {"train": ["ant", "bee", "cat"], "test": ["dog", "eel"], "val": ["eel"]})
        self.assertEqual(self.parts(found), dict(zip(NAMES, ("train", "train", "train", "test", ""))))
        self.assertIn("'eel' is in the split 'val', and by splits in 'test'", found.items[-1].problem)
        self.assertEqual(self.parts(splits.from_names(self.listing(), {"train+test": ["ant"]}))["ant"], "train+test")

    def test_views_are_in_the_split_of_their_shape(self):
        views = Listing([Item(f"cat_{view}", ["cat.off"], shape="cat", view=view) for view in "12"])
        self.assertEqual([item.split for item in splits.from_names(views, {"test": ["cat"]}).items], ["test", "test"])

    def test_names_that_are_no_items_are_noted_with_their_lines(self):
        path = self.write({"splits.csv": "item,split\nant,test\nbe,test\ncat,train\ndogg,train\nee,test\n"})
        found = splits.from_table(self.listing(), path)
        self.assertRegex("\n".join(found.notes), f"^{path}:3: the split 'test' names 'be', .*3 such names.*$")
        self.assertEqual(found.unknown, [("test", "be", f"{path}:3"), ("train", "dogg", f"{path}:5"), ("test", "ee", f"{path}:6")])

    def test_the_file_may_be_missing(self):
        found = splits.from_table(self.listing(), self.root / "splits.csv")
        self.assertEqual((found.no_splits, found.notes), (f"{self.root}/splits.csv: is missing", []))
