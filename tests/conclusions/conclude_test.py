# SPDX-License-Identifier: GPL-3.0-or-later
"""conclude() on folders: which files it reads and writes, what it prints, how it fails; and how a table is added.
A run finds copies by the digests of shape and ground truth."""

import contextlib
import hashlib
import io
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy as np
import pandas

from salbench import Results, __main__, conclusions
from salbench.conclusions import Table, folders, tables, words
from salbench.conclusions.folders import read_record, read_run
from salbench.conclusions.means import ranking
from salbench.conclusions.study import Study
from salbench.conclusions.tables import DATASET, framed, number
from salbench.runs import conclusions_file
from support import InAFolder, row, scores_of
from tests.support import forked
from tests.support.toy_data import study

SIMULATED = "SIMULATED participants: made up"
RUN = """results: finished
metrics:
  auc: {unit: "1", better: higher, matching: histogram}
  kl: {unit: bit, better: lower, matching: none}
scores_digest: 0123abcd
configuration:
  seed: 7
  statistics:
    unit: mesh
"""


def made_up_rows(metrics=2):
    rng = np.random.default_rng(9)
    return [row(mesh, view, model, *(m / 10 + rng.random(metrics)), category=f"class {mesh % 3}")
            for mesh in range(9) for view in ("", 0, 1) for m, model in enumerate(("A", "B", "HS", "RS"))]


class FolderTest(InAFolder):
    def write_run(self, remarks=()):
        frame = scores_of(made_up_rows(), ("auc", "kl")).frame.drop(columns="split")
        (self.folder / "results.csv").write_text(tables.csv(frame, remarks))
        (self.folder / "constant.csv").write_text(tables.csv(frame[frame["model"] == "A"].assign(model="constant", auc=.5, kl=1.0)))
        people = [(mesh, f"class {mesh % 3}", n, .5 + n / 100 + mesh / 1000, 1.0) for mesh in range(9) for n in (1, 2, 3)]
        (self.folder / "people.csv").write_text(tables.csv(pandas.DataFrame(people, columns=["item", "class", "n", "auc", "kl"])))
        (self.folder / "run.yaml").write_text(RUN)

    def call(self, *arguments):
        """Exit status, and what was printed."""
        out, errors = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(errors):
            try:
                status = __main__.main([*map(str, arguments)])
            except SystemExit as stopped:
                status = stopped.code
        return status, out.getvalue(), errors.getvalue()

    def document(self, folder=None):
        return json.loads(((folder or self.folder) / "conclusions.json").read_text())

    def files(self, folder=None):
        return {path.name: path.read_bytes() for path in (folder or self.folder).iterdir()}


