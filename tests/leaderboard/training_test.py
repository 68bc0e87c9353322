# SPDX-License-Identifier: GPL-3.0-or-later
"""Overlap that follows from a list of training shapes: which lines name an item, and what is refused."""

import tempfile
import time
import unittest
from dataclasses import replace
from pathlib import Path

import numpy as np
import toy
from archives import CARD, EXPECTED, ODD, PROTOCOL, sound, with_card
from toy import card

from salbench import _core
from salbench.leaderboard import submission
from salbench.leaderboard.archive import read_zip, zip_of
from salbench.leaderboard.card import Card
from salbench.leaderboard.expected import Expected, trained_on
from salbench.leaderboard.texts import Manifest
from salbench.system.errors import InputError

SPLITS = "5d41402abc4b2a76b9719d911017c592"
VIEWS = Expected(PROTOCOL, "0" * 32, {"cow_300": 5, "cow_413": 5, "Ant": 3, "b.c": 2, ODD: 1}, ("cow", "Ant", "b.c", ODD), "own", SPLITS,
                 {"cow": "train", "Ant": "train+test", "b.c": "test"}, ("test", "train"),
                 {"cow_300": "cow", "cow_413": "cow", "cow_left_up": "cow", "Ant": "Ant", "b.c": "b.c", ODD: ODD})
LISTED = Card("M", trained_on=("train.txt",))
LISTS = {  # lines of a list -> items of VIEWS
    "Ant": "Ant",
    "Ant.off": "Ant",
    "data/meshes\\Ant.obj": "Ant",
    "  Ant  ": "Ant",
    "ANT.OFF": "Ant",
    "\ufeffAnt": "Ant",
    "Ant.off,train,3": "Ant",
    "Ant\ttrain": "Ant",
    '"Ant.ply", "x"': "Ant",
    "# Ant\nbee": "",
    "Antonia\nant2\nxAnt": "",
    "b.c": "b.c",
    "b.c.off": "b.c",
    "b": "",
    "cow_300\ncow_413": "cow",
    "cow_300.ply": "cow",
    "cow_599": "",
    "cow_left_up.val": "cow",
    "scans/Ant_11.ply": "Ant",
    "Ant_12": "",
    "e\N{COMBINING ACUTE ACCENT}": ODD,
    "Ant\r\n\r\nbee\r\ncow": "Ant cow",
    "/scratch/someone/ShapeNet/02691156/1a04e3ea.obj": "",
}


def handed_in(names, of=VIEWS, digest=None, key="train.txt", overlap="none"):
    """A submission with a list, read as a maintainer reads it."""
    data = names if isinstance(names, bytes) or names is None else names.encode()
    text = (CARD.replace("overlap: none", f"overlap: {overlap}") + (f"trained_on: {key}\n" if key else "")).encode()
    manifest = Manifest(configuration=_core.digest(PROTOCOL.encode()), data=of.data, trained_on=_core.digest(data or b"") if digest is None else digest)
    maps = {shape: np.zeros(n) for shape, n in of.points.items()}
    archive = submission.archive_of(text, manifest, PROTOCOL, b"", maps, data)
    return submission.checked(archive, of).card


