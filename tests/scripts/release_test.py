# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/release, up to where it needs root: what it refuses, and the source archive."""

import os
import shutil
import subprocess
import tarfile
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


@unittest.skipUnless(shutil.which("git"), "git is not installed")
class ReleaseTest(unittest.TestCase):
    def setUp(self):
        self.root = Path(self.enterContext(tempfile.TemporaryDirectory())) / "tree"
        (self.root / "scripts").mkdir(parents=True)
        for name in ("check", "common.sh", "release"):
            shutil.copy(ROOT / "scripts" / name, self.root / "scripts")
        (self.root / "CMakeLists.txt").write_text("project(salbench VERSION 3.2.1 LANGUAGES C CXX)\n")
        (self.root / "CHANGELOG.md").write_text("## [3.2.1] - 2031-01-02\n")
        (self.root / ".gitignore").write_text("build/\n")
        self.git("init", "-q")
        self.commit("first")

    def git(self, *words):
        identity = {"GIT_AUTHOR_NAME": "a", "GIT_AUTHOR_EMAIL": "a@b.c", "GIT_COMMITTER_NAME": "a", "GIT_COMMITTER_EMAIL": "a@b.c",
                    "GIT_CONFIG_GLOBAL": "/dev/null"}
        subprocess.run(["git", *words], cwd=self.root, check=True, env=os.environ | identity)

    def commit(self, what):
        self.git("add", "-A")
        self.git("commit", "-qm", what)

    def release(self, *words):
        return subprocess.run(["scripts/release", *words], cwd=self.root, capture_output=True, text=True)

    def test_what_is_refused(self):
        self.git("tag", "v3.2.2")
        for words, what in ((["3.2"], "is no version"), (["v3.2.1"], "is no version"), (["3.2.1-rc1"], "is no version"),
                            (["3.2.1"], "there is no refs/tags/v3.2.1"), (["3.2.1", "--commit", "nothing"], "there is no nothing"),
                            (["3.2.1", "--commit", "HEAD", "--part", "11/*"], "there is no part '11/\\*'; there are: .* 12/odr .* 13/test both/results"),
                            (["3.2.2"], "has another version than 3.2.2"),
                            (["3.2.1", "--commit", "HEAD"], "has no heading '## \\[3.2.1\\] - DATE'")):
            if "heading" in what:
                (self.root / "CHANGELOG.md").write_text("## [3.2.1]\n")
                self.commit("no date")
            with self.subTest(words):
                done = self.release(*words)
                self.assertEqual(done.returncode, 2)
                self.assertRegex(done.stderr, what)
                self.assertFalse((self.root / "build").exists())

    def test_the_archive_holds_the_tree_with_the_time_of_the_commit(self):
        done = self.release("3.2.1", "--commit", "HEAD~0", "--part", "archive")
        self.assertEqual(done.returncode, 0, done.stderr)
        archive = self.root / "build/release-3.2.1/salbench-3.2.1.tar.xz"
        first = archive.read_bytes()
        with tarfile.open(archive) as tar:
            self.assertEqual(sorted(member.name for member in tar if member.isfile()),
                             [f"salbench-3.2.1/{name}" for name in
                              (".gitignore", "CHANGELOG.md", "CMakeLists.txt", "scripts/check", "scripts/common.sh", "scripts/release")])
        os.utime(self.root / "CHANGELOG.md", (1, 1))
        self.assertEqual(self.release("3.2.1", "--commit", "HEAD~0", "--part", "archive").returncode, 0)
        self.assertEqual(archive.read_bytes(), first)
