# SPDX-License-Identifier: GPL-3.0-or-later
"""Our own folders: whole files, no link followed, as they were until all is there; and files and YAML of strangers, which may be anything."""

import os
import unittest.mock

import yaml

import toy
from salbench import _core
from salbench.system import files
from salbench.system.errors import InputError, StorageError
from salbench.system.files import FolderUpdate, read_file, replace_file
from salbench.system.yaml import flow_text, plain_text


class InAFolder(toy.InAFolder):
    def everything(self, folder=None):
        return {str(path.relative_to(self.folder)): path.read_bytes() for path in (folder or self.folder).rglob("*") if path.is_file()}


class Own(InAFolder):
    def setUp(self):
        super().setUp()
        (self.folder / "theirs").mkdir()
        (self.folder / "theirs/years").write_text("of work")
        self.path = self.folder / "ours"
        self.path.mkdir()
        for name in ("index", "stale/file"):
            (self.path / name).parent.mkdir(exist_ok=True)
            (self.path / name).write_text("before")

    def update(self):
        return FolderUpdate(self.path, "choose another")

    def expect(self, **files):
        self.assertEqual(self.everything(), {"theirs/years": b"of work", **{f"ours/{name}": data for name, data in files.items()}})

    def test_the_folder_is_as_it_was_until_all_is_there(self):
        before = self.everything()
        with self.assertRaises(ZeroDivisionError), self.update() as update:
            update.write("new/file", b"half")
            raise ZeroDivisionError
        self.assertEqual(self.everything(), before)
        with self.update() as update:
            update.write("index", b"new")
            update.write("new/file", b"whole")
            self.assertEqual([(self.path / name).read_text() for name in ("index", "stale/file")], ["before", "before"])
            update.put("new/drawing", b"at once")
            self.assertEqual((self.path / "new/drawing").read_bytes(), b"at once")
            with unittest.mock.patch("os.replace", side_effect=os.replace) as replace:
                update.finish(last="index")
            self.assertEqual([call.args[1].name for call in replace.call_args_list], ["file", "index"])
            update.remove("stale/file")
            update.remove("missing")
        self.expect(index=b"new", **{"new/file": b"whole", "new/drawing": b"at once"})
        self.assertFalse((self.path / "stale").exists())

    def test_what_a_killed_call_left_is_removed_and_a_call_at_work_fails(self):
        killed, first = self.update(), self.update()
        killed.path.joinpath(".unfinished-0123").mkdir()
        first.write("index", b"of the first")
        with self.update() as second:
            for work in (lambda: first.write("more", b"x"), lambda: first.finish(last="index")):
                self.assertRaisesRegex(StorageError, "ours: another call has begun to write it: let that one end, or choose another", work)
            second.write("index", b"of the second")
            second.finish(last="index")
        self.expect(index=b"of the second", **{"stale/file": b"before"})
        self.assertEqual(sorted(os.listdir(self.path)), ["index", "stale"])

    def test_no_link_is_followed(self):
        (self.path / "index").unlink()
        (self.path / "index").symlink_to("../theirs/years")
        (self.path / "link").symlink_to("../theirs")
        with self.update() as update:
            refused = "link: is a link, and is not followed; remove it, or choose another"
            self.assertRaisesRegex(InputError, refused, update.remove, "link/years")
            self.assertRaisesRegex(InputError, refused, update.put, "link/years", b"new")
            update.write("index", b"new")
            update.finish(last="index")
            update.write("link/below/years", b"new")
            self.assertRaisesRegex(InputError, refused, update.finish, "index")
        self.expect(index=b"new", **{"stale/file": b"before"})

    def test_what_cannot_be_written_is_named(self):
        with self.update() as update:
            self.assertRaisesRegex(StorageError, "ours/x+: cannot be written: File name too long; choose another", update.write, "x" * 300, b"")
        self.assertRaisesRegex(StorageError, "index: cannot be created: .*; choose another", FolderUpdate, self.path / "index", "choose another")

    def test_a_file_is_replaced_whole(self):
        left, held = self.path / "0123456789abcdef.salbench-part", self.path / "a.salbench-part"
        left.write_text("half")
        with open(held, "wb") as file:  # as by a call at the same time
            files._hold(file)
            replace_file(self.path / "index", b"new")
            with self.assertRaises(OSError):
                replace_file(self.path / "stale", b"new")
            self.expect(index=b"new", **{"stale/file": b"before", held.name: b""})


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
