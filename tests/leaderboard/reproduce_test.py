# SPDX-License-Identifier: GPL-3.0-or-later
"""From a trained model to a submission, a leaderboard, and the same maps made by somebody else elsewhere."""

import csv
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

import numpy as np
import toy
from toy import card, rewrite

from salbench import Dataset
from salbench.leaderboard import reproduce
from salbench.leaderboard.archive import read_zip, zip_of
from salbench.leaderboard.card import Card, read_card, with_line
from salbench.leaderboard.submission import Submission
from salbench.leaderboard.texts import Manifest
from salbench.system.errors import InputError
from tests.support import forked
from tests.support.toy_data import PROGRAM

# A linear model of the distance to the centroid. `rounding` is of the machine and not of the model: a library of another version, say.
PREDICT = """import os, sys
import h5py, numpy as np
weights = np.load("weights.npy")
with h5py.File(sys.argv[1]) as shape:
    points = shape["points"][:]
away = np.linalg.norm(points - points.mean(axis=0), axis=1)
map = weights[0] * away / away.max() + weights[1]
rounding = os.environ.get("ROUNDING", "")
if rounding == "single":
    map = map.astype(np.float32).astype(np.float64)
if rounding == "other":
    map = -map
if rounding == "fails":
    sys.exit("no GPU here")
np.save(sys.argv[2], map)
"""
ASKED = ("version: v1\nparameters: 2\ncode: https://example.org/net\nweights: https://example.org/weights\ntraining_set: none\ndevice: a processor\n"
         "memory: 60 MB\ncontact: a@example.org\n")


def write_model(folder, data):
    """Trains on the data set, and writes what others need."""
    folder.mkdir()
    shapes = Dataset("schelling", data, items="scored")
    x = [np.linalg.norm(shape.points - shape.points.mean(axis=0), axis=1) for shape in shapes]
    x = np.concatenate([away / away.max() for away in x])
    y = np.concatenate([shape.ground_truth for shape in shapes])
    weights = np.linalg.lstsq(np.column_stack([x, np.ones(len(x))]), y, rcond=None)[0]
    np.save(folder / "weights.npy", weights)
    (folder / "predict.py").write_text(PREDICT)
    (folder / "card.yaml").write_text(card("NET", overlap="none") + ASKED)
    (folder / "model.yaml").write_text(
        "dataset: {scans: false}\nmetrics: [auc, cc]\nmodels:\n  NET:\n"
        f"    command: \"{sys.executable} predict.py {{shape}} {{out.npy}}\"\n    reads: [points]\n    depends: [predict.py, weights.npy]\n")


def copied(model, to):
    """By somebody who has code and weights, and neither card nor configuration."""
    to.mkdir()
    for name in ("predict.py", "weights.npy"):
        shutil.copyfile(model / name, to / name)
    return to