class ConcludeTest(FolderTest):
    def test_a_run_has_every_table_with_its_remarks(self):
        self.write_run([SIMULATED])
        (self.folder / "smoothing.csv").write_text("of an earlier run\n")
        status, out, errors = self.call("conclude", self.folder)
        self.assertEqual((status, errors), (0, ""))
        there = {path.stem for path in self.folder.glob("*.csv")} - {"results", "constant", "people"}
        self.assertEqual(there, {table.name for table in conclusions.TABLES} - {"smoothing", "published"})
        document = self.document()
        self.assertEqual(set(document["tables"]), {f"{name}.csv" for name in there})
        self.assertEqual([document[name] for name in ("format", "of", "unit")], [1, "0123abcd", "mesh"])
        for name in document["tables"]:
            table = pandas.read_csv(self.folder / name)
            self.assertEqual(list(table)[:-1], list(conclusions.empty(name.removesuffix(".csv"))), name)
            self.assertEqual(table["remarks"].tolist(), [SIMULATED] * len(table), name)
        head, _, tail = document["text"].partition("\n\n")
        self.assertTrue(head.startswith("dataset  model  metric"))
        self.assertEqual(tail.splitlines()[0], SIMULATED)
        self.assertEqual(out, document["text"] + f"one observation per mesh; tables in {self.folder}\n")

    def test_a_run_without_ground_truth_has_a_sentence_on_it(self):
        self.write_run()
        (self.folder / "results.csv").write_text("dataset,item,class,view,model,auc,kl\n")
        status, out, errors = self.call("conclude", self.folder)
        self.assertEqual((status, out.splitlines()[1:], errors), (0, ["", words.NO_SCORES, f"tables in {self.folder}"], ""))

    def test_another_unit_is_not_what_the_program_asked_for(self):
        self.write_run()
        for unit, of in (("class", None), ("mesh", "0123abcd")):
            self.call("conclude", self.folder, "--unit", unit, "--out", self.folder / unit)
            self.assertEqual(self.document(self.folder / unit)["of"], of)

    def test_a_table_of_anybody(self):
        file = self.folder / "scores.csv"
        file.write_text("item,model,auc,depth,mine\n1,A,.5,1,2\n2,A,.6,1,3\n")
        out = self.folder / "tables"
        status, text, errors = self.call("conclude", file, "--out", out, "--higher", "mine", "--format", "json")
        self.assertEqual((status, errors), (0, f"warning: {file}: columns that are no metrics of the program were left out: depth; name them with "
                                              "--higher or --lower\n"))
        document = json.loads(text)
        self.assertEqual(list(document), ["schema", "command", "results", "unit", "scores", "leaders"])
        self.assertEqual(document["scores"][0] | {"ci95_low": "", "ci95_high": ""}, {
            "dataset": "meshes", "model": "A", "metric": "auc", "n": "2", "mean": "0.55", "ci95_low": "", "ci95_high": "", "rank": "", "group": ""})
        self.assertEqual(document["leaders"][0]["metrics"][0]["lead"], None)  # JSON knows no NaN
        self.assertEqual(self.document(out)["of"], None)
        (out / "results.csv").write_text("item,model,auc\n1,A,.5\n")
        self.assertEqual(self.call("conclude", out, "--quiet"), (0, "", ""))
        self.assertEqual(list(pandas.read_csv(out / "summary.csv")["mean"]), [.5])

    def test_what_a_table_lacks_is_said(self):
        self.write_run()
        file = self.folder / "results.csv"
        file.write_text("item,class,model,auc\n1,cup,A,.5\n2,,A,.6\n3,ant,A,.6\n")
        _, out, errors = self.call("conclude", file, "--unit", "class", "--out", self.folder / "tables")
        self.assertIn("results.csv: read as a table", errors)
        self.assertIn("\n1 of 3 items have no class", out)

    def test_a_metric_without_a_score_is_missing(self):
        for nss in (("", "", "", ""), ("", "0", "0", "0"), ("0", "0", "", "0")):
            file = self.folder / "scores.csv"
            file.write_text("item,model,cc,nss\n" + "".join(f"{item},{model},.{at + 1},{value}\n" for at, (item, model, value) in
                                                            enumerate(zip("abab", "AABB", nss))))
            self.assertEqual(self.call("conclude", file, "--out", self.folder / "tables")[0], 0, nss)

    def test_the_folder_of_a_run_takes_no_tables_of_other_scores(self):
        self.write_run()
        self.assertEqual(self.call("conclude", self.folder)[0], 0)
        before = self.files()
        run = Path(self.enterContext(tempfile.TemporaryDirectory())) / "scores"
        shutil.copytree(self.folder, run)
        table = run.with_suffix(".csv")
        table.write_text("item,model,auc\n1,A,.5\n2,A,.6\n")
        with mock.patch.object(folders, "DEFAULT", run.parent):
            for arguments in ((table,), (table, "--out", self.folder), (run, "--out", self.folder)):
                status, _, errors = self.call("conclude", *arguments)
                self.assertEqual((status, errors.count("\n")), (2, 1))
                self.assertIn("has the tables of a run, and these scores are not its own; choose another with --out", errors)
        self.assertEqual((self.files(), self.files(run)), (before, before))
        self.assertEqual(self.call("conclude", run, "--out", run.parent / "." / "scores")[0], 0)

    def test_the_same_bytes_whatever_the_number_of_threads(self):
        self.write_run()
        made = []
        for threads in ("1", "8"):
            limits = {name: threads for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS")}
            script = "import os, sys; os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:int(sys.argv[1])]); from salbench import __main__; " \
                     "sys.exit(__main__.main(['conclude', sys.argv[2], '--out', sys.argv[3], '--quiet']))"
            subprocess.run([sys.executable, "-B", "-c", script, threads, self.folder, self.folder / threads], check=True, env=os.environ | limits)
            made.append(self.files(self.folder / threads))
        self.assertEqual(*made)


# Ways to damage a table, as functions of its path.
DAMAGE = {
    "cut short": lambda path: path.write_bytes(path.read_bytes()[:100]),
    "another digit": lambda path: path.write_bytes(path.read_bytes()[:-2] + b"~\n"),
    "gone": lambda path: path.unlink(),
    "a pipe": lambda path: (path.unlink(), os.mkfifo(path)),
}


class WrittenAgainTest(FolderTest):
    whole = {}

    def setUp(self):
        super().setUp()
        if not self.whole:
            self.write_run()
            self.call("conclude", self.folder, "--quiet")
            self.whole.update(self.files())
        for name, content in self.whole.items():
            (self.folder / name).write_bytes(content)

    def test_a_table_that_is_not_what_was_written_is(self):
        for name, what in (("ranking.csv", "cut short"), *(("chance.csv", what) for what in DAMAGE)):
            with self.subTest(name, what=what):
                DAMAGE[what](self.folder / name)
                self.assertIsNone(conclusions_file.read_if_whole(self.folder))
                self.assertEqual(len(Results(self.folder).ranking), self.whole["ranking.csv"].count(b"\n") - 1)
                self.assertEqual(self.files(), self.whole)

    def test_what_is_whole_is_left_alone(self):
        before = {path: path.stat().st_mtime_ns for path in self.folder.iterdir()}
        conclusions.conclude_if_missing(self.folder)
        self.assertEqual({path: path.stat().st_mtime_ns for path in self.folder.iterdir()}, before)

    def test_a_document_that_cannot_be_used_counts_as_none(self):
        document = self.document()
        for text in ("[" * 100_000, "{}", "[]", "3", "null", '{"tables": 3}', json.dumps({**document, "files": {"summary.csv": 3}}),
                     json.dumps({**document, "files": {"summary.csv": "xxh128:0"}}), json.dumps({**document, "tables": ["../x.csv"]}),
                     json.dumps({**document, "tables": [["x"]]}), json.dumps({**document, "tables": [3]}), "\ud800"):
            with self.subTest(text[:30]):
                (self.folder / "conclusions.json").write_bytes(text.encode("utf-8", "surrogatepass"))
                self.assertIsNone(conclusions_file.read_if_whole(self.folder))
                self.assertIsInstance(conclusions_file.changed(self.folder), list)

    def test_digests_of_version_1_0(self):
        document = self.document()
        document["files"] = {name: hashlib.blake2b(self.whole[name], digest_size=16).hexdigest() for name in document["files"]}
        (self.folder / "conclusions.json").write_text(json.dumps(document))
        self.assertIsNotNone(conclusions_file.read_if_whole(self.folder))
        (self.folder / "people.csv").write_text("changed")
        self.assertEqual(conclusions_file.changed(self.folder), ["people.csv"])


class StrangersTest(FolderTest):
    def test_files_that_are_none(self):
        for name in ("results.csv", "people.csv", "constant.csv"):
            self.write_run()
            (self.folder / name).unlink()
            os.mkfifo(self.folder / name)
            with self.subTest(name):
                self.assertEqual(self.call("conclude", self.folder, "--quiet")[0], 2 if name == "results.csv" else 0)
            (self.folder / name).unlink()


class FailureTest(FolderTest):
    def test_unusable_arguments(self):
        self.write_run()
        unfinished = self.folder / "unfinished"
        unfinished.mkdir()
        (self.folder / "empty").mkdir()
        (unfinished / "run.yaml").write_text("# a run is under way, or was ended before its end\n")
        for arguments, said in (
                (["conclude", self.folder, "--unit", "foo"], "--unit foo"), (["conclude", self.folder, "--format", "xml"], "--format xml"),
                (["conclude", self.folder / "none.csv"], "none.csv"), (["conclude", unfinished], "unfinished"),
                (["conclude", self.folder / "empty"], "empty: holds no run.yaml"),
                (["conclude", self.folder, "--uni", "mesh"], "--uni"), (["conclude"], "OUT|SCORES.csv"), (["foo"], "'foo'"), ([], "subcommand"),
                (["conclude", self.folder, "--out", ""], "--out"), (["conclude", ""], "empty"), (["conclude", self.folder, "--classes", ""], "--classes")):
            status, out, errors = self.call(*arguments)
            self.assertEqual((status, out), (2, ""), arguments)
            self.assertTrue(errors.startswith("error: ") and said in errors and errors.count("\n") == 1, errors)

    def test_a_folder_that_cannot_be_written(self):
        self.write_run()
        (self.folder / "file").write_text("")
        status, _, errors = self.call("conclude", self.folder, "--out", self.folder / "file" / "below")
        self.assertEqual(status, 3)
        self.assertIn("cannot be created: Not a directory; choose another with --out", errors)
        (self.folder / "summary.csv").mkdir()
        status, _, errors = self.call("conclude", self.folder)
        self.assertEqual(status, 3)
        self.assertFalse([name for name in os.listdir(self.folder) if name.endswith(".salbench-part")])

    def test_a_defect_leaves_the_scores_and_no_document(self):
        self.write_run()
        self.call("conclude", self.folder, "--quiet")
        results = (self.folder / "results.csv").read_bytes()
        with mock.patch.object(conclusions, "TABLES", (Table("summary", lambda study: 1 / 0),)):  # type: ignore
            status, _, errors = self.call("conclude", self.folder)
        self.assertEqual((status, errors), (70, "error: a defect of salbench: ZeroDivisionError: division by zero\n"))
        self.assertEqual((self.folder / "results.csv").read_bytes(), results)
        self.assertFalse((self.folder / "conclusions.json").exists())


# A table of one's own: its columns, its function of a study and a row of the list; no other place knows of it.
SPREAD = (DATASET, number("spread", "largest less smallest score of all"))


def spread(study: Study) -> pandas.DataFrame:
    return framed(SPREAD, ({"dataset": level.dataset, "spread": np.ptp(level.values)} for level in study.levels))


class AddOneTest(FolderTest):
    def test_a_table_is_a_function_and_a_row(self):
        self.write_run()
        with mock.patch.object(conclusions, "TABLES", (*conclusions.TABLES, Table("spread", spread))):
            self.assertEqual(self.call("conclude", self.folder, "--quiet")[0], 0)
        self.assertIn("spread.csv", self.document()["tables"])
        found = pandas.read_csv(self.folder / "spread.csv")
        scores = pandas.read_csv(self.folder / "results.csv")
        of_meshes = scores.loc[scores["dataset"] == "meshes", ["auc", "kl"]].to_numpy()
        self.assertAlmostEqual(found["spread"][0], np.ptp(of_meshes))


class ImportsTest(FolderTest):
    def test_concluding_a_run_loads_no_heavy_library(self):
        """`salbench run` waits for it: nearly all its time is imports."""
        self.write_run()
        script = "import sys; from salbench import __main__; status = __main__.main(['conclude', sys.argv[1], '--quiet']); " \
                 "print(*sorted({name for name in sys.argv[2:] if name in sys.modules})); sys.exit(status)"
        heavy = ("scipy.stats", "scipy.optimize", "statsmodels", "sklearn", "matplotlib", "vtk", "vtkmodules")
        found = subprocess.run([sys.executable, "-B", "-c", script, self.folder, *heavy], check=True, capture_output=True, text=True)
        self.assertEqual(found.stdout, "\n")


class CopiesTest(unittest.TestCase):
    def test_of_a_run(self):
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        study(folder / "data", (1, 2, 3))
        for form in ("Meshes/{}.off", "Distributions/{}.val", *("RawData/{}_" + f"{person}.pid" for person in range(3))):
            shutil.copy(folder / "data" / form.format(1), folder / "data" / form.format(4))
        shutil.copy(folder / "data/Meshes/2.off", folder / "data/Meshes/3.off")  # of another ground truth: no copy
        (folder / "c.yaml").write_text("dataset: {scans: false}\nmodels: {CB: , LS: }\nmetrics: {names: [auc]}\n")
        done = forked.salbench("run", folder / "c.yaml", "--data", folder / "data", "--cache", folder / "cache", "--out", folder / "out", "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(read_record(folder / "out/run.yaml")["copies"], [["1", "4"]])
        self.assertEqual(set(ranking(read_run(folder / "out").study)["n"]), {3})
        self.assertIn("Copies, counted once: 1 and 4.", (folder / "out/leaders.csv").read_text())
