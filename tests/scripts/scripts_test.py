# SPDX-License-Identifier: GPL-3.0-or-later
"""Every file of scripts/ is run by a test or a check, and is mentioned where people look."""

import os
import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCRIPTS = ROOT / "scripts"
FILES = sorted(path for path in SCRIPTS.rglob("*") if path.is_file() and "__pycache__" not in path.parts)


def name_of(path):
    return str(path.relative_to(SCRIPTS))


def language_of(path):
    head = path.read_text(encoding="utf-8").splitlines()[0]
    if "python" in head or path.suffix == ".py":
        return "python"
    return "bash" if "bash" in head or path.suffix == ".sh" else ""


def checks():
    """Requirements of each check of scripts/check, by name."""
    text = subprocess.run([SCRIPTS / "check", "--list"], check=True, capture_output=True, text=True).stdout
    return {name: needs for name, *needs in map(str.split, text.splitlines())}


def without_comments(path):
    return re.sub(r"(?m)^\s*(#|//).*$", "", path.read_text(encoding="utf-8", errors="replace"))


class ScriptsTest(unittest.TestCase):
    def test_each_is_run_by_a_test_or_a_check_or_by_a_script_that_is(self):
        tests = [path for path in ROOT.glob("tests/**/*") if path.name == "CMakeLists.txt" or path.suffix == ".py"]
        runs = "\n".join(map(without_comments, [ROOT / ".ci/run", SCRIPTS / "check", *tests]))
        waiting = {path: re.compile(rf"\b{re.escape(path.stem if path.parent.name == 'studies' else path.name)}\b")
                   for path in FILES if path != SCRIPTS / "check"}
        while found := [path for path, name in waiting.items() if name.search(runs)]:
            runs += "\n".join(map(without_comments, found))
            for path in found:
                del waiting[path]
        self.assertEqual([name_of(path) for path in waiting], [])

    def test_each_check_is_a_command_or_a_function_and_needs_what_is_known(self):
        text = (SCRIPTS / "check").read_text()
        without_command = re.findall(r"(?m)^(\w+) [^|\n]*\| *$", text.split("checks='")[1].split("\n'")[0])
        self.assertEqual(sorted(without_command), sorted(re.findall(r"^check_(\w+)\(\)", text, flags=re.M)))
        for need in {need for needs in checks().values() for need in needs} - {"root", "data", "network", "git", "once"}:
            self.assertNotEqual(subprocess.run([SCRIPTS / "setup", "--list", need], capture_output=True).stdout, b"", need)

    @unittest.skipUnless(shutil.which("clang-format-14"), "other versions of clang-format than Debian 12's break lines elsewhere")
    def test_clang_format_would_change_nothing(self):
        files = [path for folder in ("stages", "io", "cache", "pipeline", "python", "tests") for end in ("*.cpp", "*.h")
                 for path in sorted((ROOT / folder).rglob(end))]
        self.assertGreater(len(files), 500)
        done = subprocess.run(["clang-format-14", "--dry-run", "-Werror", *files], capture_output=True, text=True, cwd=ROOT)
        self.assertEqual((done.stderr[-2000:], done.returncode), ("", 0))

    @unittest.skipUnless(shutil.which("black"), "black is not installed")
    def test_black_would_change_nothing(self):
        version = subprocess.run(["black", "--version"], capture_output=True, text=True).stdout
        if "black, 23.1." not in version:
            self.skipTest("other versions of black than Debian 12's break lines elsewhere")
        files = [*(ROOT / "python").rglob("*.py"), *(path for path in FILES if language_of(path) == "python")]
        self.assertGreater(len(files), 150)
        done = subprocess.run(["black", "--check", "--quiet", "--diff", *files], capture_output=True, text=True, cwd=ROOT)
        self.assertEqual((done.stdout[-2000:], done.returncode), ("", 0))

    @unittest.skipUnless(shutil.which("shellcheck"), "shellcheck is not installed")
    def test_shellcheck_has_no_warning(self):
        scripts = [path for path in FILES if language_of(path) == "bash"] + [ROOT / ".ci/run", *ROOT.glob("tests/*.sh")]
        done = subprocess.run(["shellcheck", "--severity=warning", *scripts], capture_output=True, text=True, cwd=ROOT)
        self.assertEqual(done.stdout, "")

    def test_programs_and_only_they_are_executable(self):
        for path in FILES:
            program = path.read_text(encoding="utf-8").startswith("#!")
            self.assertEqual(os.access(path, os.X_OK), program, name_of(path))

    def test_help_is_printed_and_nothing_done(self):
        for path in FILES:
            text = path.read_text(encoding="utf-8")
            if path.suffix or not ("argparse" in text or "--help)" in text):
                continue
            with self.subTest(name_of(path)):
                interpreter = ["/usr/bin/python3", "-B"] if language_of(path) == "python" else []
                done = subprocess.run([*interpreter, path, "--help"], capture_output=True, text=True)
                self.assertEqual((done.returncode, done.stderr), (0, ""))
                self.assertIn(f"scripts/{name_of(path)}", done.stdout)

    def test_each_says_in_its_first_lines_who_runs_it_and_when(self):
        for path in FILES:
            head = "\n".join(path.read_text(encoding="utf-8").splitlines()[:4])
            self.assertRegex(head, r"(?m)^(#|//) (Run|Read|Sourced|Imported|Included) (by|before) ", name_of(path))

    def test_each_program_is_mentioned_where_people_look(self):
        documents = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "README.md", ROOT / "CONTRIBUTING.md", *ROOT.glob("docs/*.md")))
        names = {name_of(path) for path in FILES if os.access(path, os.X_OK)}
        self.assertEqual([name for name in sorted(names) if not re.search(rf"scripts/{re.escape(name)}\b", documents)], [])


class CheckTest(unittest.TestCase):
    def check(self, *arguments):
        return subprocess.run([SCRIPTS / "check", *arguments], capture_output=True, text=True)

    def test_an_unknown_name_is_refused_before_anything_runs(self):
        done = self.check("faults", "nonsense")
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn("no check 'nonsense'", done.stderr)

    def test_says_of_each_whether_it_passed_failed_or_was_skipped(self):
        """Over scripts that stand in for those that take long."""
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        scripts = folder / "scripts"
        scripts.mkdir()
        for name in ("check", "common.sh"):
            shutil.copy(SCRIPTS / name, scripts)
        for name, text in {"setup": "[[ $1 != fuzz ]]", "build": "echo well", "scale": "echo first; echo 'the end'; exit 3"}.items():
            (scripts / name).write_text(f"#!/usr/bin/env bash\n{text}\n")
            (scripts / name).chmod(0o755)
        environment = {name: value for name, value in os.environ.items() if name != "SALBENCH_DATA"}

        def checked(*names):
            return subprocess.run([scripts / "check", *names], capture_output=True, text=True, env=environment)
        done = checked("odr", "scale", "fidelity", "fuzz")
        self.assertEqual((done.returncode, done.stderr), (1, ""))
        self.assertEqual([re.sub(" +", " ", re.sub(r" \d+ s\b", " N s", line)) for line in done.stdout.splitlines()], [
            "passed odr N s well", "failed scale N s exit status 3, build/check/scale.log: the end",
            "skipped fidelity - needs real data: SALBENCH_DATA",
            "skipped fuzz - needs packages that cannot be installed: scripts/setup fuzz", "1 passed, 1 failed, 2 skipped in N s"])
        self.assertEqual((folder / "build/check/scale.log").read_text(), "well\nfirst\nthe end\n")
        self.assertEqual(checked("odr", "fuzz").returncode, 0)