class RoundTrip(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        os.chmod(cls.folder, 0o755)  # another user reads it
        cls.data = toy.Toy(cls.folder, meshes=2).data
        cls.model, cls.zip = cls.folder / "net", cls.folder / "net.zip"
        write_model(cls.model, cls.data)
        done = cls.salbench("submit", cls.model, "--to", cls.zip, "-c", cls.model / "model.yaml", "--cache", cls.folder / "author's")
        assert done.returncode == 0, done.stderr
        cls.said = done.stderr

    @classmethod
    def salbench(cls, command, *words, environment=(), **others):
        line = [command, *words, "--data", cls.data, "--threads", "2"]
        if not others:
            return forked.salbench(*line, **dict(environment))
        return subprocess.run([PROGRAM, *line], capture_output=True, text=True, env={**os.environ, **dict(environment)}, **others)

    def reproduce(self, *words, model=None, archive=None, rounding="", **others):
        return self.salbench("reproduce", archive or self.zip, "--model", model or self.model, *words, environment={"ROUNDING": rounding}, **others)

    def outcome(self, done):
        return json.loads(done.stdout)

    def rows(self, path):
        with open(path, newline="") as file:
            return list(csv.DictReader(file))

    def test_somebody_else_elsewhere_makes_the_same_maps(self):
        other = copied(self.model, self.folder / "elsewhere")
        home = self.folder / "home"
        home.mkdir()
        as_nobody = {"user": 65534, "group": 65534} if os.getuid() == 0 else {}
        if as_nobody:
            os.chown(home, 65534, 65534)
        done = self.salbench("reproduce", self.zip, "--model", other, "--to", home / "out", "--by", "Jane Doe", "--format", "json",
                             environment={"HOME": str(home), "TMPDIR": str(home)}, cwd=home, **as_nobody)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([path.name for path in home.iterdir()], ["out"])
        self.assertIn("note: runs, for each shape, what net.zip names: " + sys.executable + " predict.py", done.stderr)
        said = self.outcome(done)
        n = said["meshes"]
        self.assertEqual((said["outcome"], said["maps"], said["same_maps"]), ("to the bit", n, n))
        rows = self.rows(home / "out/reproduced.csv")
        self.assertEqual({row["outcome"] for row in rows}, {"to the bit"})
        self.assertEqual(len({row["shape"] for row in rows}), n)
        new = read_zip((home / "out/NET.zip").read_bytes(), 1000, 1 << 30)
        self.assertRegex(read_card(new["card.yaml"], "card.yaml").reproduced_by[0], rf"^20..-..-.., Jane Doe: to the bit: {n} of {n} maps are the same to the bit \(")
        before = read_zip(self.zip.read_bytes(), 1000, 1 << 30)
        self.assertEqual({name for name in before if before[name] != new[name]}, {"card.yaml"})
        submissions = self.folder / "submissions of two"
        submissions.mkdir()
        shutil.copyfile(home / "out/NET.zip", submissions / "net.zip")
        ranked = self.salbench("leaderboard", submissions, "--to", self.folder / "site", "-c", self.model / "model.yaml", "--cache", self.folder / "cache")
        self.assertEqual(ranked.returncode, 0, ranked.stderr)
        row = self.rows(self.folder / "site/data/submissions.csv")[0]
        self.assertEqual((row["model"], row["status"], row["remark"]), ("NET", "ranked", ""))

    def test_maps_from_a_cache_are_not_called_computed(self):
        to = self.folder / "from a cache"
        done = self.reproduce("--cache", self.folder / "author's", "--to", to, "--by", "Jane")
        self.assertRegex(done.stdout, r"NET: to the bit: .*; \d+ were read from the cache")
        line, = read_card(read_zip((to / "NET.zip").read_bytes(), 1000, 1 << 30)["card.yaml"], "card.yaml").reproduced_by
        self.assertIn("were read from the cache", line)

    def test_a_file_that_only_its_author_has_is_named(self):
        model = self.folder / "absolute"
        shutil.copytree(self.model, model)
        text = (model / "model.yaml").read_text()
        (model / "model.yaml").write_text(text.replace("weights.npy]", f"weights.npy, '{model}/weights.npy']"))
        done = self.salbench("submit", model, "--to", self.folder / "absolute.zip", "-c", model / "model.yaml", "--cache", self.folder / "cache")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stderr, f"note: .* reproduce .*{model}/weights.npy")

    def test_other_weights_or_code_are_refused(self):
        for name in ("weights.npy", "predict.py"):
            with self.subTest(name):
                other = copied(self.model, self.folder / f"other {name}")
                data = bytearray((other / name).read_bytes())
                data[-1] ^= 1
                (other / name).write_bytes(data)
                done = self.reproduce(model=other)
                self.assertEqual((done.returncode, done.stdout), (2, ""))
                self.assertRegex(done.stderr, f"error: .*other {name}/{name}: its SHA-256 is [0-9a-f]{{64}}, and the submission has ")
                (other / name).unlink()
                self.assertIn(f"{name}: there is no such file", self.reproduce(model=other).stderr)

    def test_another_library_rounds_otherwise(self):
        """The folder of the model lies in the one that is named."""
        done = self.reproduce("--to", self.folder / "single", "--format", "json", rounding="single", model=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual((self.outcome(done)["outcome"], self.outcome(done)["same_maps"]), ("to rounding", 0))
        rows = self.rows(self.folder / "single/reproduced.csv")
        self.assertEqual({row["outcome"] for row in rows}, {"to rounding"})
        self.assertTrue(all(0 < float(row["difference"]) < reproduce.ROUNDING for row in rows))

    def test_another_map_differs(self):
        done = self.reproduce("--format", "json", rounding="other")
        self.assertEqual(done.returncode, 1, done.stderr)
        said = self.outcome(done)
        self.assertEqual((said["outcome"], said["same_maps"]), ("differs", 0))
        self.assertRegex(said["reproduced_by"], r"somebody: differs: 0 of \d+ maps are the same to the bit")

    def test_what_cannot_be_run_here_says_why(self):
        done = self.reproduce(rounding="fails")
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, "error: .*net.zip: not runnable here: .*no GPU here")

    def test_the_manifest_knows_how_the_maps_came_about(self):
        entries = read_zip(self.zip.read_bytes(), 1000, 1 << 30)
        said = entries["submission.yaml"].decode()
        for line in ('format: "salbench submission 2"', 'made_by: "command"', 'seconds: ["', 'timed: "wall time of one answer of the command', " weights.npy"):
            self.assertIn(line, said)
        self.assertIn(sys.executable, entries["model.yaml"].decode())
        self.assertNotIn("does not say", self.said)

    def test_archives_that_name_more_than_they_may(self):
        """Nothing outside of the folder that the user named is read, and no line of the archive is believed."""
        def spoilt(change):
            entries = read_zip(self.zip.read_bytes(), 1000, 1 << 30)
            change(entries)
            path = self.folder / "spoilt.zip"
            path.write_bytes(zip_of(entries.items()))
            return path

        def model(change):
            return lambda entries: rewrite(entries, "model.yaml", change)

        def depends(name):
            return model(lambda text: text.replace(b'"predict.py"', json.dumps(name).encode()))

        def option(line):
            return model(lambda text: text + line)

        def with_digest_of(entries):
            depends("/etc/passwd")(entries)
            entries["submission.yaml"] = entries["submission.yaml"].replace(b" predict.py", b" /etc/passwd")

        def other_container(entries):
            depends("a@sha256:" + "0" * 64)(entries)
            entries["card.yaml"] += f"container: b@sha256:{'1' * 64}\n".encode()

        for change, said in (
                (depends("/etc/passwd"), 'it depends on "/etc/passwd", which'), (depends("../x"), 'it depends on "../x", which'),
                (option(b"depends: 5\n"), 'it depends on "5", which is no path'),
                (option(b"? [a, b]\n: c\n"), "spoilt.zip: model.yaml: found unhashable key"),
                (lambda entries: entries.update({"configuration.yaml": b"# \xff"}), "spoilt.zip: configuration.yaml: is not UTF-8"),
                (lambda entries: entries.update({"card.yaml": b"# \xff"}), "spoilt.zip: card.yaml: is not UTF-8"),
                (with_digest_of, 'it depends on "/etc/passwd"'), (depends("not/there"), 'it depends on "not/there", which'),
                (lambda entries: entries.update({"model.yaml": entries["model.yaml"] + b" "}), "model.yaml is not what submission.yaml has the digest of"),
                (lambda entries: entries.pop("card.yaml"), "has no card.yaml"), (other_container, "the command runs another image: sha256:00"),
                (lambda entries: entries.pop("model.yaml"), "has no model.yaml"), (lambda entries: entries.pop("configuration.yaml"), "has no configuration.yaml"),
                (lambda entries: entries.update({"configuration.yaml": b"models: {X: {command: touch /tmp/salbench-was-here}}"}), "has models, expected the protocol")):
            done = self.reproduce(archive=spoilt(change))
            self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
            self.assertIn(said, done.stderr)
            self.assertNotIn("runs, for each shape", done.stderr)

    def test_a_line_that_a_leaderboard_would_refuse_is_refused_before_anything_runs(self):
        full = self.folder / "full.zip"
        entries = read_zip(self.zip.read_bytes(), 1000, 1 << 30)
        entries["card.yaml"] += b"reproduced_by: [" + b", ".join([b"x" * 1900] * 34) + b"]\n"
        full.write_bytes(zip_of(entries.items()))
        for archive, by, said in ((self.zip, "J" * 1001, "net.zip: with the line of --by, card.yaml: reproduced_by has 2001 bytes"),
                                  (self.zip, "J\ufffe", "--by, card.yaml"), (full, "Jane", "full.zip: with the line of --by, card.yaml: 6")):
            done = self.reproduce("--to", self.folder / "refused", "--by", by, archive=archive)
            self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
            self.assertIn(said, done.stderr)
            self.assertNotIn("runs, for each shape", done.stderr)
        self.assertFalse((self.folder / "refused").exists())

    def test_maps_of_files_cannot_be_made_again(self):
        maps = self.folder / "as files"
        maps.mkdir()
        for name, data in read_zip(self.zip.read_bytes(), 1000, 1 << 30).items():
            if name.startswith("maps/"):
                np.savetxt(maps / f"{Path(name).stem}.val", np.load(io.BytesIO(data)), fmt="%.17g")
        (maps / "card.yaml").write_text(card("FILES") + "contact: ask@example.org\n")
        done = self.salbench("submit", maps, "--to", self.folder / "files.zip", "-c", self.model / "model.yaml", "--cache", self.folder / "author's")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("card.yaml does not say device (processor or GPU that the seconds were measured on: without it they mean nothing)", done.stderr)
        done = self.reproduce(archive=self.folder / "files.zip")
        self.assertEqual(done.returncode, 2)
        self.assertIn("not runnable: its maps came from files, and it names no command; ask ask@example.org", done.stderr)

    def test_where_files_are_found_and_that_they_differ(self):
        """In the folder of the model and those above it, below leading folders that all recorded names share, whatever they are called here."""
        net, contents = self.folder / "a/models/net", {"net.py": b"code", "w/w.npy": b"weights"}
        (net / "w").mkdir(parents=True)
        for folder, recorded in (("models/net", "models/net"), ("models/net", "x"), ("models", "net"), ("models", "models/net"), (".", "models/net"), ("models", ""),
                                 ("models", "x/y")):
            for name, content in contents.items():
                (net / name).write_bytes(content)
            names = [os.path.join(recorded, name) for name in contents]
            files = [f"{hashlib.sha256(content).hexdigest()} {name}" for name, content in zip(names, contents.values())]
            arguments = Path("net.zip"), Submission(Card(name="NET"), Manifest(files=files)), {"depends": names}, self.folder / "a" / folder
            with self.subTest(folder=folder, recorded=recorded), tempfile.TemporaryDirectory() as place:
                reproduce._link_files(*arguments, Path(place))
                self.assertTrue(all(os.path.samefile(Path(place, recorded, name), net / name) for name in contents))
                (net / "w/w.npy").write_bytes(b"other")
                with self.assertRaisesRegex(InputError, rf"net/w/w.npy: its SHA-256 is {hashlib.sha256(b'other').hexdigest()}, .*{files[1][:32]}"):
                    reproduce._link_files(*arguments, Path(place, "again"))