class Training(unittest.TestCase):
    def test_lines_that_name_an_item(self):
        for lines, items in LISTS.items():
            with self.subTest(lines):
                self.assertEqual(trained_on(LISTED, lines.encode(), _core.digest(lines.encode()), VIEWS), set(items.split()))

    def test_a_list_adds_to_what_the_card_declares(self):
        found = handed_in("cow\nAnt\n", overlap="[b.c, Ant]")
        self.assertEqual((found.test_overlap, found.trained_on), (("b.c", "Ant", "cow"), ("train.txt", _core.digest(b"cow\nAnt\n"))))

    def test_a_split_of_the_data_set(self):
        for split, items in {"train": "cow Ant", "test": "Ant b.c"}.items():
            self.assertEqual(" ".join(handed_in(None, key=f"[own, {split}, {SPLITS}]").test_overlap), items, split)

    def test_what_is_refused(self):
        for what, make, said in (
                ("no such file", lambda: handed_in(None), 'has no trained_on.txt, the file "train.txt" of card.yaml'),
                ("a file that nobody names", lambda: handed_in("Ant", key=""), "has trained_on.txt, and card.yaml names no file"),
                ("a file beside a split", lambda: handed_in("Ant", key=f"[own, train, {SPLITS}]"), "names no file"),
                ("another file", lambda: handed_in("Ant", digest="0" * 32), "is not what submission.yaml has the digest of"),
                ("no digest", lambda: handed_in("Ant", digest=""), "is not what submission.yaml has the digest of"),
                ("no name", lambda: handed_in("\n# names\n"), "trained_on.txt has no name"),
                ("nothing", lambda: handed_in(b""), "trained_on.txt has no name"),
                ("another set", lambda: handed_in(None, key=f"[sal3d, train, {SPLITS}]"), 'has the layout "sal3d", and this data set has own'),
                ("other splits", lambda: handed_in(None, key="[own, train, 0a]"), f'the digest of splits "0a", and this data set has {SPLITS}'),
                *(("no such split", lambda name=name: handed_in(None, key=f"[own, {name}, {SPLITS}]"),
                   f'has the split "{name}", and this data set has test, train') for name in ("Train", "rai", "train+test")),
                ("no splits", lambda: handed_in(None, replace(VIEWS, splits=""), key="[own, train, 0a]"), "this data set has none"),
                *((f"the key {key}", lambda key=key: handed_in(None, key=key), "name a file beside the card")
                  for key in ("../train.txt", "/etc/passwd", "..", "[train]", "[a, b, c, d]", "[own, '', x]", "[]"))):
            with self.subTest(what), self.assertRaises(InputError) as refused:
                make()
            self.assertIn(said, str(refused.exception))

    def test_cards_without_a_list_are_as_before(self):
        for key in ("", "none", "~"):
            self.assertEqual(handed_in(None, key=key).trained_on, ())
        self.assertNotIn(b"trained_on", sound()["submission.yaml"])
        submission.checked(with_card(CARD), EXPECTED)

    def test_a_name_without_end_is_no_item(self):
        """Its normal form would take minutes: the time grows with the square of its marks."""
        begun = time.monotonic()
        self.assertEqual(handed_in("Ant\nAnt" + "\N{COMBINING ACUTE ACCENT}\N{COMBINING GRAVE ACCENT BELOW}" * 200_000).test_overlap, ("Ant",))
        self.assertLess(time.monotonic() - begun, 60)

    def test_names_that_are_no_text_are_no_items(self):
        self.assertEqual(handed_in(b"\xff\xfe\0Ant\n\xed\xa0\x80\nAnt\n").test_overlap, ("Ant",))


class HandIn(unittest.TestCase):
    """From the folder of a model to the ranking."""

    def test_a_list_beside_the_card(self):
        made = toy.Toy(Path(self.enterContext(tempfile.TemporaryDirectory())))
        mine = made.maps("M", 1)
        (mine / "card.yaml").write_text(card("M") + "trained_on: train.txt\n")

        def submit():
            return made.salbench("submit", mine, "--to", made.submissions / "M.zip", "-c", made.config)

        done = submit()
        self.assertEqual(done.returncode, 2)
        self.assertIn("train.txt", done.stderr)
        (mine / "train.txt").write_text("meshes/3.off\nmeshes/5.off\nmeshes/77.off\n")
        self.assertEqual(submit().returncode, 0)
        entries = read_zip((made.submissions / "M.zip").read_bytes(), 100, 1 << 24)
        self.assertEqual(entries["trained_on.txt"], (mine / "train.txt").read_bytes())
        done = made.rank()
        self.assertEqual((done.returncode, made.verdicts()), (0, {"M.zip": "beside: it has seen 2 of 6 items, more than 10 %"}))
        (row,) = made.table("submissions")
        self.assertEqual((row["test_overlap"], row["trained_on"]), ("3, 5", f"train.txt, {_core.digest(entries['trained_on.txt'])}"))
        self.assertIn("train.txt, ", made.page("models/M.html"))
        entries["trained_on.txt"] = b"77\n"  # changed on the way
        (made.submissions / "M.zip").write_bytes(zip_of(entries.items()))
        self.assertEqual(made.rank().returncode, 1)
        self.assertIn("is not what submission.yaml has the digest of", made.verdicts()["M.zip"])
