# SPDX-License-Identifier: GPL-3.0-or-later
"""Old command lines are accepted; tables and exports that they write have what old ones have."""

import csv
import re
import subprocess
import sys

import h5py
import numpy

import support

LINES = [line.removeprefix("salbench ") for line in (support.EXAMPLES / "commands.txt").read_text().splitlines() if line[0] != "#"]
READER = support.EXAMPLES.parents[2] / "docs/examples/read_export.py"


def tables(folder):
    """Columns of each table of results below a folder, by its path."""
    found = {}
    for path in sorted(path for pattern in ("out*/*.csv", "concluded*/*.csv", "site/data/*.csv", "imported/*.csv") for path in folder.glob(pattern)):
        with open(path, encoding="utf-8", newline="") as file:
            found[str(path.relative_to(folder))] = next(csv.reader(line for line in file if line[0] != "#"))
    return found


def objects(path):
    """Content of an export by name: type and number of dimensions of a data set, type of an attribute."""
    found = {}

    def add(name, entry):
        if isinstance(entry, h5py.Dataset):
            columns = entry.dtype.names
            found[name] = (columns or entry.dtype.str, entry.ndim)
        found.update({f"{name}@{key}": numpy.asarray(value).dtype.kind for key, value in entry.attrs.items()})
    with h5py.File(path) as file:
        add("", file)
        file.visititems(add)
    return found


class Commands(support.OldExamples):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.ended = [(line, support.salbench(cls.folder, line)) for line in LINES]

    def test_each_line_is_accepted(self):
        for line, done in self.ended:
            with self.subTest(line):
                self.assertEqual(done.returncode, 0, done.stderr)

    def test_each_option_has_a_line(self):
        """A new one needs a line in examples/commands.txt, by which it is promised."""
        given = {}
        for line in LINES:
            words = line.split()
            given.setdefault(words[0], set()).update(word for word in words if word[0] == "-")
        whole = self.said("--help").split("Subcommands", 1)[1].split("Examples:")[0]
        for name in re.findall(r"^  ([a-z]+)  ", whole, flags=re.M):
            for option in re.findall(r"^  ((?:-\w \w+, )?--[a-z-]+)", self.said(f"{name} --help"), flags=re.M):
                self.assertTrue(given.get(name, set()).intersection(re.findall("--?[a-z-]+", option)), f"{name} {option}")

    def test_tables_begin_with_their_old_columns(self):
        """In either of its forms: a table has a column `split` if items are in splits. New ones stand behind them, and `remarks` is the last."""
        today = [(path.rpartition("/")[2], columns) for path, columns in tables(self.folder).items()]
        for line in (support.EXAMPLES / "columns.txt").read_text(encoding="utf-8").splitlines():
            name, columns = line.split(": ")
            old, remarks = columns.removesuffix(",remarks").split(","), columns.endswith(",remarks")
            self.assertIn((name, old, remarks), [(other, columns[:len(old)], columns[-1] == "remarks") for other, columns in today])

    def test_a_submission_of_format_1_is_ranked(self):
        """One that was written before there were digests of maps in it."""
        with open(self.folder / "site_of_older/data/submissions.csv", encoding="utf-8", newline="") as file:
            self.assertEqual([(row["model"], row["status"], row["remark"]) for row in csv.DictReader(file)], [("HEIGHT", "ranked", "")])

    def test_the_documented_reader_reads_an_old_export(self):
        done = subprocess.run([sys.executable, "-B", READER, self.folder / "export.h5"], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual([line.split()[1] for line in done.stdout.splitlines() if line.split()[0] == "meshes"], ["LS", "RS"])

    def test_an_export_has_what_an_old_one_has(self):
        old, today = objects(self.folder / "export.h5"), objects(self.folder / "today.h5")
        scores, columns = old.pop("scores"), today.pop("scores")
        self.assertEqual({name: (kind, today.get(name)) for name, kind in old.items() if today.get(name) != kind}, {})
        self.assertEqual(columns[0][:len(scores[0])], scores[0])