class Options(unittest.TestCase):
    """model.yaml of strangers."""

    def options(self, text):
        return reproduce._options_of(Submission(Card(name="A"), Manifest(made_by="command"), options=text.encode(errors="surrogatepass")), Path("a.zip"))

    def test_each_key_with_each_kind(self):
        """Never a defect: an error that names the file, or texts that the program checks."""
        for key in ("command", "depends", "reads", "version", "timeout", "at_once", "gpu", "trained_on", "other"):
            for value in ("5", "2001-01-01", "!!int abc", "!!binary abc", "!!timestamp x", "!!float [a]", "!!set {a}", "!!merge x", "~", "[[a]]", "{a: b}", "{? [a] : b}",
                          "[1, ~]", '"\\ud800"', '"\\e[31m"'):
                with self.subTest(key=key, value=value):
                    try:
                        found = self.options(f"{key}: {value}\n")
                    except InputError as error:
                        self.assertTrue(str(error).startswith("a.zip: model.yaml"), error)
                    else:
                        json.dumps(found, ensure_ascii=False).encode()
        for text in ("[a]", "just text", "? [a, b]\n: c\n", "a: b\n---\nc: d\n", "a: &a b\nc: &a d\n", "a: &a [*a]\n", "!!python/none x",
                     "a: \udcff", "[" * 1000, "a: '\ud800'"):
            with self.subTest(text[:20]), self.assertRaisesRegex(InputError, "^a.zip: model.yaml[: ]"):
                self.options(text)


