# SPDX-License-Identifier: GPL-3.0-or-later
"""Malicious submissions: a line per case, with the expected refusal. Nothing is written, and time and memory are bounded."""

import os
import resource
import struct
import tempfile
import time
import unittest
from pathlib import Path
from unittest import mock

import numpy as np
from archives import (
    CARD, EVIL, EXPECTED, ODD, Record, added, changed, npy, npy_with, records_of, saved, sound, with_card, with_field, with_manifest, with_map,
    zip_of_records,
)

from salbench.leaderboard import board, submission, texts
from salbench.leaderboard.archive import zip_of
from salbench.leaderboard.submission import npy_of
from salbench.system.errors import InputError, StorageError

GIGABYTE = 1 << 30
LIMITED = "unpacks to more than "
NO_ZIP = "cannot be read as a ZIP archive"
NO_NPY = "maps/1.npy: not a .npy file that can be read: "
NO_PART = "is no part of a submission"


def zeros(n):
    """An entry of so many zeros, which take a thousandth of that packed."""
    return Record("maps/x.npy", bytes(n), deflated=True)


def overlapping():
    inner = Record("maps/1.npy", sound()["maps/1.npy"])
    entries = [record for record in records_of(sound()) if record.name != "maps/1.npy"]
    outer = Record("card.yaml", inner.local())
    entries[[record.name for record in entries].index("card.yaml")] = outer
    at = sum(len(record.local()) for record in entries[:entries.index(outer)])
    inner.at = at + len(outer.local()) - len(inner.local())
    return zip_of_records([*entries, inner])


def zip64(size):
    """An entry whose real size stands in the extra field, as large as it likes."""
    return added(Record("maps/x.npy", b"x", size=0xffffffff, packed=0xffffffff, extra=struct.pack("<HHQQ", 1, 16, size, size)))


def million():
    central = Record("a", b"").central(0)
    return Record("a", b"").local() + central * 1_000_000 + b"PK\5\6" + struct.pack("<4H2IH", 0, 0, 0xffff, 0xffff, len(central) * 1_000_000, 31, 0)


ALIASES = "a0: &a0 [x, x]\n" + "".join(f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]\n" for i in range(1, 9)) + "name: *a8\n"

