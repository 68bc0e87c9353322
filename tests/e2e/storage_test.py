# SPDX-License-Identifier: GPL-3.0-or-later
"""Disks that are full, caches that may only be read, and files in the cache that rotted."""

import os
import subprocess
import time
from pathlib import Path

import native
from support import SCANS, Workspace
from tests.support.cache_files import segment_with, segments

DAY = 24 * 3600
WITHOUT_OVERRIDE = ["/usr/bin/setpriv", "--bounding-set=-dac_override", "--inh-caps=-dac_override"]  # permissions do not bind root otherwise


def flip(path):
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 0x10
    path.write_bytes(content)


class Storage(Workspace):
    def disk(self, folder, size):
        """In memory, mounted for the test."""
        folder.mkdir(parents=True, exist_ok=True)
        if subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", folder], capture_output=True).returncode:
            self.skipTest("mounting is not allowed here")
        self.addCleanup(subprocess.run, ["umount", "-l", folder], check=True)

    def refused(self, done, folder, said):
        errors = [line for line in done.stderr.splitlines() if line.startswith("error: ")]
        self.assertEqual((done.returncode, len(errors)), (3, 1), done.stderr)
        self.assertIn(str(folder), errors[0])
        self.assertIn(said, errors[0])

    def verify(self, status=0):
        self.said("verify", "--cache", self.cache, status=status)

    def test_a_full_disk_ends_the_run_and_with_more_room_it_goes_on(self):
        self.configure(SCANS)
        native.without_symmetry(self.data)
        self.salbench("run")
        results, whole, exports = self.results(), native.contents(self.cache), self.folder / "exports"
        self.forget()
        self.disk(self.cache, "300k")
        self.disk(exports, "100k")
        self.refused(self.salbench("run", status=3), self.cache, os.strerror(28))
        kept = len(native.contents(self.cache))
        self.assertGreater(kept, 5)
        self.assertEqual(native.left_over(self.cache, self.out), [])
        subprocess.run(["mount", "-o", "remount,size=30m", self.cache], check=True)
        self.salbench("run")
        self.assertEqual((self.computed() + kept, native.contents(self.cache), self.results()), (len(whole), whole, results))
        self.refused(self.salbench("export", "--to", exports / "toy.h5", status=3), exports, os.strerror(28))
        self.assertEqual([*exports.iterdir()], [])

    def test_a_full_disk_has_room_for_gc_if_one_shape_fits(self):
        disk = self.folder / "disk"
        self.disk(disk, "30m")
        self.cache = disk / "cache"
        self.salbench("run")
        both = sum(path.stat().st_size for path in segments(self.cache))
        state = os.statvfs(disk)
        (disk / "fill").write_bytes(bytes(state.f_bavail * state.f_frsize - both * 2 // 3))
        self.salbench("gc", "--stage", "map.PS")
        self.assertEqual({row[0] for row in native.contents(self.cache, "map")}, {"map.RS"})

    def made_read_only(self):
        """A complete cache, pictures included, whose permissions the program has not."""
        self.salbench("export", "--to", self.folder / "all.h5", "--pictures")
        self.salbench("run")

        def change(work):
            for path in (self.cache, *self.cache.rglob("*")):
                path.chmod(work(path.stat().st_mode, 0o200))
        change(lambda mode, write: mode & ~write)
        self.addCleanup(change, int.__or__)

    def bound(self, *words):
        """A call that permissions bind."""
        return native.called([*(WITHOUT_OVERRIDE if os.geteuid() == 0 else []), native.PROGRAM, *self.line(*words)])

    def test_a_cache_that_is_complete_need_not_be_written_to(self):
        self.made_read_only()
        before = native.contents(self.cache), self.results()
        for words in (("run",), ("export", "--format", "maps", "--to", self.folder / "maps"),
                      ("export", "--to", self.folder / "all.h5", "--pictures"), ("plan",)):
            with self.subTest(words[0]):
                done = self.bound(*words)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertNotIn(str(self.cache), done.stderr)
        self.verify()
        self.assertEqual((self.computed(), (native.contents(self.cache), self.results())), (0, before))

    def test_one_that_something_is_to_be_added_to_is_named_before_the_work_begins(self):
        self.made_read_only()
        results = self.results()
        self.configure("dataset: {scans: false}\nmodels: {PS: , RS: , CS: }\n")
        for words in (("run",), ("run", "--shard", "1/2"), ("export", "--to", self.folder / "all.h5")):
            self.refused(self.bound(*words), self.cache, "cannot be written to")
        self.assertEqual(self.results(), results)
        self.assertIn("last run: finished", self.salbench("plan").stdout, "the results of the run before")
        damaged = segment_with(self.cache, "map.PS", "1")
        damaged.chmod(0o600)
        os.truncate(damaged, 100)
        plan = self.bound("plan")
        self.assertEqual((plan.returncode, plan.stderr.count(str(damaged))), (0, 1), plan.stderr)
        self.refused(self.bound("run"), self.cache, "cannot be written to")

    def test_flipped_bytes_are_found_by_a_run_which_computes_again_what_has_them(self):
        """One byte in the middle of each segment. Every byte: tests/cache/segment_test.cpp."""
        self.salbench("run")
        before, paths = (self.results(), native.contents(self.cache)), segments(self.cache)
        for path in paths:
            flip(path)
        self.verify(status=1)
        said = self.salbench("run").stderr
        for path in paths:
            (line,) = [line for line in said.splitlines() if str(path) in line]
            self.assertRegex(line, r"warning: .*renamed to \*\.damaged")
        self.assertEqual((self.computed(), (self.results(), native.contents(self.cache))), (len(before[1]), before))
        self.verify()
        self.assertNotIn(str(self.cache), self.salbench("run").stderr, "warned again")
        self.assertEqual(self.computed(), 0)
        self.assertIn(f" {len(paths)} damaged files", self.salbench("gc").stdout)
        self.assertEqual([*self.cache.rglob("*.damaged")], [])

    def test_the_times_of_files_never_matter(self):
        self.salbench("run")
        results, now = self.results(), time.time()
        for years in (50, -50):
            for paths, sign in ((segments(self.cache), 1), (filter(Path.is_file, self.data.rglob("*")), -1)):
                for path in paths:
                    os.utime(path, (now + sign * years * 365 * DAY,) * 2)
            self.salbench("run")
            self.assertEqual((self.computed(), self.results()), (0, results))