class Seeds(unittest.TestCase):
    def test_trainings_of_one_model_stand_beside_each_other(self):
        """Maps of further seeds are handed in with the model's; the ranking has one of them, and seeds.csv all. Whatever models are called."""
        made = toy.Toy(Path(self.enterContext(tempfile.TemporaryDirectory())))
        made.config.write_text("dataset: {scans: false}\nmetrics: [auc, cc]\nmodels: {RS: , T1: {model: LS}}\n")
        folder = made.maps("T0", 1)
        last = "s" * 64
        for seed, noise in (("1", 2), (last, 4)):
            for file in made.maps(f"seed{seed}", noise).glob("*.val"):
                (folder / seed).mkdir(exist_ok=True)
                shutil.copyfile(file, folder / seed / file.name)
        (folder / "card.yaml").write_text(card("T0") + f"seeds: [1, {last}]\n")
        done = made.salbench("submit", folder, "--to", made.submissions / "T0.zip", "-c", made.config)
        self.assertEqual(done.returncode, 0, done.stderr)
        made.submit("OTHER", 3)
        done = made.rank("--models", "T1")
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = [row for row in made.table("seeds") if row["metric"] == "auc"]
        self.assertEqual([(row["model"], row["seed"], row["n"]) for row in sorted(rows, key=lambda row: row["seed"])],
                         [("T0", "", "6"), ("T0", "1", "6"), ("T0", last, "6")])
        own = {row["model"]: row["mean"] for row in made.table("ranking") if row["metric"] == "auc"}
        self.assertEqual({row["mean"] for row in rows if not row["seed"]}, {own["T0"]})
        self.assertEqual(len({row["mean"] for row in rows}), 3)
        self.assertEqual(set(own), {"T0", "T1", "OTHER"})
        self.assertEqual({row["model"] for row in made.table("results")}, {"T0", "T1", "OTHER"})
        card_text = (folder / "card.yaml").read_text()
        made.with_card("T0.zip", card_text.replace("test_overlap: none", "test_overlap: [1]"), of="T0")
        made.rank("--models", "T1")
        self.assertIn("beside", made.verdicts()["T0.zip"])
        self.assertEqual({(row["seed"], row["n"]) for row in made.table("seeds")}, {("", "5"), ("1", "5"), (last, "5")})
        made.with_card("T0.zip", card_text, of="T0")
        expected = {}
        for case, change, said in (
                ("missing", lambda entries: entries.pop(f"seeds/{last}/3.npy"), f"seeds/{last} has no map of 1 of 6 items, such as 3"),
                ("unknown", lambda entries: entries.update({"seeds/3/1.npy": entries["maps/1.npy"]}), "card.yaml has no such seed"),
                ("other", lambda entries: entries.update({"maps/1.npy": entries["maps/2.npy"]}), "the maps are not what submission.yaml has the digest of")):
            made.spoil(f"{case}.zip", change, of="T0")
            expected[f"{case}.zip"] = said
        made.rank()
        verdicts = made.verdicts()
        self.assertEqual({file: said for file, said in expected.items() if said not in verdicts[file]}, {}, verdicts)