# name of the case: how the archive is made, and what is said of it
ARCHIVES = {
    "gigabytes of zeros": (lambda: added(zeros(GIGABYTE // 16)), LIMITED),
    "more than it declares": (lambda: changed("maps/1.npy", content=bytes(GIGABYTE // 16), deflated=True, size=168), "Bad CRC"),
    "gigabytes declared": (lambda: added(Record("maps/x.npy", b"x", size=2 * GIGABYTE)), LIMITED),
    "less than it declares": (lambda: changed("maps/1.npy", size=200), "is cut short: 168 of 200 bytes"),
    "an archive in an archive": (lambda: with_map(zip_of([("maps/1.npy", b"x")])), NO_NPY),
    "entries that overlap": (overlapping, NO_ZIP),
    "entries that share bytes": (lambda: changed("maps/2.npy", at=0), "File name in directory"),
    "entries that are unpacked again and again": (lambda: added(*(Record(f"x{i}", b"", packed=1000, at=0) for i in range(20))), "has entries that overlap"),
    "path traversal": (lambda: added(Record("../evil", b"x")), '"../evil" is no part of a submission'),
    "an absolute name": (lambda: added(Record("/etc/passwd", b"x")), '"/etc/passwd" is no part of a submission'),
    "a link": (lambda: changed("maps/1.npy", attributes=0o120777), "is a link or a device"),
    "a device": (lambda: changed("maps/1.npy", attributes=0o020666), "is a link or a device"),
    "an entry twice": (lambda: added(Record("maps/1.npy", b"x")), "has an entry twice"),
    "another case": (lambda: added(Record("Card.yaml", b"x")), NO_PART),
    "another normalisation": (lambda: added(Record(b"maps/e\xcc\x81.npy", b"x")), "there is no such item with ground truth"),
    "a name that is not UTF-8": (lambda: added(Record(b"maps/\xff.npy", b"x", flags=0)), NO_ZIP),
    "another checksum": (lambda: changed("maps/1.npy", crc=1), "Bad CRC"),
    "encrypted": (lambda: changed("maps/1.npy", flags=1), "is encrypted"),
    "an unknown compression": (lambda: changed("maps/1.npy", method=12), "is compressed by method 12"),
    "zip64 that lies": (lambda: zip64(1 << 60), LIMITED),
    "a million entries": (million, "can be read"),
    "a hundred entries": (lambda: added(*(Record(f"x{i}", b"") for i in range(100))), "has 107 entries, expected at most 36"),
    "thousands of entries": (lambda: added(*(Record(f"x{i}", b"") for i in range(5000))), "has a directory of "),
    "no archive": (lambda: b"hello" * 100, NO_ZIP),
    "something else": (lambda: added(Record("run.sh", b"rm")), '"run.sh" is no part of a submission'),
    "no card": (lambda: zip_of([*(row for row in sound().items() if row[0] != "card.yaml")]), "has no card.yaml"),
    "a folder around its files": (lambda: zip_of([(f"mine/{name}", content) for name, content in sound().items()]), "has a folder around its files"),
    "no map": (lambda: zip_of([*(row for row in sound().items() if row[0] != "maps/2.npy")]), "has no map of 1 of 3 items, such as 2"),
    "a map of nobody": (lambda: added(Record("maps/77.npy", b"x")), '"maps/77.npy" is no part of a submission: there is no such item'),
    # .npy
    "objects": (lambda: with_map(saved(np.array([{}] * 5, dtype=object))), "Object arrays cannot be loaded"),
    "a pickle": (lambda: with_map(EVIL), NO_NPY),
    "a pickle behind a header": (lambda: with_map(npy_with(descr="'|O'", body=EVIL)), "Object arrays cannot be loaded"),
    "two columns": (lambda: with_map(saved(np.asfortranarray(np.zeros((5, 2))))), "expected one value per point"),
    "a huge shape": (lambda: with_map(npy_with(f"({10 ** 18},)")), NO_NPY),
    "a negative shape": (lambda: with_map(npy_with("(-5,)")), NO_NPY),
    "no shape": (lambda: with_map(npy_with("()")), "expected one value per point"),
    "values of a gigabyte each": (lambda: with_map(npy_with(descr="'V1000000000'")), NO_NPY),
    "values of no bytes": (lambda: with_map(npy_with(f"({10 ** 15},)", descr="'V0'")), "its type is "),
    "code in the header": (lambda: with_map(npy("__import__('os').system('touch /tmp/salbench-was-here')")), NO_NPY),
    "no header": (lambda: with_map(b"\x93NUMPY\x01\x00\xff\xff"), NO_NPY),
    "texts": (lambda: with_map(saved(np.array(["a"] * 5))), "its type is "),
    "whole numbers": (lambda: with_map(saved(np.arange(5))), "its type is "),
    "big-endian": (lambda: with_map(saved(np.arange(5, dtype=">f8"))), "its type is "),
    "bytes behind the values": (lambda: with_map(npy_of(np.zeros(5)) + b"x"), "its shape is (5,), and 1 bytes are left behind its values"),
    "another number of points": (lambda: with_map(npy_of(np.zeros(6))), "maps/1.npy: 6 values, but the shape has 5 points"),
    "no number": (lambda: with_map(npy_of(np.full(5, np.nan))), "value 0 (0-based) is nan, expected a finite number"),
    "infinity": (lambda: with_map(npy_of(np.array([0, np.inf, 0, 0, 0]))), "value 1 (0-based) is inf"),
    # card
    "aliases that multiply": (lambda: with_card(ALIASES), "card.yaml:2: an alias"),
    "an alias of itself": (lambda: with_card("name: &a [*a]\n"), "an alias"),
    "a tag of Python": (lambda: with_field("url", "!!python/object/apply:os.system [touch /tmp/salbench-was-here]"), "the tag "),
    "brackets without end": (lambda: with_card("name: " + "[" * 60000), "card.yaml"),
    "megabytes of text": (lambda: with_card(CARD + "# " + "x" * (1 << 16)), "expected at most 65536"),
    "a long value": (lambda: with_field("citation", "x" * 2001), "citation has 2001 bytes, expected at most 2000"),
    "no mapping": (lambda: with_card("just text\n"), "expected lines such as `name: ...`"),
    "not UTF-8": (lambda: with_card(b"name: \xff\n"), "is not UTF-8"),
    "a control character": (lambda: with_field("url", '"a\\b"'), "url has a control character"),
    "several lines": (lambda: with_field("url", '"a\\n# b"'), "url has several lines"),
    "a colon": (lambda: with_field("citation", "A and B: C: a model"), "mapping values are not allowed in this context; put a text with"),
    "a list for a name": (lambda: with_field("name", "[A, B]"), "name has a list"),
    "a name of HTML": (lambda: with_field("name", "<script>alert(1)</script>"), 'name "<script>'),
    "a name of a path": (lambda: with_field("name", "../index"), "must be 1 to "),
    "a name of right-to-left": (lambda: with_field("name", "\N{RIGHT-TO-LEFT OVERRIDE}A"), "must be 1 to "),
    "a name of 300 characters": (lambda: with_field("name", "x" * 300), "must be 1 to "),
    **{f"the name of the program's {name}": (lambda name=name: with_field("name", name), "is the name of something else")
       for name in ("HS", "hs", "Rs", "RS", "ls", "CONSTANT", "Constant", "gs", "AVG")},
    "keys missing": (lambda: with_card("name: A\ncitation: x\nlicence: ~\n"), "lacks licence, training_data, test_overlap"),
    "an unknown key": (lambda: with_card(CARD + "licens: x\n"), "did you mean 'licence'?"),
    **{f"the date {date}": (lambda date=date: with_field("date", date), f'date is "{shown}"')
       for date, shown in (("soon", "soon"), ("2026-02-30", "2026-02-30"), ("2026-13-01", "2026-13-01"), ("0000-01-01", "0000-01-01"),
                           ("2026-1-1", "2026-1-1"), ("20260101", "20260101"), ("\N{FULLWIDTH DIGIT TWO}026-01-01", "\N{FULLWIDTH DIGIT TWO}026-01-01"), ("\N{RIGHT-TO-LEFT OVERRIDE}1", "?1"))},
    **{f"no line in {key}, {value[:12]}": (lambda key=key, value=value: with_field(key, value), "card.yaml:" + (f" {key} has a" if "ud" not in value else ""))
       for key in ("name", "citation", "licence", "training_data", "date", "url", "test_overlap")
       for value in (r'"\ud800"', r'"a\u2028b"', r'"\x85"', r'"a\tb"', r'"\udfff x"')},
    **{f"no line in {key}, {value[:12]}": (lambda key=key, value=value: with_manifest(key, value), "submission.yaml:" + (f" {key} " if "ud" not in value else ""))
       for key in ("program", "commit", "protocol", "data", "format", "maps", "stages")
       for value in (r'"\ud800"', r'["\ud800"]', r'"a\u2029b"', "x" * 3000, '"a\\nb"')},
    **{f"the program {text}": (lambda text=text: with_manifest("program", f"'{text}'"), 'program is "')
       for text in ("salbench", "1.0.0 <script>", "checked and found best", "1.0", "1.0.0-" + "x" * 30)},
    **{f"{key} of {value[:20]}": (lambda key=key, value=value: with_card(CARD + f"{key}: {value}\n"), said) for key, value, said in (
        ("parameters", "1.2M", 'parameters is "1.2M", expected how many'), ("parameters", "-1", "expected how many"), ("parameters", "9" * 40, "expected how many"),
        ("code", "javascript:alert(1)", 'code is "javascript:alert(1)", expected an address'), ("code", "none", "expected an address that begins with https://, or closed"),
        ("weights", "file:///etc/passwd", "expected an address"), ("training_set", "'https://a b'", "expected an address"),
        ("container", "image:latest", "expected an image by its digest"), ("container", "a@sha256:" + "0" * 63, "expected an image by its digest"),
        ("seeds", "[../1]", 'seeds has "../1", expected names'), ("seeds", "['<b>']", "expected names"),
        ("seeds", "[1, 2, 3, 4, 5, 6, 7, 8, 9, 10]", "seeds has 10 names, expected at most 9"), ("seeds", "[1]", "seeds/1 has no map of 3 of 3 items"),
        ("reproduced_by", "{a: b}", "has a list or mapping"), ("contact", '"a\\nb"', "contact has several lines"),
        ("versoin", "1", "did you mean 'version'?"))},
    **{f"{key} of {value}": (lambda key=key, value=value: with_manifest(key, value), said) for key, value, said in (
        ("made_by", "magic", 'made_by is "magic", expected one of files'), ("seconds", "[1]", "expected the median and the 95th percentile"),
        ("seconds", "[fast, nan]", "expected the median"), ("files", "[x predict.py]", 'files has "x predict.py", expected a SHA-256'),
        ("map_digest", "'0'", "the maps are not what submission.yaml has the digest of"), ("model", "'0'", "has no model.yaml, of which"))},
    "a map of an unknown seed": (lambda: added(Record("seeds/1/1.npy", b"x")), "card.yaml has no such seed"),
    "a seed of a path": (lambda: added(Record("seeds/../1.npy", b"x")), "card.yaml has no such seed"),
    "a model without its digest": (lambda: added(Record("model.yaml", b"command: touch /tmp/salbench-was-here")), "model.yaml is not what submission.yaml has the digest of"),
    "an anchor twice": (lambda: with_card("name: &a A\ncitation: &a B\n"), "card.yaml: "),
    "an overlap of words": (lambda: with_field("test_overlap", "13 of 19 items"), "write none, or a list of the items"),
    "an overlap of others": (lambda: with_field("test_overlap", "[1, 77]"), 'test_overlap has "77", but there is no such item'),
}


class Hostile(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def read(self, data, name="a.zip"):
        path = self.folder / name
        path.write_bytes(data)
        return self.taken(path)

    def taken(self, path):
        return submission.read(path, EXPECTED, self.folder)

    def test_what_strangers_may_send(self):
        for name, (make, said) in ARCHIVES.items():
            with self.subTest(name):
                data = make()
                begun = time.monotonic()
                with self.assertRaises(InputError) as refused:
                    submission.checked(data, EXPECTED) if len(data) < 1 << 20 else self.read(data)
                self.assertIn(said, str(refused.exception))
                self.assertEqual(str(refused.exception).count("\n"), 0)
                self.assertLess(time.monotonic() - begun, 60)
        self.assertLess(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss << 10, GIGABYTE)
        self.assertFalse(Path("/tmp/salbench-was-here").exists())

    def test_a_text_is_a_line(self):
        for text in ("", "a", "x" * 2000, "\N{RIGHT-TO-LEFT OVERRIDE}a", "\N{GRINNING FACE}" * 500, "<b>"):
            self.assertEqual(texts.line(text, "it"), text)
        for text in ("\ud800", "a\udfff", "\udc80", "a\nb", "\r", "\0", "\x1b[31m", "\x7f", "\x85", "\u2028", "\u2029", "x" * 2001, "\N{GRINNING FACE}" * 501,
                     ["a"], None, 3):
            with self.subTest(repr(text)[:20]), self.assertRaisesRegex(InputError, "^it (has|is) a? ?"):
                texts.line(text, "it")

    def test_what_is_odd_and_sound(self):
        for name, data in {
            "packed": zip_of_records([Record(name, content, deflated=True) for name, content in sound().items()]),
            "with folders": zip_of_records([Record("maps/", b"", attributes=0o040755), *records_of(sound())]),
            "float32": with_map(saved(np.arange(5, dtype="<f4"))),
            "a column": with_map(saved(np.zeros((5, 1)))),
            "a row, by columns": with_map(saved(np.asfortranarray(np.zeros((1, 5))))),
            "a folded line": with_field("citation", ">\n  A,\n  B\n"),
            "a list without overlap": with_field("test_overlap", "[]"),
            "an address of a script": with_field("url", "javascript:alert(1)"),
            "a formula": with_field("citation", "'=HYPERLINK(\"http://evil\")'"),
            "HTML": with_field("licence", "'<script>alert(1)</script>'"),
            "a version": with_manifest("program", "1.0.0"),
            "a later version": with_manifest("program", "12.30.4-rc.1"),
            "code and weights as 1.1 named them": with_card(CARD + "files: [a, ../b]\n"),
            "a key twice": with_card("name: OTHER\n" + CARD),
            "an overlap": with_field("test_overlap", f"[1, {ODD}]"),
        }.items():
            with self.subTest(name):
                read = submission.checked(data, EXPECTED)
                self.assertEqual({item: len(values) for item, values in read.maps.items()}, EXPECTED.points)
        self.assertEqual(read.card.test_overlap, ("1", ODD))

    def test_damage_at_every_byte_and_length_is_a_refusal_or_no_damage(self):
        entries = sound()
        data = zip_of_records([*records_of(entries)])
        refused = 0
        for place in range(0, len(data), 3):
            bad = bytearray(data)
            bad[place] ^= 0x55
            try:
                maps = submission.checked(bytes(bad), EXPECTED).maps
                self.assertEqual([list(values) for values in maps.values()], [list(np.arange(n) / n) for n in EXPECTED.points.values()], place)
            except InputError:
                refused += 1
        self.assertGreater(refused, len(data) // 3 // 2)
        for length in range(0, len(data), 7):
            with self.assertRaises(InputError):
                submission.checked(data[:length], EXPECTED)

    def test_a_defect_that_an_archive_leads_to_refuses_it_and_no_other(self):
        entries = [board.Entry(self.folder / f"{name}.zip") for name in ("fails", "good")]
        for number, entry in enumerate(entries):
            entry.file.write_bytes(zip_of(sound(CARD.replace("MINE", f"M{number}")).items()))
        whole = submission.checked
        with mock.patch.object(submission, "checked", lambda data, expected: 1 / 0 if b"M0" in data else whole(data, expected)):
            board.check_all(entries, EXPECTED, self.folder, [])
        read = entries[1].read
        self.assertEqual(entries[0].refused, "a defect of salbench: ZeroDivisionError: division by zero")
        self.assertEqual((read.card.name, read.manifest.program, read.results, entries[1].refused), ("M1", "", "scores", ""))
        self.assertEqual({item: list(values) for item, values in read.maps.items()}, {item: list(np.arange(n) / n) for item, n in EXPECTED.points.items()})

    def test_a_full_disk_is_no_refusal(self):
        for scratch in (self.folder / "none", Path("/proc")):
            (self.folder / "a.zip").write_bytes(zip_of(sound().items()))
            with self.assertRaisesRegex(StorageError, f"{scratch}: cannot be written: No such file or directory; set TMPDIR to another"):
                submission.read(self.folder / "a.zip", EXPECTED, scratch)

    def test_files_that_are_none(self):
        os.mkfifo(self.folder / "pipe.zip")
        (self.folder / "link.zip").symlink_to(self.folder / "nowhere")
        for name, said in (("pipe.zip", "not a regular file"), ("link.zip", "cannot be read: No such file")):
            with self.subTest(name), self.assertRaises(InputError) as refused:
                self.taken(self.folder / name)
            self.assertIn(said, str(refused.exception))
