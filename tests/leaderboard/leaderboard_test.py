# SPDX-License-Identifier: GPL-3.0-or-later
"""Submissions and the leaderboard that is made of them: twelve, of which five are bad in different ways, and what else may come."""

import os
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from unittest import mock

import pandas
import toy
from toy import card, everything, rewrite

from salbench import _core
from salbench.leaderboard import board, folder as sites
from salbench.leaderboard.card import Card
from salbench.leaderboard.submission import Submission
from salbench.leaderboard.texts import Manifest


def section(page, heading):
    return page.split(f">{heading}</h2>")[1].split("<h2")[0]


def spoil_last(entries, change):
    name = list(entries)[-1]
    entries[name] = change(entries[name])


class Board(toy.OverSubmissions):
    NOISES = (0, 0.5, 1, 2, 4, 8, 40)
    AT_FIRST = ("G0",)

    def test_twelve_submissions_of_which_five_are_bad(self):
        self.submissions(*(f"G{number}" for number in range(7)))
        self.toy.spoil("bad_map.zip", lambda entries: spoil_last(entries, lambda data: data[:-8] + b"\xff" * 8))
        self.toy.spoil("bad_path.zip", lambda entries: entries.update({"../evil": b"x"}))
        self.toy.spoil("bad_missing.zip", lambda entries: entries.pop("maps/6.npy"))
        self.toy.with_card("<b>bad_name.zip", card("<script>alert(1)</script>"))
        (self.toy.submissions / "bad_truncated.zip").write_bytes(self.good["G0.zip"][:len(self.good["G0.zip"]) // 2])
        first = self.rank(1, "--quiet")
        self.assertEqual(first.stderr.count("meshes of SHREC'07 are here"), 1, first.stderr)
        self.assertEqual(first.stderr.count("refused: "), 5)
        verdicts = self.toy.verdicts()
        self.assertEqual(len(verdicts), 12)
        self.assertEqual([verdicts[f"G{number}.zip"] for number in range(7)], ["ranked"] * 7)
        self.assertRegex(verdicts["bad_map.zip"], "^refused: maps/6.npy: value .* expected a finite number")
        self.assertIn('"../evil" is no part of a submission', verdicts["bad_path.zip"])
        self.assertEqual(verdicts["bad_missing.zip"], "refused: has no map of 1 of 6 items, such as 6")
        self.assertIn('refused: card.yaml: name "<script>', verdicts["<b>bad_name.zip"])
        self.assertIn("cannot be read as a ZIP archive", verdicts["bad_truncated.zip"])
        by_auc = [row["model"] for row in self.toy.table("ranking") if row["metric"] == "auc"]
        self.assertEqual(by_auc, [f"G{number}" for number in range(7)])
        site = everything(self.toy.site)
        pages = {name: data.decode() for name, data in site.items() if name.endswith(".html")}
        for name, text in pages.items():
            for bad in ("<script>alert", "<b>bad", "<i>A"):
                self.assertNotIn(bad, text, name)
        self.assertIn("&lt;b&gt;bad_name.zip", pages["index.html"])
        self.assertIn("Somebody, &lt;i&gt;A model&lt;/i&gt;, 2026", pages["models/G0.html"])
        self.assertEqual(sum(name.startswith("models/") for name in pages), 7)
        refused = section(pages["index.html"], "Refused")
        self.assertEqual((refused.count("<td>refused"), refused.count("G0.zip")), (5, 0))
        self.assertFalse((self.toy.folder / "evil").exists())
        self.rank(1)
        self.assertEqual(everything(self.toy.site), site, "byte for byte")
        done = self.toy.salbench("run", self.toy.config, "--maps", self.toy.folder / "G3", "--name", "G3", "--out", self.toy.folder / "out")
        self.assertEqual(done.returncode, 0, done.stderr)
        of_g3 = [[line for line in text.splitlines() if ",G3," in line]
                 for text in ((self.toy.folder / "out/results.csv").read_text(), site["data/results.csv"].decode())]
        self.assertEqual(*of_g3)
        self.assertEqual(len(of_g3[0]), 6)

    def test_what_else_is_refused_or_remarked(self):
        for file, text in {"twin.zip": card("G0"), "capitals.zip": card("g0"), "of_the_program.zip": card("LS")}.items():
            self.toy.with_card(file, text)
        self.toy.spoil("other_data.zip", lambda entries: entries.update(
            {"submission.yaml": entries["submission.yaml"].replace(b'\ndata: "', b'\ndata: "0')}))
        self.toy.spoil("changed_protocol.zip", lambda entries: entries.update({"configuration.yaml": entries["configuration.yaml"] + b" "}))

        self.toy.spoil("other_protocol.zip", lambda entries: rewrite(entries, "configuration.yaml", lambda text: text.replace(b": 2016", b": 2017")))

        def shorter_protocol(entries):  # what is left out has its default
            rewrite(entries, "configuration.yaml", lambda text: text.replace(b"seed: 2016\n", b""))
            entries["card.yaml"] = card("SHORTER").encode()

        self.toy.spoil("shorter_protocol.zip", shorter_protocol)

        def other_map(entries):
            entries.update({"maps/1.npy": entries["maps/1.npy"][:-8] + bytes(8), "card.yaml": card("MAP").encode()})

        def of_version_1(entries):
            """Which has no digest of its maps."""
            lines = entries["submission.yaml"].replace(b"submission 2", b"submission 1").splitlines(keepends=True)
            entries["submission.yaml"] = b"".join(line for line in lines if line.partition(b":")[0] not in (b"map_digest", b"made_by"))
            other_map(entries)

        self.toy.spoil("other_map.zip", other_map)
        self.toy.spoil("map.zip", of_version_1)
        self.toy.spoil("scores.zip", lambda entries: entries.update({"results.csv": b"made up", "card.yaml": card("LIAR").encode()}))
        self.rank(1)
        verdicts = self.toy.verdicts()
        self.assertEqual(verdicts.pop("G0.zip"), "ranked")
        for file, said in {"twin.zip": "the name G0 is taken by G0.zip", "capitals.zip": "differs from it in capitals alone",
                           "of_the_program.zip": "is the name of something else", "other_data.zip": 'other data: their digest is "0',
                           "other_map.zip": "the maps are not what submission.yaml has the digest of",
                           "changed_protocol.zip": "is not what submission.yaml has the digest of",
                           "other_protocol.zip": 'another protocol: it has "seed: 2017", the leaderboard "seed: 2016"'}.items():
            self.assertIn(said, verdicts[file], file)
        remarks = {row["model"]: row["remark"] for row in self.toy.table("submissions") if row["status"] == "ranked"}
        said = "the scores that it came with are others than those computed here"
        self.assertEqual(remarks, {"G0": "", "LIAR": said, "MAP": said, "SHORTER": said})
        ranking, refused = (section(self.toy.page(), heading) for heading in ("Ranking", "Refused"))
        self.assertEqual((ranking.count(said), refused.count(said)), (3, 0), "a map that was tampered with has other scores, too")

    def test_a_model_that_has_seen_items_stands_beside(self):
        self.submissions("G1", "G2")
        self.toy.with_card("G0.zip", card("SEEN", overlap="[2, 5]"))
        done = self.rank()
        self.assertEqual(self.toy.verdicts()["G0.zip"], "beside: it has seen 2 of 6 items, more than 10 %")
        self.assertNotIn("SEEN", {row["model"] for name in ("ranking", "leaders", "compact", "significance") for row in self.toy.table(name)
                                  if "model" in row} | {row.get("leaders") for row in self.toy.table("leaders")})
        self.assertEqual(({row["n"] for row in self.toy.table("ranking")}, {row["n"] for row in self.toy.table("overlap")}), ({"6"}, {"4"}),
                         "beside: over what it has not seen itself")
        self.assertEqual({row["model"] for row in self.toy.table("overlap")}, {"SEEN"})
        for said in ("Beside the ranking of 6 of 6 items", "SEEN 2", "beside: it has seen 2 of 6 items"):
            self.assertIn(said, self.toy.page())
        self.assertIn("6 of 6 items", done.stdout)
        self.assertEqual(self.about("Items "), {"Items ranked over": "6 of 6", "Items left out": "0, which ranked models have seen",
                                                "Items seen by models beside": "2, which cost the others nothing"})

    def about(self, begin):
        return {row["what"]: row["is"] for row in self.toy.table("about") if row["what"].startswith(begin)}

    def test_what_costs_the_others_nothing(self):
        """Ranks, tables and pages of the others are the same bytes, whatever further submissions declare or lack."""
        self.submissions("G1", "G2")
        self.rank()
        before = everything(self.toy.site)
        by_model = {"data/results.csv", "data/mean_histograms_meshes.csv"}  # with rows, or last columns, of those that have SEEN
        may_change = {"index.html", "submissions.html", "data/about.csv", "data/overlap.csv", "data/submissions.csv"}
        beside = {"SEEN0": ("2026-01-01", "[1, 2, 3, 4, 5, 6]", "6 of 6 items"), "SEEN1": ("2026-01-01", "[1]", "1 of 6 items"),
                  "SEEN2": ("2999-12-31", "[1, 1, 4]", "2 of 6 items")}
        for name, (date, overlap, _) in beside.items():
            self.toy.with_card(f"z_{name}.zip", card(name, date, overlap=overlap))
        self.expect_unchanged(before, by_model | may_change, 0)
        for name, (_, _, seen) in beside.items():
            self.assertIn(f"beside: it has seen {seen}", self.toy.verdicts()[f"z_{name}.zip"])
            (self.toy.submissions / f"z_{name}.zip").unlink()
        for name in by_model:
            kept = [line for line in (self.toy.site / name).read_bytes().splitlines() if b",SEEN" not in line or name != "data/results.csv"]
            self.assertEqual([line for line, own in zip(kept, before[name].splitlines(), strict=True) if not line.startswith(own)], [])
        self.toy.spoil("z_missing.zip", lambda entries: [entries.pop("maps/3.npy"), entries.update({"card.yaml": card("SEEN3").encode()})])
        self.toy.spoil("z_nothing.zip", lambda entries: entries.update({"maps/3.npy": b"", "card.yaml": card("SEEN4").encode()}))
        self.toy.with_card("z_name.zip", card("SEEN5", overlap="[1, 7]"))
        self.expect_unchanged(before, may_change, 1)
        for name, said in (("missing", "has no map of 1 of 6 items"), ("nothing", "maps/3.npy"), ("name", "card.yaml: test_overlap has")):
            self.assertIn(f"refused: {said}", self.toy.verdicts()[f"z_{name}.zip"])

    def expect_unchanged(self, before, but, status):
        self.rank(status)
        after = everything(self.toy.site)
        self.assertEqual([name for name in before if name not in but and after[name] != before[name]], [])

    def test_whose_overlap_counts(self):
        """A model is ranked if it has seen at most a tenth of the items, with what others have seen; they are left out for all. Else anybody could
        have the items left out on which their model is bad, by models that count as having seen some each."""
        many = {"OURS": "", "P0": "26 27 28 29", "P1": "30 31 32 33", "P2": "34 35 36 37", "FEW": "26", "LIKE": "27 28 29"}
        for n, overlaps, left_out, beside in ((20, {"A": "1"}, "1", ""), (20, {"A": "1 2"}, "1 2", ""), (20, {"A": "1 2 2 1"}, "1 2", ""),
                                              (20, {"A": "1 2 3"}, "", "A"), (20, {"A": "1 2", "B": "2 3"}, "1 2", "B"), (20, {"A": "1 2", "B": "2 1"}, "1 2", ""),
                                              (20, {"A": "1", "B": "2 3 4 5"}, "1", "B"), (20, {"A": "", "B": ""}, "", ""),
                                              (40, many, "26 27 28 29", "P1 P2")):
            with self.subTest(overlaps):
                entries = [board.Entry(Path(f"{name}.zip"), Submission(Card(name, test_overlap=tuple(seen.split()))), refused="") for name, seen in overlaps.items()]
                entries.append(board.Entry(Path("refused.zip"), Submission(Card("R", test_overlap=("9",))), refused="damaged"))
                overlap = board.Overlap.of(entries, SimpleNamespace(items=tuple(map(str, range(1, n + 1)))))
                self.assertEqual((overlap.left_out, [entry.card.name for entry in entries if entry.status == "beside"]), (set(left_out.split()), beside.split()))
                self.assertEqual(overlap.ranked_over, f"{n - len(left_out.split())} of {n}")
                self.assertEqual(len(overlap.sentences()), bool(left_out) + bool(beside))
        self.assertIn("with what others have seen, 8 of 40 items would be left out, more than 10 %", {entry.beside for entry in entries})

    def test_a_model_that_has_seen_all_and_no_other(self):
        self.toy.with_card("G0.zip", card("SEEN", overlap="[1, 2, 3, 4, 5, 6]"))
        self.rank()
        self.assertIn("no model has scores but references", self.toy.page())
        self.assertEqual((self.toy.table("ranking"), self.toy.table("overlap")), ([], []))

    def test_what_the_front_page_names(self):
        self.toy.with_card("later.zip", card("LATER", "2026-03-01", url="https://example.org/model"))
        self.toy.with_card("formula.zip", card("SUM", url="javascript:alert(1)", citation="'=1+1'"))
        self.rank()
        page, record = self.toy.page(), {row["what"]: row["is"] for row in self.toy.table("about")}
        self.assertEqual(record["Date"], "2026-03-01, of the newest submission")
        self.assertEqual((record["Unit of inference"], record["Program"], record["Protocol"]), ("mesh", f"salbench {_core.version}", "published"))
        for text in record.values():
            self.assertIn(text, page)
        self.assertIn('<a href="https://example.org/model" rel="nofollow', self.toy.page("models/LATER.html"))
        self.assertNotIn('href="javascript', self.toy.page("models/SUM.html"))
        self.assertIn("'=1+1", {row["citation"] for row in self.toy.table("submissions")})
        self.assertIn("=1+1", self.toy.page("models/SUM.html"))

    def test_a_maker_killed_at_any_rename_is_finished_by_the_next(self):
        made, site = self.toy.folder / "made", self.toy.folder / "killed"
        for name in ("data/submissions.csv", "data/ranking.csv", "index.html", "models/A.html", "static/report.css"):
            (made / name).parent.mkdir(parents=True, exist_ok=True)
            (made / name).write_text(f"salbench report {name}")
        self.addCleanup(shutil.rmtree, made)
        for at in range(10):
            for before in (None, "older"):
                shutil.rmtree(site, ignore_errors=True)
                if before:
                    sites.publish(made, site)
                    (site / "index.html").write_text(before)
                    (site / "models/GONE.html").write_text("salbench report")
                child = os.fork()
                if child == 0:
                    self.end_at(at, made, site)
                os.waitpid(child, 0)
                sites.require_own(site)
                sites.publish(made, site)
                self.assertEqual(everything(site), everything(made), (at, before))
        shutil.rmtree(site)

    @staticmethod
    def end_at(at, made, site):
        """Publishes, and ends this process before the so many-th rename or removal."""
        steps = iter(range(100))

        def counted(function):
            def call(*arguments, **others):
                if next(steps) == at:
                    os._exit(0)
                return function(*arguments, **others)
            return call

        os.replace, os.unlink = map(counted, (os.replace, os.unlink))
        sites.publish(made, site)
        os._exit(0)

    def test_folders_that_will_not_do(self):
        elsewhere, site = self.toy.folder / "elsewhere", self.toy.site
        elsewhere.mkdir()
        self.rank()
        shutil.rmtree(site / "static")
        (site / "static").symlink_to(elsewhere)
        self.assertIn(f"{site}/static", self.rank(2).stderr)
        shutil.rmtree(site)
        site.mkdir()
        (site / "thesis.txt").write_text("years of work")
        self.assertIn(str(site), self.rank(2).stderr)
        self.assertEqual([*everything(site), *everything(elsewhere)], ["thesis.txt"])
        shutil.rmtree(site)
        site.write_text("a file")
        self.assertIn(str(site), self.rank(2).stderr)
        site.unlink()
        self.assertEqual((self.toy.rank(site=self.toy.submissions).returncode, everything(self.toy.submissions)), (2, {"G0.zip": self.good["G0.zip"]}))
        (self.toy.submissions / "G0.zip").unlink()
        self.assertIn(str(self.toy.submissions), self.rank(2).stderr)
        elsewhere.rmdir()

    def test_what_others_put_into_a_site_stays(self):
        self.rank()
        before = {path.name for path in (self.toy.site / "data").iterdir()}
        (self.toy.site / "CNAME").write_text("example.org")
        (self.toy.site / "data/mine.csv").write_text("a,b\n")
        for name in ("people.csv", "constant.csv", "smoothed.csv"):  # of an earlier call, which had them; the chance of this configuration is RS alone
            (self.toy.site / "data" / name).write_text("stale")
        self.submissions("G1")
        (self.toy.submissions / "G0.zip").unlink()
        self.rank()
        self.assertEqual((self.toy.site / "CNAME").read_text(), "example.org")
        self.assertTrue((self.toy.site / "data/mine.csv").is_file())
        self.assertFalse(b"stale" in everything(self.toy.site).values())
        self.assertEqual({path.name for path in (self.toy.site / "data").iterdir()} - before, {"mine.csv"})
        self.assertEqual([path.name for path in (self.toy.site / "models").iterdir()], ["G1.html"])

    def test_a_model_that_failed_on_a_shape_is_refused(self):
        entries = [board.Entry(Path(f"{name}.zip"), refused="") for name in "AB"]
        failures = [("1", "scores.A", "overflow\nand its traceback"), ("no ground truth", "map.B", "of no matter")]
        board._refuse_failed(dict(zip("AB", entries)), failures, SimpleNamespace(points={"1": 5}))
        self.assertEqual([entry.refused for entry in entries], ["1: overflow", ""])

    def test_a_model_without_a_score_that_others_have_is_refused(self):
        entries = [board.Entry(Path(f"{name}.zip"), refused="") for name in "AB"]
        rows = [("meshes", item, "", model, 1.0) for item in "12" for model in ("A", "B", "RS")] + [("meshes", "3", "", "HS", 1.0)]
        frame = pandas.DataFrame(rows, columns=["dataset", "item", "view", "model", "cc"])
        metrics = (SimpleNamespace(name="cc"),)

        def refused():
            board._refuse_undefined(dict(zip("AB", entries)), SimpleNamespace(frame=frame, metrics=metrics))
            return [entry.refused for entry in entries]

        self.assertEqual(refused(), ["", ""])
        frame.loc[frame["item"] == "1", "cc"] = float("nan")  # of the shape, not of a map
        self.assertEqual(refused(), ["", ""])
        frame.loc[(frame["item"] == "2") & (frame["model"] == "B"), "cc"] = float("nan")
        self.assertEqual(refused(), ["", "2: its map has no cc, and those of others have"])

    def test_a_training_without_a_score_that_the_ranked_map_has_is_refused(self):
        """It would take the shape from the trainings of all."""
        def scores(value, models):
            rows = [("meshes", item, "", model, value(item, model)) for item in "12" for model in models]
            return SimpleNamespace(frame=pandas.DataFrame(rows, columns=["dataset", "item", "view", "model", "cc"]), metrics=(SimpleNamespace(name="cc"),))
        names = {"T0": ("A", "1"), "T1": ("B", "1"), "T2": ("B", "2")}
        for lacking, refused in ((set(), ["", ""]), ({("2", "T2")}, ["", "seeds/2: its map of 2 has no cc, and the one that is ranked has"]),
                                 ({("1", "T2"), ("1", "B")}, ["", ""])):
            def value(item, model):
                return float("nan") if (item, model) in lacking else 1.0
            entries = [board.Entry(Path(f"{name}.zip"), refused="") for name in "AB"]
            trainings = board.Trainings(names, SimpleNamespace(scores=scores(value, names)))
            board._refuse_trainings(dict(zip("AB", entries)), scores(value, "AB"), trainings)
            self.assertEqual([entry.refused for entry in entries], refused)
        names["T3"] = ("A", "2")  # without a row in the table of trainings
        board._refuse_trainings(dict(zip("AB", entries)), scores(value, "AB"), trainings)
        self.assertEqual([entry.refused for entry in entries], ["seeds/2: its map of 1 has no cc, and the one that is ranked has", ""])

    def test_submit_says_what_is_missing_and_writes_nothing(self):
        mine = self.toy.maps("M", 1)

        def submitted(status, said=""):
            done = self.toy.salbench("submit", mine, "--to", self.toy.submissions / "M.zip", "-c", self.toy.config)
            self.assertEqual((done.returncode, said in done.stderr, (self.toy.submissions / "M.zip").exists()), (status, True, status == 0), done.stderr)

        (mine / "3.val").unlink()
        submitted(1, "3.val")
        self.toy.maps("M", 1)
        (mine / "card.yaml").write_text("name: M\n")
        submitted(2, "card.yaml: lacks citation, licence, training_data, test_overlap")
        (mine / "card.yaml").write_text(card("M", overlap="none that we know of"))
        submitted(2, "test_overlap")
        for make in (lambda path: None, lambda path: path.write_text("x" * 70_000), os.mkfifo):
            (mine / "card.yaml").unlink(missing_ok=True)
            make(mine / "card.yaml")
            submitted(2, "card.yaml")
        (mine / "card.yaml").unlink()
        self.toy.maps("M", 1)
        submitted(0)
        data = (self.toy.submissions / "M.zip").read_bytes()
        submitted(0)
        self.assertEqual((self.toy.submissions / "M.zip").read_bytes(), data)

    def test_a_submission_takes_the_place_of_nothing_else(self):
        mine = self.toy.maps("M", 1)
        before = everything(mine)
        (self.toy.submissions / "notes.txt").write_text("notes")
        (self.toy.submissions / "empty.zip").write_text("")
        os.mkfifo(self.toy.submissions / "pipe")
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.toy.submissions)
        for to, status in ((mine / "1.val", 2), ("notes.txt", 2), ("pipe", 2), (mine, 2), (".", 2), ("notes.txt/x.zip", 3),
                           ("empty.zip", 0), ("G0.zip", 0), ("below/M.zip", 0)):
            with self.subTest(to=str(to)):
                done = self.toy.salbench("submit", mine, "--to", to, "-c", self.toy.config)
                self.assertEqual(done.returncode, status, done.stderr)
                self.assertTrue(status == 0 or Path(to).name in done.stderr, done.stderr)
        self.assertEqual(everything(mine), before)
        self.assertEqual([name for name in everything(self.toy.submissions) if "unfinished" in name], [])

    def test_names_of_files_that_are_no_lines(self):
        for name in (b"a\xff.zip", b"a\xfe.zip", b"a\nb\x1b[31m.zip"):
            (self.toy.submissions / os.fsdecode(name)).write_bytes(b"no archive")
        for words in ((), ("--format", "json")):
            done = self.toy.rank(*words)
            self.assertEqual((done.returncode, "Traceback" in done.stderr, "\x1b" in done.stdout), (1, False, False), done.stderr)
        mark = "\N{REPLACEMENT CHARACTER}"
        self.assertEqual(sorted(self.toy.verdicts()), ["G0.zip", f"a{mark}.zip", f"a{mark}b{mark}[31m.zip"])
        self.assertIn(f"a{mark}.zip", self.toy.page())

    def test_a_name_is_taken_by_the_first_file_whatever_both_are_called(self):
        entries = [board.Entry(Path(os.fsdecode(name))) for name in (b"a\xfe.zip", b"a\xff.zip")]
        read = [SimpleNamespace(card=Card(name=name), manifest=Manifest()) for name in ("MINE", "mine")]
        with mock.patch("salbench.leaderboard.submission.read", lambda file, *_: read[[entry.file for entry in entries].index(file)]):
            board.check_all(entries, None, "", ["HEIGHT"])
        self.assertEqual(entries[0].refused, "")
        self.assertIn("the name mine is taken by a\N{REPLACEMENT CHARACTER}.zip", entries[1].refused)

    def test_maps_have_values_where_nobody_looked(self):
        layout, config, file = (self.toy.folder / name for name in ("seen.py", "seen.yaml", "seen.zip"))
        layout.write_text('''from salbench.datasets import Item, match, mesh, values
def items(root):
    return [Item(one.item, [one.path, f"{root}/Distributions/{one.item}.val"]) for one in match(root, "Meshes/{item}.off")]
def read(item):
    shape = mesh(item.files[0])
    shape.ground_truth = values(item.files[1], len(shape.points))
    shape.ground_truth[:5] = float("nan")
    return shape
''')
        config.write_text(self.toy.config.read_text().replace("{scans:", f"{{layout: {layout}, scans:").replace("[auc, cc]", "[cc]"))
        done = self.toy.salbench("submit", self.toy.maps("Seen", .1), "--to", file, "-c", config)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_whatever_the_locale(self):
        """Names of files and of the people of a card are no letters of it."""
        self.toy.with_card("\N{SNOWMAN} \N{LATIN SMALL LETTER L WITH STROKE}.zip", card("OTHER", citation="Jos\u00e9 \N{SNOWMAN}"))
        words = (("--format", "json"), ())
        printed = [self.toy.rank(*more).stdout for more in reversed(words)][::-1]  # JSON has what was computed, which is nothing the second time
        site = everything(self.toy.site)
        for at, environment in enumerate(({"PYTHONUTF8": "0", "LC_ALL": "POSIX"}, *latin_1(self.toy.folder / "locales"))):
            done = self.toy.salbench("leaderboard", self.toy.submissions, "--to", self.toy.site, "-c", self.toy.config, *words[at % 2],
                                     env=os.environ | environment, encoding="utf-8")
            self.assertEqual((done.returncode, done.stdout), (0, printed[at % 2]), (environment, done.stderr))
            done = subprocess.run([sys.executable, "-P", "-m", "salbench", "--version"], env=os.environ | environment, capture_output=True)
            self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("\N{SNOWMAN}", printed[0])
        self.assertEqual(everything(self.toy.site), site)


def latin_1(folder):
    """The environment of a locale whose letters are those of Latin-1; none where the system cannot make it."""
    folder.mkdir()
    try:
        subprocess.run(["localedef", "-i", "de_DE", "-f", "ISO-8859-1", folder / "de_DE.ISO-8859-1"], check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError):
        return []
    return [{"LOCPATH": str(folder), "LC_ALL": "de_DE.ISO-8859-1"}]