class Comparing(unittest.TestCase):
    def test_what_is_near(self):
        """Also beside one stray value, which the range of a map may be."""
        random = np.random.default_rng(1)
        values = 1e-6 * random.random(1000)
        with_stray = np.append(values, 1)
        single, other, moved = values.astype(np.float32).astype(float), 1e-6 * random.random(1000), values + 1e-10
        for came, made, expected in ((values, values, reproduce.BIT), (values, single, reproduce.NEAR), (values, other, reproduce.DIFFERS),
                                     (1 + values, 1 + other, reproduce.DIFFERS),
                                     (values, moved, reproduce.DIFFERS), (values, None, reproduce.NOT_RUNNABLE),
                                     (with_stray, np.append(single, 1), reproduce.NEAR), (with_stray, np.append(other, 1), reproduce.DIFFERS)):
            found = reproduce.compare({"1": came}, {} if made is None else {"1": made})
            self.assertEqual(found["outcome"].tolist(), [expected])

    def test_maps_without_a_range_and_beyond_floating_point(self):
        came = np.array([1e308, -1e308, 0])
        self.assertEqual(reproduce.difference(came, came), 0)
        for made in (-came, np.zeros(3)):
            self.assertGreater(reproduce.difference(came, made), 0.1)
        for value, made in ((0, 1), (1, 1.5)):
            self.assertGreater(reproduce.difference(np.full(3, value), np.full(3, made)), 0.1)
        self.assertEqual(reproduce.difference(np.zeros(3), np.zeros(3)), 0)

    def test_a_card_that_is_written_again_is_the_same(self):
        text = card("A", overlap="[1, 2]") + ASKED + "trained_on: train.txt\nseeds: [1, 2]\nfiles: [a, b/c]\nreproduced_by: [somebody]\n"
        before, after = read_card(text.encode(), "card.yaml"), read_card(with_line(text.encode(), "card.yaml", "else"), "card.yaml")
        self.assertEqual(after.reproduced_by, ("somebody", "else"))
        self.assertEqual({**vars(after), "reproduced_by": 0}, {**vars(before), "reproduced_by": 0})
