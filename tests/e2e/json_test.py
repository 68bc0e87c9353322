# SPDX-License-Identifier: GPL-3.0-or-later
"""The documents of --format json: docs/tables/documents.csv says what they hold, key for key and type for type, and the text says the same."""

import csv
import json
import os
import re
import shutil
import signal
import subprocess
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import salbench.conclusions
import salbench.leaderboard.commands  # noqa: F401  and with them libraries that each call would import
from tests.support import forked, toy_data
from tests.support.cache_files import amount, count_artefacts, damage, segment_with
from tests.support.without_figures import without_figures

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = toy_data.PROGRAM
CONFIG = "dataset: {layout: folder, participants: simulated, scans: false}\nmodels: {PS: , RS: }\n"
ODD = 'q"uo\\te é'  # a mesh
VIEWS = """from salbench.datasets import Item, match, mesh, values

def items(root):
    splits = {"cat": "train", "dog": "test"}
    return [Item(f"{one.item}_{one.view}", [f"{root}/off/{one.item}.off", one.path], shape=one.item, view=one.view, split=splits[one.item])
            for one in match(root, "maps/{item}_{view}.txt", splits)]

def read(item):
    shape = mesh(item.files[0])
    shape.ground_truth = values(item.files[1], len(shape.points), unseen=-1)
    return shape
"""
RECORDED = """from salbench.datasets import Item, Recording, gather, mesh, table

def items(root):
    return [Item("cat", [f"{root}/cat.off", f"{root}/cat.csv"], truth=False, recorded=2)]

def read(item):
    shape = mesh(item.files[0])
    shape.recording = gather(table(item.files[1]).groupby("who"), Recording.of, time="t", point=("x", "y", "z"))
    return shape
"""
TYPES = {str: "text", int: "number", float: "fraction", bool: "true or false", list: "list", type(None): "null"}


