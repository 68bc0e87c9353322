# SPDX-License-Identifier: GPL-3.0-or-later
"""A system in trouble while `import` and `inspect` are at work (full disks, limits, no memory, killed processes): status 3, and the set as it was.
Nothing that a file holds is to blame. The set is one of which a source has changed and another one is gone, so that a call that goes on would
write and remove. Processes that read by themselves: tests/python/workers_test.py."""

import dataclasses
import errno
import os
import resource
import subprocess
from unittest import mock

import salbench
from salbench.datasets import importing, inspecting, write
from salbench.system.errors import StorageError, UnreadableError
from own_sets import PLAIN, doing
from support import WithArchive, lines, off, read_here
from tests.support import forked

# Causes that end the reading process from outside, and the messages.
OF_THE_SYSTEM = {
    "no memory for a file": ("from salbench.system.files import fail; fail(item.files[1], 'read', OSError(12, ''))", "v/cow.txt: cannot be read: Cannot allocate memory"),
    "killed": ("os.kill(os.getpid(), 9)", "cow.off: the process that reads it was ended from outside, twice .signal 9: .*; run it again, with more memory"),
}
# Causes that may lie in the file: `inspect` names it and continues.
OF_A_FILE = {
    "not handed over": ("from salbench.system.files import fail; fail(item.files[1], 'read', OSError(5, ''))", "v/cow.txt: cannot be read: Input/output"),
    "no memory": ("import numpy; numpy.zeros(1 << 45)", "cow.off: no memory for"),
}


class Trouble(WithArchive):
    def setUp(self):
        super().setUp()
        self.mine, self.to = self.root.parent / "mine.py", self.root.parent / "to"
        for name in ("cat", "cow", "dog", "eel"):
            self.write({f"m/{name}.off": off(), f"v/{name}.txt": lines([1, 2, 3, 4])})
        self.mine.write_text(PLAIN)
        self.imported()
        self.before = self.files()
        self.write({"v/cow.txt": lines([4, 3, 2, 2]), "m/eel.off": None, "v/eel.txt": None})

    def files(self):
        return {str(path.relative_to(self.to)): (path.stat().st_mtime_ns, path.read_bytes()) for path in self.to.rglob("*") if path.is_file()}

    def imported(self):
        return importing.import_set(str(self.mine), str(self.root), str(self.to))

    def refused(self, work, said):
        with self.assertRaisesRegex(StorageError, said) as caught:
            work()
        self.assertNotRegex(str(caught.exception), "\n|damaged|write the file again|defect")
        self.assertEqual(self.files(), self.before)

    def test_of_the_process_that_reads(self):
        for name, (trouble, said) in (OF_THE_SYSTEM | OF_A_FILE).items():
            self.mine.write_text(doing(cow=trouble))
            with self.subTest(name):
                self.refused(self.imported, f"{said}.*; the set in {self.to} is as it was")
                if name in OF_A_FILE:
                    self.assertRegex(inspecting.inspected(str(self.mine), str(self.root))["problems"][0], said)
                else:
                    self.refused(lambda: inspecting.inspected(str(self.mine), str(self.root)), said)

    def test_of_the_folder_of_the_set(self):
        """At each of the files: what is changed, the index."""
        self.enterContext(mock.patch.object(importing, "ask_all", read_here))
        for number in (errno.ENOSPC, errno.EROFS, errno.EMFILE):
            for at, name in enumerate(("items/cow.h5", "index.csv")):
                written = mock.Mock(side_effect=[None] * at + [OSError(number, os.strerror(number))])
                with self.subTest(errno.errorcode[number], at=at):
                    self.refused(mock.patch("salbench.system.files.os.fsync", written)(self.imported),
                                 f"{self.to}/{name}: cannot be written: {os.strerror(number)}; choose another")

    def test_of_this_process(self):
        for what, error in (("subprocess.Popen", OSError(errno.EAGAIN, os.strerror(errno.EAGAIN))), ("salbench.system.workers._loaded", MemoryError()),
                            ("salbench.system.workers._loaded", OSError(errno.EMFILE, os.strerror(errno.EMFILE), "out")),
                            ("salbench.datasets.files.os.scandir", OSError(errno.EACCES, os.strerror(errno.EACCES), "m")),
                            ("salbench._core.native_listing", UnreadableError("index.csv: cannot be read: Input/output error"))):
            with self.subTest(what, error=error):
                self.refused(mock.patch(what, mock.Mock(side_effect=error))(self.imported), f"; the set in {self.to} is as it was")

    def test_of_a_set_that_is_written_by_hand(self):
        """The shape that cannot be written comes after one that can."""
        shapes = list(salbench.Dataset("hdf5", self.to))
        self.to = self.root.parent / "own"
        write(self.to, shapes)
        self.before = self.files()

        def all_but_the_last():
            yield from (dataclasses.replace(shape, points=2 * shape.points) for shape in shapes[:2])
            raise StorageError("the disk is full")

        self.refused(lambda: write(self.to, all_but_the_last()), "the disk is full")

    def test_status_of_the_command(self):
        full = self.root.parent / "full"
        full.mkdir()
        rows = [("a limit on the size of files", self.to, {"before": lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))}, "File too large")]
        if os.geteuid() == 0 and subprocess.run(["mount", "-t", "tmpfs", "-o", "size=4k", "tmpfs", full], capture_output=True).returncode == 0:
            self.addCleanup(subprocess.run, ["umount", "-l", full])
            rows.append(("a full disk", full, {}, "No space left on device"))
        for name, to, how, said in rows:
            with self.subTest(name):
                done = forked.salbench("import", self.mine, "--data", self.root, "--to", to, "--quiet", **how)
                self.assertEqual((done.returncode, done.stderr.count("\n"), done.stdout), (3, 1, ""), done.stderr)
                self.assertIn(said, done.stderr)
                self.assertEqual(self.files(), self.before)
        done = self.imported()
        self.assertEqual(({shape.name: shape.outcome for shape in done.shapes}, done.removed), ({"cat": "unchanged", "cow": "written", "dog": "unchanged"}, 1))
