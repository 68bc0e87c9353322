# SPDX-License-Identifier: GPL-3.0-or-later
"""Whatever ends a run, the next one goes on from there and comes to the same results. A few kills by default; 200 with SALBENCH_FAULTS=all
(scripts/check faults)."""

import json
import os
import random
import shlex
import shutil
import signal
import time

import native
from support import MESHES, SCANS, VIEWS, Workspace
from tests.support import toy_data
from tests.support.cache_files import count_artefacts, damage
from tests.support.processes import processes_with

OWN = """from salbench.datasets import Item, match, mesh

def items(root):
    return [Item(one.item, [one.path], truth=False) for one in match(root, "Meshes/{item}.off")]

def read(item):
    return mesh(item.files[0])
"""
# Processes that get out of the hands of a command, and resist.
STRAYS = """trap '' HUP INT TERM
[ -e '{quick}' ] && exit
'{mark}' 1000 &
timeout 1000 '{mark}' 1000 &
('{mark}' 1000 > /dev/null 2>&1 &)
echo started >> '{started}'
wait
"""


class Interruption(Workspace):
    CONFIG = SCANS

    def setUp(self):
        super().setUp()
        native.without_symmetry(self.data)

    def state(self):
        return self.results(), (self.out / "summary.csv").read_bytes(), native.contents(self.cache), native.left_over(self.cache, self.out)

    def started_and_reached(self, n_artefacts, longer=0., words=("run",)):
        """A call that has stored so many; None where it ended before."""
        process = self.started(*words)
        if not native.soon(lambda: count_artefacts(self.cache) >= n_artefacts, process):
            return None
        time.sleep(longer)
        return process

    def test_killed_at_any_moment_the_next_run_comes_to_the_same_bytes(self):
        self.salbench("run")
        whole = self.state()
        beside_second = len(native.before_reference(whole[2], "1"))
        draw, killed = random.Random(2016), 0
        held_up = 100 if os.environ.get("SALBENCH_FAULTS") == "all" else 3  # no quicker than the kill
        for trial in range(2 * held_up):
            self.forget()
            n_artefacts = draw.randrange(2) * beside_second
            longer = draw.uniform(0, .004 if n_artefacts else .4)
            holder = self.holding("2") if trial < held_up else None
            with self.subTest(n_artefacts=n_artefacts, longer=longer):
                process = self.started_and_reached(n_artefacts, longer)
                if process:
                    process.kill()
                    killed += native.ended(process).returncode == -signal.SIGKILL
                if holder:
                    self.end(holder)
                again = self.salbench("run")
                self.assertEqual(self.state(), whole)
                self.assertNotIn(str(self.cache), again.stderr, "a complaint about an artefact")
        self.assertGreaterEqual(killed, held_up)

    def test_killed_a_run_of_a_record_goes_on_by_the_same_line(self):
        """The record stands in the folder that the run writes to."""
        self.configure("dataset: {scans: false}\nseed: 7\nmodels: {RS: , MINE: {model: PS}}\n")
        self.salbench("run", "--items", "2")
        results = self.results()
        line = [native.PROGRAM, "run", self.out / "run.yaml", "--quiet"]
        for moment in ("2 after", "4 after"):
            shutil.rmtree(self.cache)
            self.assertEqual(native.called(line, **native.at_rename(moment, signal.SIGKILL)).returncode, -signal.SIGKILL)
            self.assertTrue((self.out / "run.yaml").read_text().startswith("# a run is under way, or was ended"))
            done = native.called(line)
            self.assertEqual((done.returncode, self.results()), (0, results), done.stderr)

    def test_before_the_first_score_none_of_an_earlier_run_is_left(self):
        self.configure(MESHES)
        self.salbench("run")
        shutil.rmtree(self.cache)
        self.holding("2")
        process = self.started_and_reached(2)
        process.send_signal(signal.SIGINT)
        self.assertEqual(native.ended(process).returncode, 130)
        self.assertIn("results: partial, 0 of 2 shapes", (self.out / "run.yaml").read_text())
        self.assertFalse((self.out / "results.csv").exists() or (self.out / "conclusions.json").exists())

    def test_a_signal_ends_the_run_in_order_and_the_line_printed_resumes_it(self):
        self.salbench("run")
        whole = self.state()
        for number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(number):
                self.forget()
                holder = self.holding("2")
                process = self.started_and_reached(20)
                process.send_signal(number)
                done = native.ended(process)
                self.end(holder)
                self.assertEqual((done.returncode, (self.out / "results.csv").exists()), (130, False))
                (line,) = [line for line in done.stderr.splitlines() if " run " in line]
                self.said(*shlex.split(line)[1:])
                self.assertEqual(self.state(), whole)

    def test_half_way_there_are_final_scores_of_the_items_that_were_finished(self):
        shutil.rmtree(self.data)
        toy_data.study(self.data, range(1, 6))
        native.without_symmetry(self.data)
        self.salbench("run")
        complete = self.rows()
        self.assertIn("\nlast run: finished\n", self.salbench("plan").stdout)
        self.forget()
        stored = 1 + 5 + 2 + 2  # the cache's tag, what references are made of, these, two meshes
        done = native.ended(self.started("run", **native.at_rename(f"{stored} after", signal.SIGTERM)))
        self.assertEqual(done.returncode, 130, done.stderr)
        partial = self.rows()
        for row in partial:
            self.assertTrue(row.pop("remarks").startswith("PARTIAL: "))
            self.assertIn(row, complete)
        self.assertGreater(len(partial), 0)
        plan = self.salbench("plan").stdout
        self.assertRegex(plan, rf"last run: partial, (\d+) of {5 * (1 + VIEWS)} shapes have all scores\n")
        self.assertGreaterEqual(int(plan.partition("last run: partial, ")[2].split()[0]), 1 + VIEWS)
        self.salbench("run")
        self.assertEqual(self.rows(), complete)

    def test_killed_amid_imports_no_process_is_left(self):
        """A data set whose files processes of their own read."""
        own = self.write("own.py", OWN)
        self.configure(f"dataset: {{scans: false, layout: '{own}', participants: simulated}}\nmodels: {{PS: , RS: }}\n")
        self.salbench("run")
        whole = self.state()
        self.forget()
        mark = f"SALBENCH_TEST_MARK={own}"  # seen in the environment of its processes
        killed = native.ended(self.started("run", SALBENCH_TEST_MARK=str(own), **native.at_rename("3 after", signal.SIGKILL)))
        self.assertEqual(killed.returncode, -signal.SIGKILL, killed.stderr)
        self.assertTrue(native.soon(lambda: not processes_with(mark, "environ")))
        self.salbench("run")
        self.assertLess(self.computed(), len(whole[2]))
        self.assertEqual(self.state(), whole)

    def test_killed_or_interrupted_an_export_has_no_name(self):
        self.salbench("run")
        exports = self.folder / "exports"
        exports.mkdir()
        words = ("export", "--to", exports / "toy.h5")
        # All is in the cache: the first rename is that of the export.
        killed = native.ended(self.started(*words, **native.at_rename("1 before", signal.SIGKILL)))
        self.assertEqual((killed.returncode, [file.suffix for file in exports.iterdir()]), (-signal.SIGKILL, [".salbench-part"]))
        next(exports.iterdir()).unlink()
        # Interrupted where another process has claimed what it is to compute again.
        damage(self.cache, "scan", "2_5")
        self.holding("2", "export", "4 before")
        process = self.started(*words)
        self.assertTrue(self.tries_to_claim(process, 2))
        process.send_signal(signal.SIGINT)
        done = native.ended(process)
        self.assertEqual((done.returncode, done.stderr.count(" export "), [*exports.iterdir()]), (130, 1, []), done.stderr)

    def test_commands_end_with_the_program_and_the_next_run_goes_on(self):
        """One that is kept at work, and those of one per shape, in whatever group they are. No scratch folder is left either."""
        mark, said, quick, scratch = (self.folder / name for name in ("mark", "started", "quick", "scratch"))
        shutil.copy("/bin/sleep", mark)  # a program, so that its processes can be told from others
        scratch.mkdir()
        strays = self.write("strays.sh", STRAYS.format(mark=mark, quick=quick, started=said))
        count = "n=$(grep -a -m1 'element vertex' {mesh} | cut -d' ' -f3); seq $n > {out}"
        listed = f"/usr/bin/python3 '{toy_data.ROOT}/docs/own_model.py' {{list.h5}}"
        models = {"EACH": {"command": f"sh '{strays}'; {count}", "at_once": 1}, "LIST": {"command": f"sh '{strays}'; {listed}", "gpu": 1}}
        self.configure(f"dataset: {{scans: false}}\nmodels: {json.dumps(models)}\n")
        for number, status in ((signal.SIGTERM, 130), (signal.SIGKILL, -signal.SIGKILL)):
            with self.subTest(number):
                self.forget()
                for file in (said, quick):
                    file.unlink(missing_ok=True)
                process = self.started("run", TMPDIR=str(scratch))
                self.assertTrue(native.soon(lambda: said.exists() and said.read_text().count("started") == 2, process))
                self.assertTrue(any(scratch.iterdir()))
                process.send_signal(number)
                self.assertEqual(native.ended(process).returncode, status)
                if status == 130:
                    self.assertEqual(processes_with(mark), [], "they end before the program does")
                self.assertTrue(native.soon(lambda: not processes_with(mark) and not any(scratch.iterdir())))
                quick.touch()
                done = native.ended(self.started("run", TMPDIR=str(scratch)))
                self.assertEqual((done.returncode, [*scratch.iterdir()]), (0, []), done.stderr)
