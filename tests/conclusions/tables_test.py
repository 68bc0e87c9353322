# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames have their columns and types whatever their rows; their text in files and on a console; every column is documented."""

import csv
import io
import unittest

from support import InAFolder, NAN

from salbench import conclusions
from salbench.conclusions import tables
from salbench.conclusions.tables import SPLIT, count, framed, number, optional_count, text
from salbench.runs.tables import read
from salbench.system.errors import InputError

COLUMNS = (text("name", "a name"), SPLIT, count("n", "so many"), optional_count("rank", "if any"), number("mean", "of them"))


class FramesTest(unittest.TestCase):
    def test_have_the_same_columns_and_types_without_rows(self):
        parts = [{"name": "a", "split": "", "n": 3, "rank": [1, NAN], "mean": [.5, NAN]},
                 {"name": ["b"], "split": "", "n": [2], "rank": 2.0, "mean": 1}]
        full, empty = framed(COLUMNS, parts, in_splits=False), framed(COLUMNS, [], in_splits=False)
        self.assertEqual([str(kind) for kind in full.dtypes], ["object", "int64", "Int64", "float64"])
        self.assertEqual(list(full.dtypes), list(empty.dtypes))
        self.assertEqual(list(full["name"]), ["a", "a", "b"])
        self.assertIn("split", framed(COLUMNS, parts))

    def test_refuse_an_unknown_count(self):
        with self.assertRaises(ValueError):
            framed((count("n", "so many"),), [{"n": [1, NAN]}])


class TextTest(unittest.TestCase):
    FRAME = framed(COLUMNS, [{"name": ["a, \"b\"", "", "ö\nx"], "split": "", "n": [1, 2, 30], "rank": [1, NAN, 12],
                              "mean": [1 / 3, NAN, -1e-7]}], in_splits=False)

    def test_of_a_file(self):
        made = tables.csv(self.FRAME, ["PARTIAL: so far", "SIMULATED"])
        said = "PARTIAL: so far | SIMULATED"
        self.assertEqual(made, f'name,n,rank,mean,remarks\n"a, ""b""",1,1,0.3333333333,{said}\n,2,,,{said}\n"ö\nx",30,12,-1e-07,{said}\n')
        self.assertEqual(list(csv.reader(io.StringIO(made)))[3], ["ö\nx", "30", "12", "-1e-07", said])

    def test_of_numbers_beyond_the_usual(self):
        frame = framed((number("x", ""),), [{"x": [float("inf"), -float("inf"), 1e300, 123456789012345, 0.0, -0.0]}])
        self.assertEqual([row["x"] for row in tables.records(frame)], ["inf", "-inf", "1e+300", "1.23456789e+14", "0", "-0"])

    def test_of_a_row_of_one_empty_cell(self):  # a blank line would not be read as a row
        self.assertEqual(tables.csv(framed((text("a", ""),), [{"a": ["", "b"]}])), 'a\n""\nb\n')

    def test_of_a_console(self):  # numbers to the right, but for a column with empty cells
        frame = framed(COLUMNS, [{"name": ["a", "long"], "split": "", "n": [1, 20], "rank": [1, NAN], "mean": [1 / 3, NAN]}], False)
        self.assertEqual(tables.aligned(frame), "name  n   rank  mean\n".replace("n   rank  mean", " n  rank    mean")
                         + "a      1  1     0.3333\nlong  20             -\n")
        self.assertEqual(tables.aligned(framed((number("x", ""),), [{"x": [1e-6, 0]}])), "      x\n1.0e-06\n 0.0000\n")


class ReadTest(InAFolder):
    """A column has the type that it is declared with, whatever the cells of a file look like."""

    CELLS = {"str": ("12", "", "nan", "1e5"), "int64": ("1", "20"), "Int64": ("", "3"), "float64": ("1", "0.5", "", "1e+300", "12345678901234567890")}

    def read(self, name, columns, rows):
        (self.folder / name).write_text("".join(",".join(line) + "\n" for line in (columns, *rows)))
        return read(self.folder / name)

    def expect(self, name, types):
        wanted = {"str": "object"}
        for at in range(max(map(len, self.CELLS.values()))):
            row = [self.CELLS[kind][at % len(self.CELLS[kind])] for kind in types.values()]
            for rows in ([row], [row, row], []):
                frame = self.read(name, types, rows)
                self.assertEqual({column: str(kind) for column, kind in frame.dtypes.items()},
                                 {column: wanted.get(kind, kind) for column, kind in types.items()}, (name, row))
                for column, cell in zip(types, row if rows else ()):
                    if types[column] == "str":
                        self.assertEqual(set(frame[column]), {cell})
                    else:
                        self.assertEqual([cell == "" or float(cell) == value for value in frame[column]], [True] * len(rows), column)

    def test_tables_of_conclusions(self):
        for table in conclusions.TABLES:
            self.expect(f"{table.name}.csv", {column.name: column.type for column in table.columns})

    def test_tables_of_a_run(self):
        for name in ("results", "constant", "people", "smoothed"):
            self.expect(f"{name}.csv", {"item": "str", "class": "str", "view": "str", "model": "str", "auc": "float64", "n_picks": "int64"})
        self.expect("mean_histograms_meshes.csv", {"bin_left": "float64", "GS": "float64", "class": "float64", "n_picks": "float64"})

    def test_a_frame_that_was_never_written_has_the_same_types(self):
        for table in conclusions.TABLES:
            if table.columns:
                frame = framed(table.columns, [])
                (self.folder / f"{table.name}.csv").write_text(tables.csv(frame))
                self.assertEqual(list(read(self.folder / f"{table.name}.csv").dtypes), list(frame.dtypes), table.name)

    def test_what_is_not_of_the_type_names_the_file_and_line(self):
        for column, cell in (("n", "x"), ("n", ""), ("n", "1.5"), ("mean", "x"), ("rank", "1.5")):
            with self.subTest(column, cell=cell), self.assertRaisesRegex(InputError, r"/ranking\.csv:2: .+"):
                self.read("ranking.csv", ["dataset", column], [["meshes", cell]])


class MeaningTest(unittest.TestCase):
    def test_every_table_and_column_says_what_it_is(self):
        for table in conclusions.TABLES:
            self.assertTrue(table.make.__doc__, table.name)
            self.assertEqual([column.name for column in table.columns if not column.meaning], [], table.name)
