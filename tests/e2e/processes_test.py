# SPDX-License-Identifier: GPL-3.0-or-later
"""Several processes over one cache: they share the work, and what comes of it is what one process makes."""

import os
import shutil
import signal

import native
from support import SCANS, VIEWS, Workspace
from tests.support import toy_data
from tests.support.cache_files import count_artefacts

MESHES = 3


class Processes(Workspace):
    CONFIG = SCANS

    def setUp(self):
        super().setUp()
        native.without_symmetry(self.data)

    def three_meshes(self):
        shutil.rmtree(self.data)
        toy_data.study(self.data, range(1, MESHES + 1))
        native.without_symmetry(self.data)

    def tables(self, out=None):
        return [((out or self.out) / name).read_bytes() for name in ("results.csv", "summary.csv")]

    def test_four_at_once_do_the_work_of_one_and_come_to_the_same_bytes(self):
        self.three_meshes()
        self.salbench("run")
        tables, whole = self.tables(), native.contents(self.cache)
        self.forget()
        outs = [self.folder / f"out{number}" for number in range(4)]
        processes = [self.started("run", "--threads", "1", "--out", out) for out in outs]
        for process, out in zip(processes, outs):
            done = native.ended(process)
            self.assertEqual((done.returncode, self.tables(out)), (0, tables), done.stderr)
        self.assertEqual(native.contents(self.cache), whole)
        self.assertEqual(sum(native.computed(out / "run.yaml") for out in outs), len(whole), "some artefact was computed twice")
        self.assertEqual(native.left_over(self.cache, outs[0]), [])

    def test_what_another_one_has_claimed_is_left_until_it_gives_it_up(self):
        self.salbench("run")
        of_second = native.before_reference(native.contents(self.cache), "2")
        self.forget()
        holder = self.holding("1")
        run = self.started("run")
        self.assertTrue(native.soon(lambda: count_artefacts(self.cache) >= len(of_second), run))
        self.assertTrue(self.tries_to_claim(run, 2), "with nothing else to do, it must ask for the first mesh")
        self.assertEqual(native.contents(self.cache), of_second, "of the second mesh, before matching")
        interrupted = self.started("run", "--out", self.folder / "out1")
        self.assertTrue(self.tries_to_claim(interrupted, 5), "it must be waiting, too")
        interrupted.send_signal(signal.SIGINT)
        self.assertEqual(native.ended(interrupted).returncode, 130)
        self.end(holder)
        done = native.ended(run)
        self.assertEqual((done.returncode, self.computed()), (0, len(native.contents(self.cache))), done.stderr)

    def test_a_killed_one_holds_up_no_other(self):
        self.three_meshes()
        victim = self.holding("1-3")
        survivor = self.started("run", "--threads", "1", "--out", self.folder / "out2")
        self.assertTrue(self.tries_to_claim(survivor, 3 * MESHES), "after one try for each mesh it must be waiting")
        self.end(victim)
        done = native.ended(survivor)
        self.assertEqual(done.returncode, 0, done.stderr)
        tables = self.tables(self.folder / "out2")
        self.forget()
        self.salbench("run")
        self.assertEqual(self.tables(), tables)

    def test_two_meshes_of_one_content_are_worked_on_one_after_the_other(self):
        """Families are claimed by the content of their mesh: one of the two comes in a second round of the reference, and nothing else is begun
        before."""
        for path in [*self.data.glob("*/1.*"), *self.data.glob("RawData/1_*")]:
            shutil.copy(path, path.with_name("3" + path.name[1:]))
        errors = self.salbench("run").stderr
        self.assertEqual([errors.count(f"{part}: ") for part in ("reference", "maps", "evaluation")], [1, 0, 1], errors)

    def test_shards_do_the_work_of_one_run_which_then_only_matches_and_scores(self):
        self.three_meshes()
        self.salbench("run")
        tables, whole = self.tables(), native.contents(self.cache)
        self.forget()
        computed = 0
        for number in "123":
            shard = f"{number}/3"
            self.salbench("run", "--shard", shard)
            record = self.out / f"shard_{number}_of_3.yaml"
            self.assertIn(f"shard: {shard}\n", record.read_text())
            self.assertEqual(native.computed(record), len(native.before_reference(whole, number)))
            computed += native.computed(record)
            self.assertIn("\n0 jobs to do", self.salbench("plan", "--shard", shard).stdout)
        self.assertFalse((self.out / "results.csv").exists() or (self.out / "run.yaml").exists())
        self.assertEqual((native.contents(self.cache, "matched"), len(native.contents(self.cache))), (set(), computed))
        self.salbench("run")
        self.assertEqual(self.computed() + computed, len(whole))
        self.assertEqual((self.tables(), native.contents(self.cache)), (tables, whole))

    def test_shards_with_a_given_reference_leave_nothing_but_the_tables_to_do(self):
        reference = self.write("reference.csv", "GS\n" + "1\n" * 100)
        for shard in ("1/2", "2/2"):
            self.salbench("run", "--shard", shard, "--reference", reference)
        before = native.contents(self.cache)
        self.assertEqual(len(native.contents(self.cache, "scores")), 2 * 2 * (1 + VIEWS))
        self.salbench("run", "--reference", reference)
        further = native.contents(self.cache) - before
        self.assertEqual((self.computed(), {row[0].partition(".")[0] for row in further}), (len(further), {"mean_histogram", "score_table"}))

    def engine(self, out, *further, **environment):
        done = native.called([native.ENGINE, self.config, self.data, self.cache, self.folder / out, *further], **environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        return [(self.folder / out / name).read_bytes() for name in ("results.csv", "means.csv")]

    def test_the_engine_without_python_comes_to_the_same(self):
        """Either goes on from the cache of the other."""
        self.salbench("run")
        whole, tables = native.contents(self.cache), [(self.out / name).read_bytes() for name in ("results.csv", "means.csv")]
        self.assertEqual(self.engine("again"), tables)
        self.assertEqual(native.computed(self.folder / "again/run.yaml"), 0)
        shutil.rmtree(self.cache)
        self.assertEqual((self.engine("anew"), native.contents(self.cache)), (tables, whole))
        self.salbench("run")
        self.assertEqual(self.computed(), 0)

    def test_the_hdf5_library_is_called_by_one_thread_at_a_time_where_it_is_not_thread_safe(self):
        tables = self.engine("out", "4")
        self.forget()
        self.assertEqual(self.engine("out", "4", LD_PRELOAD=os.environ["SALBENCH_WATCH_HDF5"]), tables)