def documented():
    """Types of each key by subcommand, from docs/tables/documents.csv, including keys of every document and of referenced parts."""
    parts = {}
    with open(ROOT / "docs/tables/documents.csv", encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            parts.setdefault(row["document"], []).append((row["key"], row["type"]))

    def keys(name):
        rows = [(key, types) for key, types in parts[name] if key]
        assert len(rows) == len(dict(rows)), "a key stands there twice"
        found = {key: set(re.findall("true or false|[a-z]+", types.replace(" or null", " null"))) - {"or"} for key, types in rows}
        for key, other in parts[name]:
            if not key:
                found.update(keys(other.removeprefix("those of ")))
        return found
    named = {types.removeprefix("those of ") for rows in parts.values() for key, types in rows if not key}
    return {name: {**keys("every document"), **keys(name)} for name in parts if name not in named | {"every document"}}


def keys_of(value, path=""):
    """Pairs of a key as the documentation writes it and a type."""
    if isinstance(value, dict):
        for key, member in value.items():
            yield from keys_of(member, f"{path}.{key}" if path else key)
        return
    yield path, TYPES[type(value)]
    if isinstance(value, list):
        for element in value:
            yield from keys_of(element, path + "[]")


class JsonTest(unittest.TestCase):
    """Goes through the life of one cache, from none to what is left after garbage collection."""

    @classmethod
    def setUpClass(cls):
        holder = tempfile.TemporaryDirectory(prefix='js"on \\ é\x01\t')
        cls.addClassCleanup(holder.cleanup)
        cls.folder = Path(holder.name)
        cls.cache, cls.config = cls.folder / "cache", cls.folder / "toy.yaml"
        cls.config.write_text(CONFIG)
        toy_data.meshes(cls.folder / "data", 2, 16, 8)
        (cls.folder / "data/2.off").rename(cls.folder / f"data/{ODD}.off")
        cls.version = subprocess.run([PROGRAM, "--version"], check=True, capture_output=True, text=True).stdout.split()[1]
        cls.seen = {}  # subcommand: types of each key

    def seen_in(self, said, command):
        """The document that was printed, each key of which is seen."""
        self.assertEqual((said.count("\n"), said[-1]), (1, "\n"))
        document = json.loads(said)
        self.assertEqual((document["schema"], document["command"]), (2, command))
        for key, kind in keys_of(document):
            self.seen.setdefault(command, {}).setdefault(key, set()).add(kind)
        return document

    def salbench(self, subcommand, *further, status=0, preload=None):
        folders = ["--data", self.folder / "data", "--cache", self.cache]
        if subcommand in ("run", "plan") and "--graph" not in further:
            folders += ["--out", self.folder / "out"]
        if subcommand == "run":
            folders += ["--threads", "1"]
        words = [subcommand, self.config, *further, *folders]
        if preload:
            done = subprocess.run([PROGRAM, *words], capture_output=True, text=True, env=os.environ | preload)
        else:
            done = forked.salbench(*words)
        self.assertEqual(done.returncode, status, done.stderr)
        return done.stdout

    def document(self, subcommand, *further, status=0, command=""):
        """The document, and the text that says the same."""
        document = self.seen_in(self.salbench(subcommand, *further, "--format", "json", status=status), command or subcommand)
        return document, self.salbench(subcommand, *further, status=status)

    def run_to(self, status=0, preload=None):
        self.salbench("run", "--quiet", status=status, preload=preload)

    def check_results(self):
        """run, which has nothing to do any more, and conclusions from what it wrote."""
        out = self.folder / "out"
        document, text = self.document("run")
        shard, _ = self.document("run", "--shard", "1/2")
        self.assertEqual((document["results"], document["computed"], document["simulated"]), (str(out), 0, True))
        self.assertEqual((shard["shard"], shard["leaders"]), ("1/2", []))
        (level,) = document["leaders"]
        self.assertIn(f"\n{level['sentence']}\n", text)
        concluded = self.summary("conclude", out / "results.csv", "--out", self.folder / "concluded")
        self.assertEqual((concluded["leaders"], concluded["unit"]), (document["leaders"], "mesh"))
        table = self.folder / "scores.csv"
        table.write_text("item,model,auc,nss\n1,A,0.5,1\n2,A,0.75,\n1,B,0.25,\n2,B,0.375,1\n")
        self.summary("conclude", table, "--out", self.folder / "concluded")

    def check_counts(self):
        """plan, by the text and by the files. Returns the open jobs, and how the last run ended."""
        plan, text = self.document("plan")
        for stage in plan["stages"]:
            self.assertEqual((stage["artefacts"], stage["bytes"]), amount(self.cache, stage["stage"]))
            numbers = "{cached} +{to_compute} +{waiting} +{not_applicable} +{failed} +{artefacts}".format(**stage)
            reasons = "; ".join(f"{reason['why']}: {reason['jobs']}" for reason in stage["reasons"])
            self.assertRegex(text, f"(?m)^{re.escape(stage['stage'])} +{numbers} +[0-9.e-]+ *{re.escape(reasons)}$")
        self.assertEqual((plan["meshes"], plan["clouds"], plan["models"]), (2, 0, 2))
        self.assertEqual((plan["cache"], plan["results"]), (str(self.cache), str(self.folder / "out")))
        self.assertEqual(f"\nlast run: {plan['last_run']}\n" in text, plan["last_run"] is not None)
        self.assertEqual(plan["open"], sum(stage["to_compute"] + stage["waiting"] for stage in plan["stages"]))
        self.assertIn(f"\n{plan['open']} jobs to do", text)
        return plan["open"], plan["last_run"]

    def check_item(self, item, *stage):
        document, text = self.document("plan", item, *stage, command="item")
        self.assertEqual(document["item"], item)
        for row in document["stages"]:
            self.assertRegex(text, f"(?m)^{re.escape(row['stage'])} +{row['state']} *{re.escape(row['why'])}$")
        return {row["stage"]: row["state"] for row in document["stages"]}

    def check_graph(self, *further):
        document, text = self.document("plan", "--graph", *further, command="graph")
        for node in document["nodes"]:
            to_do = "" if node["to_do"] is None else f", {node['to_do']} to do"
            inputs = " <- " + ", ".join(node["inputs"]) if node["inputs"] else ""
            inputs += "; read back: " + ", ".join(node["cuts"]) if node["cuts"] else ""
            options = "  " + ", ".join(node["options"]) + "\n" if node["options"] else ""
            self.assertIn("{node} (version {version}, one per {per}".format(**node) + f"{to_do}){inputs}\n{options}", text)
            self.assertEqual(node["node"], "{stage} of {shapes}".format(**node))
        return [node["to_do"] for node in document["nodes"]]

    def check_verify(self, *further, status=0):
        document, text = self.document("verify", *further, status=status)
        (cache,) = document["caches"]
        self.assertIn("{cache}: {artefacts} artefacts, ".format(**cache) + f"{cache['bytes'] / 1e6:.1f} MB: {len(cache['faults'])} bad", text)
        for sample in document["samples"]:
            self.assertIn("{configuration}: {jobs} of its jobs computed again: ".format(**sample) + f"{len(sample['faults'])} came", text)
        for fault in cache["faults"] + [fault for sample in document["samples"] for fault in sample["faults"]]:
            self.assertIn("{file}: {what}\n".format(**fault), text)
        self.assertFalse(document["interrupted"])
        return cache, document["samples"]

    def check_gc(self, *further):
        document, text = self.document("gc", "--dry-run", *further)
        for stage in document["stages"]:
            self.assertRegex(text, f"(?m)^{re.escape(stage['stage'])} +{stage['kept']['files']} +[0-9.e-]+ +{stage['removed']['files']} ")
        removed = sum(stage["removed"]["files"] for stage in document["stages"])
        self.assertIn(f"\nwould be removed: {removed} artefacts ", text)
        self.assertIn(f" {document['damaged']['files']} damaged files, {document['unfinished']['files']} unfinished files\n", text)
        return removed, document

    def check_inspection(self):
        """Two views of one mesh in two splits, one of them with a problem."""
        data = self.folder / "views"
        for name in ("off", "maps"):
            (data / name).mkdir(parents=True)
        mesh = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 {}\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"
        others = self.folder / "others"
        others.mkdir()
        for name, text in (("same", mesh.format(1)), ("higher", mesh.format(9)), ("broken", "OFF\n1 2\n")):
            (others / f"{name}.off").write_text(text)
        for name in ("cat", "dog"):
            (data / f"off/{name}.off").write_text(mesh.format(1))
            (data / f"maps/{name}_1.txt").write_text("1\n2\n-1\n4.5\n")
        (data / "maps/dog_2.txt").write_text("1\n2\n3\n")
        (data / "readme.txt").write_text("")
        own = self.folder / "own.py"
        own.write_text(VIEWS)
        words = [own, "--data", data, "--against", "folder", "--against-data", others]
        self.assertEqual(self.summary("inspect", *words, status=1)["near_copies"][0]["distance"], "0.0000")
        text = forked.salbench("inspect", *words).stdout
        self.assertIn("\n  cat is same, 0.0000\n", text)
        self.assertRegex(text, r"(?m)^dog_1 +test +4 +4 +1.7321 +0.7500 +1.0000 +4.5000 ")
        self.summary("import", own, "--data", data, "--to", self.folder / "one_form", "--quiet", status=1)
        self.check_recording(data / "off")

    def check_recording(self, meshes):
        """Two people's hits on one mesh, one of which is no number."""
        data, own = self.folder / "recorded", self.folder / "gaze.py"
        data.mkdir()
        shutil.copy(meshes / "cat.off", data)
        (data / "cat.csv").write_text("who,t,x,y,z\nA,0,.1,.1,0\nA,10,.2,.1,0\nB,0,.3,.1,0\nB,20,none,.1,0\n")
        own.write_text(RECORDED)
        (item,) = self.summary("inspect", own, "--data", data)["items"]
        self.assertEqual([[*one.values()][:6] for one in item["people"]], [["A", 2, 0, 2, 2, 0], ["B", 2, 1, 1, 1, 0]])
        self.summary("import", own, "--data", data, "--to", self.folder / "recorded_form", "--quiet")

    def summary(self, subcommand, *words, status=0, option="--format"):
        """The document of a command with these words alone."""
        done = forked.salbench(subcommand, *words, option, "json")
        self.assertEqual(done.returncode, status, done.stderr)
        return self.seen_in(done.stdout, subcommand)

    def check_summaries(self):
        """Commands over six good meshes, the minimum for ranks, and an unreadable one."""
        folder = self.folder / "summaries"
        data, mine, out = folder / "data", folder / "maps/PS", folder / "out"
        toy_data.meshes(data, 6, 16, 8)
        (data / "7.off").write_text("OFF\n")
        config = folder / "toy.yaml"
        config.write_text(CONFIG)
        over = ["--data", data, "--cache", folder / "cache", "--threads", "1"]
        run = [config, *over]
        document = self.summary("run", *run, "--out", out, status=1)
        self.assertEqual([(failed["item"], failed["stage"]) for failed in document["failed"]], [("7", "mesh")])
        rows = {(row["model"], row["metric"]): row for row in document["scores"]}
        text = (out / "summary.csv").read_text()
        for (model, metric), row in rows.items():
            self.assertIn(f"\nmeshes,{model},{metric},{row['n']},{row['mean']},", text)
        self.assertEqual(self.summary("run", *run, "--out", out, "--shard", "1/1", status=1)["shard"], "1/1")
        self.assertEqual(self.summary("export", *run, "--to", folder / "maps", "--format", "maps", status=1, option="--summary")["shapes"], 12)
        words = ["--maps", mine, "--name", "OWN"]
        self.assertIn("OWN", {row["model"] for row in self.summary("run", *run, "--out", out, *words, status=1)["scores"]})
        self.assertEqual(self.summary("export", *run, "--to", folder / "all.h5", status=1, option="--summary")["shapes"], 7)
        with without_figures():
            page = Path(self.summary("report", out, "--processes", "1", "--no-viewer", "--export", folder / "all.h5")["page"])
        self.assertEqual((page.name, page.is_file()), ("index.html", True))
        self.assertIn("\nseed: 2016\n", self.summary("config")["yaml"])
        (mine / "card.yaml").write_text("name: OWN\ncitation: c\nlicence: l\ntraining_data: none\ntest_overlap: none\n")
        archive = folder / "submissions/own.zip"
        archive.parent.mkdir()
        submit = [mine, "-c", config, *over, "--to", archive]
        self.assertIsNone(self.summary("submit", *submit, status=1)["to"])
        site = [archive.parent, "-c", config, *over, "--to", folder / "site"]
        archive.write_text("no archive")
        document = self.summary("leaderboard", *site, status=1)
        self.assertEqual([row["status"] for row in document["submissions"]], ["refused"])
        archive.unlink()  # what is no submission is not written over
        (data / "7.off").unlink()
        self.assertEqual(self.summary("submit", *submit)["to"], str(archive))
        document = self.summary("leaderboard", *site)
        self.assertEqual([row["status"] for row in document["submissions"]], ["ranked"])
        self.assertEqual(len(self.summary("submit", *submit)["unsaid"]), 8)
        (mine / "card.yaml").write_text("name: VARIANT\ncitation: c\nlicence: l\ntraining_data: none\ntest_overlap: none\n")
        height = "[ {item} != \"$FAILS_ON\" ] && awk 'NR > 2 && NF == 3 { print $3 }' {source} > {out}"
        config.write_text(CONFIG.partition("models:")[0] + f"models: {{VARIANT: {{command: {json.dumps(height)}}}}}\n")
        for file in mine.glob("*.val"):
            file.unlink()
        self.summary("submit", *submit)
        document = self.summary("reproduce", archive, "--data", data, "--threads", "1", "--to", folder / "reproduced")
        self.assertEqual((document["outcome"], document["maps"], document["same_maps"]), ("to the bit", 6, 6))
        with mock.patch.dict(os.environ, FAILS_ON="2"):
            document = self.summary("reproduce", archive, "--data", data, "--threads", "1", status=1)
        self.assertEqual((document["outcome"], document["same_maps"], [failed["item"] for failed in document["failed"]]), ("not runnable", 5, ["2"]))

    def test_documents_agree_with_their_documentation_and_with_the_text(self):
        with self.subTest("no cache"):
            left, state = self.check_counts()
            self.assertTrue(left > 0 and state is None)
            self.assertLessEqual({"to compute", "waiting"}, set(self.check_item(ODD).values()))
            self.assertEqual(sum(self.check_graph()), left)
            self.assertFalse(self.cache.exists())
        with self.subTest("interrupted"):
            self.run_to(130, {"LD_PRELOAD": os.environ["SALBENCH_KILL_AT_RENAME"], "SALBENCH_KILL_AT": "4 after",
                              "SALBENCH_KILL_BY": str(int(signal.SIGINT)), "ASAN_OPTIONS": "verify_asan_link_order=0"})
            now, state = self.check_counts()
            self.assertTrue(0 < now < left and state.startswith("partial"))
            _, collected = self.check_gc()
            self.assertGreater(collected["waiting"], 0)
        with self.subTest("finished"):
            self.run_to()
            self.check_results()
            self.assertEqual(self.check_counts(), (0, "finished"))
            self.assertLessEqual({"cached"}, set(self.check_item(ODD).values()))
            self.assertEqual(set(self.check_graph()), {0})
            (cache, samples) = self.check_verify("--deep", "--sample", "3")
            self.assertEqual((cache["cache"], cache["faults"], samples[0]["jobs"]), (str(self.cache), [], 3))
            self.assertEqual(self.check_gc()[0], 0)
        with self.subTest("damaged"):
            bad = segment_with(self.cache, "fpfh", "1")
            sound = bad.read_bytes()
            damage(self.cache, "fpfh", "1")
            cache, samples = self.check_verify("--deep", "--sample", "1000", status=1)
            self.assertEqual({fault["file"] for fault in cache["faults"]}, {str(bad)})
            self.assertGreater(len(samples[0]["faults"]), 0)
            self.assertEqual(self.check_item("1", "fpfh"), {"fpfh": "cached"})  # a plan reads no arrays
            bad.write_bytes(sound)
        with self.subTest("another configuration"):
            self.config.write_text(CONFIG.replace("PS: , RS: ", "PS: {absolute: true}, RS: "))
            self.assertGreater(self.check_counts()[0], 0)
            self.assertEqual(self.check_item("1", "map.PS"), {"map.PS": "to compute"})
            removed, collected = self.check_gc()
            self.assertTrue(removed > 0 or collected["waiting"] > 0)
            self.config.write_text(CONFIG.replace("PS: , RS: ", "RS: "))
            before = count_artefacts(self.cache)
            removed, collected = self.check_gc()
            done = json.loads(self.salbench("gc", "--quiet", "--format", "json"))
            self.assertEqual(done, {**collected, "dry_run": False})
            self.assertEqual(count_artefacts(self.cache), before - removed)
        with self.subTest("no data set"):
            done = forked.salbench("plan", self.config, "--graph", "--format", "json")
            nodes = json.loads(done.stdout)["nodes"]
            self.assertEqual({node["to_do"] for node in nodes}, {None})
            self.seen["graph"]["nodes[].to_do"].add("null")
        with self.subTest("a data set of one's own"):
            self.check_inspection()
        with self.subTest("summaries"):
            self.check_summaries()
        for subcommand, keys in documented().items():
            with self.subTest(subcommand):
                seen = self.seen[subcommand]
                self.assertEqual(seen.keys(), keys.keys())
                self.assertEqual({key: kinds for key, kinds in seen.items() if not kinds <= keys[key]}, {})

    def test_bytes_that_are_not_utf_8_are_replaced(self):
        cache = os.fsencode(self.folder) + b"/caf\xe9"
        shutil.rmtree(cache, ignore_errors=True)
        done = subprocess.run([PROGRAM, "plan", self.config, "--data", self.folder / "data", "--cache", cache, "--format", "json"],
                              check=True, capture_output=True)
        self.assertEqual(json.loads(done.stdout.decode("utf-8"))["cache"], f"{self.folder}/caf\ufffd")
