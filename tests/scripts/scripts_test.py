# SPDX-License-Identifier: GPL-3.0-or-later
"""Every file of scripts/ can be read by its interpreter, is run by scripts/test or by scripts/check, and is mentioned where people look."""

import ast
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
OTHER = ("mutant.h", "packages")  # neither bash nor Python


def name_of(path):
    return str(path.relative_to(SCRIPTS))


def language_of(path):
    head = path.read_text(encoding="utf-8").splitlines()[0]
    if "python" in head or path.suffix == ".py":
        return "python"
    return "bash" if "bash" in head or path.suffix == ".sh" else ""


def listed():
    """Rows of scripts/check --list: name, files, needs; or "-", file, and the file that has it run by scripts/test."""
    text = subprocess.run([SCRIPTS / "check", "--list"], check=True, capture_output=True, text=True).stdout
    return [line.split("|") for line in text.splitlines()]


class ScriptsTest(unittest.TestCase):
    def test_each_is_run_by_scripts_test_or_by_scripts_check(self):
        checked = {file for name, files, _ in listed() if name != "-" for file in files.split()}
        tested = {file: where for name, file, where in listed() if name == "-"}
        self.assertEqual(sorted(checked | set(tested)), [name_of(path) for path in FILES])
        for file, where in tested.items():
            module = Path(where).stem
            if module.endswith("_test"):
                self.assertRegex((ROOT / where).with_name("CMakeLists.txt").read_text(encoding="utf-8"), rf"\b{module}\b")
            self.assertRegex((ROOT / where).read_text(encoding="utf-8"), rf"\b{re.escape(Path(file).name)}\b", f"{where} does not run {file}")

    def test_each_check_is_a_function_and_needs_what_is_known(self):
        text = (SCRIPTS / "check").read_text()
        names = [name for name, _, _ in listed() if name != "-"]
        self.assertEqual(sorted(names), sorted(re.findall(r"^check_(\w+)\(\)", text, flags=re.M)))
        purposes = re.findall(r"^\[(\w+)\]", (SCRIPTS / "packages").read_text(), flags=re.M)
        needs = {need for name, _, needs in listed() if name != "-" for need in needs.split()}
        self.assertLessEqual(needs, {"root", "data", "network", *purposes})

    def test_each_is_syntax_of_its_language(self):
        for path in FILES:
            with self.subTest(name_of(path)):
                language = language_of(path)
                if language == "bash":
                    done = subprocess.run(["bash", "-n", path], capture_output=True, text=True)
                    self.assertEqual((done.returncode, done.stderr), (0, ""))
                elif language == "python":
                    ast.parse(path.read_text(encoding="utf-8"))
                else:
                    self.assertIn(name_of(path), OTHER)

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
        others = {"slurm/task", "slurm/toy_meshes.py"}  # run by scripts/slurm/submit and by tests
        names = {name_of(path) for path in FILES if os.access(path, os.X_OK)} - others
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
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        scripts = Path(holder.name) / "scripts"
        scripts.mkdir()
        for name in ("check", "real_data.sh"):
            shutil.copy(SCRIPTS / name, scripts)
        for name, text in {"setup": "[[ $1 != fuzz ]]", "faults": "echo well", "mutate": "echo first; echo 'the end'; exit 3"}.items():
            (scripts / name).write_text(f"#!/usr/bin/env bash\n{text}\n")
            (scripts / name).chmod(0o755)
        environment = {name: value for name, value in os.environ.items() if name != "SALBENCH_DATA"}

        def checked(*names):
            return subprocess.run([scripts / "check", *names], capture_output=True, text=True, env=environment)
        done = checked("faults", "mutate", "fidelity", "fuzz")
        self.assertEqual((done.returncode, done.stderr), (1, ""))
        self.assertEqual([re.sub(" +", " ", re.sub(r" \d+ s\b", " N s", line)) for line in done.stdout.splitlines()], [
            "passed faults N s", "failed mutate N s exit status 3, build/check/mutate.log: the end",
            "skipped fidelity - needs real data: SALBENCH_DATA",
            "skipped fuzz - needs packages that cannot be installed: scripts/setup fuzz", "1 passed, 1 failed, 2 skipped in N s"])
        self.assertEqual((Path(holder.name) / "build/check/mutate.log").read_text(), "first\nthe end\n")
        self.assertEqual(checked("faults", "fuzz").returncode, 0)

    def test_without_a_name_it_says_how_it_is_used(self):
        done = self.check()
        self.assertEqual(done.returncode, 2)
        self.assertIn("scripts/check --all", done.stdout)


if __name__ == "__main__":
    unittest.main()
