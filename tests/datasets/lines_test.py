# SPDX-License-Identifier: GPL-3.0-or-later
"""Classes and splits stand in every table: one that is no line of UTF-8 is refused with file and line where it is read, by every way in. What a
CSV file can have in quotes goes through."""

import csv
import os
import re
import types

import numpy as np

import salbench
from salbench.conclusions import source_of
from salbench.datasets import one_form, sets, splits
from salbench.datasets.records import InputError, Item, Listing
from support import FACES, POINTS, WithArchive, sphere

WRONG = {"Latin-1": b"caf\xe9", "a surrogate": b"\xed\xa0\x80", "a line feed": b"a\nb", "a tab": b"a\tb", "a zero": b"a\0b", "a delete": b"a\x7f", "a control of Latin-1": b"\xc2\x85",
         "a line separator": "a\u2028b".encode(), "a paragraph separator": "a\u2029b".encode()}
FINE = ["a,b", 'a "b"', "caf\u00e9", "=1+1", "#1", " a ", "\u676f\u5b50", "\U0001f426"]
SAID = "has (a byte that is no UTF-8|a control character|a line separator|a paragraph separator), which tables cannot have: rename"


def quoted(data):
    return b'"' + data.replace(b'"', b'""') + b'"'


class Lines(WithArchive):
    def refused(self, work, where):
        with self.assertRaisesRegex(InputError, SAID) as caught:
            work()
        message = str(caught.exception).replace(str(self.root), "ROOT")
        self.assertTrue(message.startswith(where) and message.isprintable(), message)

    def index(self, category, split=b""):
        row = b",".join([b"b", b"", quoted(category), quoted(split), b"mesh,no,0,0,own\n"])
        self.write({"index.csv": b"item,view,class,split,kind,truth,participants,viewers,source\na,,cup,,mesh,no,0,0,own\n" + row})

    def test_in_an_index(self):
        for name, text in WRONG.items():
            for column in ("class", "split"):
                self.index(**{"category": b"", column if column == "split" else "category": text})
                with self.subTest(name, column=column):
                    self.refused(lambda: sets.listed("hdf5", str(self.root)), f"ROOT/index.csv:3: {column} ")
        for text in FINE:
            self.index(text.encode(), text.encode())
            self.assertEqual([(item.category, item.split) for item in sets.listed("hdf5", str(self.root))[1].items], [("cup", ""), (text, text)])

    def test_of_shapes_of_ones_own(self):
        for name, text in WRONG.items():
            for key in ("category", "split"):
                shape = types.SimpleNamespace(id="a", points=POINTS, faces=FACES, **{key: os.fsdecode(text)})
                with self.subTest(name, key=key):
                    self.refused(lambda: one_form.write(self.root / "set", [shape]), f"shape 'a': its {key} ")
            with self.subTest(name, key="source"):
                self.refused(lambda: one_form.write(self.root / "set", [], source=os.fsdecode(text)), "source ")
        self.assertEqual([*self.root.rglob("*.*")], [])

    def test_in_a_table_of_splits(self):
        def split():
            return splits.from_table(Listing([Item("a"), Item("b")]), self.root / "splits.csv")

        for name, text in WRONG.items():
            self.write({"splits.csv": b"item,split\na,test\nb," + quoted(text) + b"\n"})
            with self.subTest(name):
                self.refused(split, "ROOT/splits.csv:3: the split ")
        for text in FINE:
            self.write({"splits.csv": b"item,split\na,test\nb," + quoted(text.encode()) + b"\n"})
            self.assertEqual([item.split for item in split().items], ["test", text])

    def test_in_tables_of_classes_and_scores(self):
        for name, text in WRONG.items():
            self.write({"scores.csv": b"item,model,cc,class,split\na,LS,.5,cup,\n", "classes.csv": b"item,class\na,cup\nb," + quoted(text) + b"\n"})
            with self.subTest(name):
                self.refused(lambda: source_of(self.root / "scores.csv", classes=self.root / "classes.csv"), "ROOT/classes.csv:3: class ")
            for column, row in (("class", quoted(text) + b","), ("split", b"," + quoted(text))):
                self.write({"scores.csv": b"item,model,cc,class,split\na,LS,.5,,\nb,LS,.5," + row + b"\n"})
                with self.subTest(name, column=column), self.assertRaisesRegex(InputError, f"scores.csv:3: {column} "):
                    source_of(self.root / "scores.csv")

    def test_what_csv_can_have_goes_through_to_the_results(self):
        points, faces = sphere(5, 6)
        shapes = [types.SimpleNamespace(id=f"s{number}", points=points, faces=faces, ground_truth=np.arange(len(points)), category=text, split=text)
                  for number, text in enumerate(FINE)]
        one_form.write(self.root / "set", shapes)
        configuration = self.root / "own.yaml"
        configuration.write_text("dataset: {layout: hdf5, scans: false}\nmodels: {CB: }\nmetrics: {names: [cc], matching: none}\n")
        results = salbench.run(configuration, data=self.root / "set", cache=self.root / "cache", out=self.root / "out")
        with open(results.folder / "results.csv", encoding="utf-8", newline="") as file:
            rows = [*csv.DictReader(line for line in file if not re.match("#", line))]
        self.assertEqual([(row["class"], row["split"]) for row in rows], [(text, text) for text in FINE])
