# SPDX-License-Identifier: GPL-3.0-or-later
"""Our own folders: whole files, no link followed, the last of two calls wins; and files and YAML of strangers, which may be anything."""

import os
import tempfile
import tracemalloc
import unittest
from pathlib import Path

import yaml

from salbench import _core
from salbench._errors import InputError, StorageError
from salbench._files import OwnFolder, read_file
from salbench._yaml import flow_text, plain_text


class InAFolder(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def everything(self, folder=None):
        return {str(path.relative_to(self.folder)): path.read_bytes() for path in (folder or self.folder).rglob("*") if path.is_file()}


# What a name of the folder may be in place of a file or a folder of ours: how it is made, beside a folder `theirs` with a file.
LINKS = {
    "a link to a file": lambda path: path.symlink_to("../theirs/years"),
    "a link that leads nowhere": lambda path: path.symlink_to("nowhere"),
    "a link to zeros": lambda path: path.symlink_to("/dev/zero"),
    "a link to itself": lambda path: path.symlink_to(path.name),
    "a pipe": os.mkfifo,
    "nothing": lambda path: None,
    "a file": lambda path: path.write_text("before"),
    "a hard link": lambda path: path.hardlink_to(path.parent.parent / "theirs/years"),
}


class Own(InAFolder):
    def setUp(self):
        super().setUp()
        (self.folder / "theirs").mkdir()
        (self.folder / "theirs/years").write_text("of work")
        self.path = self.folder / "ours"
        self.theirs = self.everything()

    def own(self, **options):
        return OwnFolder(self.path, "choose another", **options)

    def expect_theirs(self):
        self.assertEqual(self.everything(self.folder / "theirs"), self.theirs)

    def test_a_file_takes_the_place_of_whatever_has_its_name(self):
        for name, make in LINKS.items():
            with self.subTest(name), self.own() as own:
                make(self.path / "file")
                own.write("file", b"new")
                self.assertEqual((own.read("file"), (self.path / "file").is_symlink()), (b"new", False))
                own.remove("file")
                make(self.path / "file")
                own.remove("file")
                self.assertEqual(os.listdir(self.path), [])
                self.expect_theirs()

    def test_what_is_no_file_of_bounded_size_is_not_read(self):
        for name, make in LINKS.items():
            with self.subTest(name), self.own() as own:
                make(self.path / "file")
                expected = {"a file": b"before", "a hard link": b"of work"}.get(name)
                self.assertEqual((own.read("file"), own.head("file")), (expected, expected or b""))
                self.assertEqual(own.read("file", 3), None)
                own.remove("file")

    def test_a_small_file_takes_little_memory(self):
        with self.own() as own:
            own.write("file", b"new")
            tracemalloc.start()
            self.addCleanup(tracemalloc.stop)
            self.assertEqual(own.read("file"), b"new")
            self.assertLess(tracemalloc.get_traced_memory()[1], 1 << 20)

    def test_no_folder_is_reached_through_a_link(self):
        self.path.mkdir()
        (self.path / "link").symlink_to("../theirs")
        (self.path / "deep").mkdir()
        (self.path / "deep/link").symlink_to("../../theirs")
        for name in ("link/years", "link/new", "deep/link/years"):
            for work in (lambda own: own.write(name, b"x"), lambda own: own.remove(name), lambda own: own.read(name),
                         lambda own: own.append(name, b"x"), lambda own: own.require_folder(os.path.dirname(name))):
                with self.subTest(name), self.own() as own, self.assertRaisesRegex(InputError, "link: is a link, and is not followed; .*choose another"):
                    work(own)
        with self.own() as own:
            for folder in ("link", "deep"):
                own.remove_empty(folder)
        self.expect_theirs()
        self.assertTrue((self.path / "link").is_symlink())

    def test_a_folder_that_is_a_link_is_followed_if_whoever_calls_has_named_it(self):
        self.path.symlink_to("theirs")
        with self.own() as own:
            self.assertEqual(own.read("years"), b"of work")
        with self.assertRaisesRegex(InputError, "is a link"):
            self.own(follow=False)

    def test_what_a_call_was_ended_in_is_removed_by_the_next(self):
        left, kept = ".0123456789abcdef.unfinished", ".notes.unfinished"
        for folder in (".", "sub/deep", "other"):
            (self.path / folder).mkdir(parents=True, exist_ok=True)
            for name in (left, kept):
                (self.path / folder / name).write_text("half")
                os.utime(self.path / folder / name, (0, 0))
        (self.path / "sub/.fedcba9876543210.unfinished").write_text("of a call at work")
        with self.own(below=["sub", "missing"]):
            found = set(self.everything(self.path))
        self.assertEqual(found, {f"ours/{name}" for name in ("sub/.fedcba9876543210.unfinished", kept, f"sub/deep/{kept}", f"other/{kept}", f"other/{left}")})

    def test_a_write_that_fails_leaves_what_was_there(self):
        with self.own() as own:
            own.write("file", b"before")
            os.mkdir(self.path / "folder")
            for name in ("folder", "file/below", "x" * 300):
                with self.subTest(name), self.assertRaisesRegex(StorageError, "cannot be written: .*; choose another"):
                    own.write(name, b"new")
            self.assertEqual((sorted(os.listdir(self.path)), own.read("file")), (["file", "folder"], b"before"))

    def test_the_last_of_two_calls_wins(self):
        with self.own() as first, self.own() as second:
            first.write("by", b"the first")
            second.write("by", b"the second")
        self.assertEqual((os.listdir(self.path), (self.path / "by").read_text()), (["by"], "the second"))


class Strangers(InAFolder):
    def test_files(self):
        (self.folder / "large").write_bytes(bytes(11))
        os.mkfifo(self.folder / "pipe")
        (self.folder / "zeros").symlink_to("/dev/zero")
        (self.folder / "link").symlink_to("large")
        (self.folder / "loop").symlink_to("loop")
        for name, said in (("large", "11 bytes: at most 10 can be read; shorten it"), ("link", "11 bytes"), ("pipe", "is not a regular file"),
                           ("zeros", "is not a regular file"), (".", "is a folder, where a file is expected"), ("none", "No such file or directory"),
                           ("loop", "Too many levels"), ("large/below", "Not a directory"), ("a\0b", "is no name of a file")):
            with self.subTest(name), self.assertRaises(InputError) as caught:
                read_file(self.folder / name, 10, "shorten it")
            self.assertIn(said, str(caught.exception))
        self.assertEqual(read_file(self.folder / "large", 11), bytes(11))

    def test_yaml(self):
        bombs = {"[" * 100_000: "x:1: is nested too deeply", "- " * 100_000: "is nested too deeply", "{a: " * 100_000: "is nested too deeply",
                 "a: " + "[" * 30 + "]" * 30: "is nested too deeply", "".join(" " * i + "-\n" for i in range(1000)): "x:21: is nested too deeply",
                 "a: &a [x]\nb: *a\n": "x:2: an alias", "a: &a [*a]\n": "an alias", "a: !!python/object:os.system x\n": "the tag ",
                 "a: !own x\n": "the tag ", "a: [\n": "x:2: ", "a: b: c\n": "x:1: ", "\ud800": "is not UTF-8", "a: \x01": "x", "x" * 2_000_000: "2000000 bytes"}
        for text, said in bombs.items():
            with self.subTest(text[:30]), self.assertRaises(InputError) as caught:
                plain_text(text.encode("utf-8", "surrogatepass"), "x", 1_000_000)
            self.assertIn(said, str(caught.exception))
            self.assertEqual(str(caught.exception).count("\n"), 0)
        self.assertEqual(plain_text(b"a: {b: [1, 2]}\n", "x", 100), "a: {b: [1, 2]}\n")

    def test_values_as_yaml(self):
        for text in ("a", "\U00020bb7 and \U0001f600", "\\", "\\\U00020bb7", "\\ud842\\udfb7", "\x7f\x85\u2028\ufeff", "'\": [", "\ue000\uffff", "\0\n"):
            with self.subTest(text):
                written = flow_text({text: [text]})
                self.assertTrue(written.isascii())
                self.assertEqual(yaml.safe_load(written), {text: [text]})
                if "\0" not in text:
                    _core.protocol(f"data: {flow_text(text)}\n", "x")  # the program's reader
        self.assertEqual(flow_text({"b": 1.5, "a": [None, True]}, sort_keys=True), '{"a": [null, true], "b": 1.5}')
