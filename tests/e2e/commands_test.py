# SPDX-License-Identifier: GPL-3.0-or-later
"""Models that are commands, from a configuration to their scores: one per shape, one for a list of shapes, and those that fail. What is asked of
a command by itself: tests/python/command_test.py and maps_test.py."""

import json
import os
import shutil
from pathlib import Path

import numpy as np
from support import POINTS, SCANS, VIEWS, Workspace
from tests.support import toy_data
from tests.support.cache_files import damage
from tests.support.processes import processes_with

ROOT = Path(__file__).resolve().parents[2]
OWN_MODEL = f"/usr/bin/python3 '{ROOT}/docs/own_model.py'"
PS_MODEL = f"/usr/bin/python3 '{ROOT}/tests/e2e/ps_model.py'"
COUNT = f"seq {POINTS} > {{out}}; test {{mesh}}"


def models(**options):
    """Configuration of a run over meshes; each model is a command, or the options of one."""
    given = {name: {"command": of} if isinstance(of, str) else of for name, of in options.items()}
    return f"dataset: {{scans: false}}\nmodels: {json.dumps({'PS': None, **given})}\n"
ONE = ("--items", "1", "--reference", "items")


class Commands(Workspace):
    def counted(self, command=COUNT):
        return f"echo run >> '{self.folder}/log'; {command}"

    def runs(self):
        log = self.folder / "log"
        return log.read_text().count("run") if log.exists() else 0

    def maps(self, model):
        return {path.name: path.read_bytes() for path in (self.folder / "maps" / model).iterdir()}

    def export_maps(self, *words):
        self.salbench("export", *words, "--format", "maps", "--to", self.folder / "maps")

    def test_a_model_in_python_is_level_with_the_built_in_one(self):
        self.configure(SCANS.partition("models")[0] + f'models: {{PS: , MINE: {{command: "{PS_MODEL} {{shape}} {{out}}", reads: [fpfh]}}}}\n')
        self.salbench("run", *ONE)
        built_in, own = (self.scores(model, "auc", "nss", "cc", "lcc") for model in ("PS", "MINE"))
        self.assertEqual(len(own), 1 + VIEWS)
        for one, other in zip(built_in, own):
            self.assertEqual(one[:3], other[:3])
            np.testing.assert_allclose(np.array(one[3:], float), np.array(other[3:], float), atol=1e-4)
        self.export_maps(*ONE)
        mine = self.maps("MINE")
        for name, text in self.maps("PS").items():
            np.testing.assert_allclose(np.array(text.split(), float), np.array(mine[name].split(), float), atol=1e-6)

    def test_one_with_a_list_gives_the_same_maps_and_is_started_once(self):
        """Commands started per shape never exceed their limit of simultaneous processes."""
        busy = f"'{self.folder}/busy'"
        each = f"mkdir {busy} || exit 9; printf '%s\\\\t%s\\\\n' {{shape}} {{out}} | {OWN_MODEL} /dev/stdin; rmdir {busy}"
        once = self.counted(f"{OWN_MODEL} {{list.h5}}; echo end >> '{self.folder}/log'")
        self.configure(SCANS.partition("models")[0] + f'models: {{EACH: {{command: "{each}", at_once: 1}}, ONCE: {{command: "{once}", gpu: 1}}}}\n')
        self.salbench("run", *ONE, "--threads", "4")
        self.assertEqual((self.folder / "log").read_text(), "run\nend\n", "it ends with the run")
        self.export_maps(*ONE)
        self.assertEqual(len(self.maps("ONCE")), 1 + VIEWS)
        self.assertEqual(self.maps("ONCE"), self.maps("EACH"))
        self.assertEqual(self.runs(), 1)

    def test_what_it_depends_on_is_in_its_folder_and_another_runs_it_again_alone(self):
        self.write("weights.txt", "1")
        reading = self.counted(f"first=$(cat weights.txt) && seq $first $((first + {POINTS - 1})) > {{out}} && test {{mesh}}")
        self.write("other.txt")
        self.configure(models(MINE={"command": reading, "depends": ["other.txt"]}))
        self.assertIn("weights.txt is not in the command's folder", "".join(self.fails()))
        (self.folder / "log").unlink()
        trained = {"command": reading, "depends": ["weights.txt", "./weights.txt"], "trained_on": ["1", "elsewhere"]}
        self.configure(models(MINE=trained))
        self.assertIn('trained_on: ["1", "elsewhere"]', self.said("config", self.config).stdout)
        said = "MINE was trained on shapes that it is scored on here (1; 2 scored)"
        self.assertIn(said, self.salbench("run").stderr)
        self.assertIn(said, self.rows()[0]["remarks"])
        self.assertEqual(self.runs(), 2)
        for how in ("once", "on ten folds"):
            self.configure(models(MINE={"trained": how, **{key: trained[key] for key in ("command", "depends")}}))
            self.assertIn(f"\nMINE: {how}\n", self.salbench("run").stdout)
        self.assertEqual((self.runs(), self.computed(), "remarks" in self.rows()[0]), (2, 0, False), "what it was trained on is in no key")
        self.write("weights.txt", "2")
        self.assertRegex(self.salbench("plan", "1", "map.MINE").stdout, r"\n  - .*weights.txt.*\n  \+ .*weights.txt")
        self.salbench("run")
        self.assertEqual(self.runs(), 4)
        self.assertEqual(self.computed(), 4, "map and matched map of each mesh: scores and table as before")
        (self.folder / "weights.txt").unlink()
        self.assertRegex(self.fails(status=2)[0], "models.MINE.depends .*weights.txt")

    def test_a_new_name_computes_no_map_again_and_moves_no_score(self):
        own = self.counted(f"seq {POINTS} | sed s/$/.$(cksum < {{mesh}} | cut -c1-4)/ > {{out}}")  # each mesh has its own
        self.configure(models(MINE=own))
        self.salbench("run")
        results = self.results()
        self.configure(models(YOURS=own))
        self.salbench("run")
        self.assertEqual((self.runs(), self.results()), (2, results.replace(b"MINE", b"YOURS")))
        self.salbench("gc")
        self.salbench("run")
        self.assertEqual(self.computed(), 0, "gc keeps what is found under another name")
        self.configure(models(MINE="false {mesh} {out}", AS_IT_WAS=own))
        self.fails()
        self.assertEqual(self.runs(), 2, "an earlier version under a name of its own, beside one that fails")
        self.forget()
        self.configure(models(ONE=own, OTHER=own))
        self.salbench("run")
        self.assertEqual(self.runs(), 2 + 4, "of one run none is found under the name of another")

    def test_one_that_gives_another_map_each_time_is_told_so_where_one_was_damaged(self):
        drawing = f"awk -v s=$(date +%N) 'BEGIN {{srand(s); for (; n < {POINTS}; ++n) print rand()}}' > {{out}}; test {{mesh}}"
        self.configure(models(MINE=drawing))
        self.salbench("run")
        self.salbench("gc", "--stage", "matched.MINE")
        damaged, check = damage(self.cache, "map.MINE", "1"), self.cache / "checked"
        while check.stat().st_ctime_ns <= damaged.stat().st_ctime_ns:
            os.utime(check)  # as a disk may do it: a later check vouches for the segment, and who reads the map is the first to see
        (said,) = self.fails()
        self.assertIn("map.MINE was damaged, and the model gives another map each time", said)
        self.salbench("run")
        self.salbench("run")
        self.assertEqual(self.computed(), 0)

    def test_one_that_fails_costs_its_shape_alone(self):
        mark = self.folder / "mark"
        shutil.copy("/bin/sleep", mark)
        hanging = f"echo loading; trap '' TERM; '{mark}' 1000 & '{mark}' 1000"
        for name, first, said in (("hangs", hanging, "longer than its timeout of 3 s.*: loading"), ("is killed", "kill -9 $$", "killed by signal 9")):
            with self.subTest(name):
                self.configure(models(MINE={"command": f"if [ {{item}} = 1 ]; then {first}; fi; {COUNT}", "timeout": 3}))
                (error,) = self.fails()
                self.assertRegex(error, f"^error: 1: map.MINE: .*{said}")
                self.assertEqual((len(self.rows(model="MINE")), len(self.rows(model="PS"))), (1, 2))
                self.assertFalse(processes_with(mark), "nothing of it is left")

    def test_one_that_fails_alike_on_the_first_shapes_is_not_tried_on_the_others(self):
        for mesh in toy_data.meshes(self.folder / "more", 7, 16, 8).glob("[3-7].off"):
            shutil.move(mesh, self.data / "Meshes")
        self.configure(models(MINE=self.counted("echo no such weights >&2; false {mesh} {out}")))
        said = self.salbench("run", status=1).stderr
        self.assertEqual(self.runs(), 5)
        self.assertRegex(said, r"map.MINE: .*no such weights.*: failed alike on its first 5 items .*, and is not tried on the other 2; --keep-going")
        self.salbench("run", "--keep-going", status=1)
        self.assertEqual(self.runs(), 5 + 7)

    def test_what_cannot_be_meant_is_refused_before_the_run(self):
        for options, named in (({"command": "cat {mesh}"}, "command must have {out}"), ({"command": "date > {out}"}, "command must have {mesh}"),
                               ({"command": "x {mesh} {out}", "reads": ["fpfh"]}, "command must have {shape}"),
                               ({"command": "x {mesh} {out}", "reads": ["colour"]}, "reads"), ({"command": "x {mesh} {out}", "timeout": 0}, "timeout"),
                               ({"command": "x {list} {out}"}, "command has {list}"),
                               ({"command": "x {list}", "reads": ["fpfh"]}, "command must have {list.h5}"), ({"command": "x {list} {list.h5}"}, "command has both"),
                               ({"command": "x {mesh} {out}", "depends": ["./shape.ply"]}, "depends"),
                               ({"command": "/usr/bin/python3 /etc/os-release {mesh} {out}"}, "command names the file '/etc/os-release'"), ({"timeout": 1}, "")):
            with self.subTest(options):
                self.configure(models(MINE=options))
                self.assertRegex(self.said("config", self.config, status=2).stderr, rf"^error: {self.config}:2: models.MINE\W?{named}")
        self.configure(models(MINE="seq 162 > {out} # \"{mesh}\" \\'"))
        printed = self.said("config", self.config).stdout
        self.configure(printed)
        self.assertEqual(self.said("config", self.config).stdout, printed)
