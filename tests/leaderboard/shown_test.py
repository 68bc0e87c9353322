# SPDX-License-Identifier: GPL-3.0-or-later
"""Information on a leaderboard beside numbers: cards, their missing entries, and provenance."""

import json
import unittest
from html import unescape
from pathlib import Path
from types import SimpleNamespace

import pandas
import toy
from toy import card

from salbench.leaderboard import model_page, site
from salbench.leaderboard.card import ASKED_FOR, Card
from salbench.leaderboard.entry import BY_AUTHORS, Entry
from salbench.leaderboard.submission import Submission
from salbench.leaderboard.texts import Manifest

EVIL = "=1+1 <img src=x onerror=alert(1)> \N{RIGHT-TO-LEFT OVERRIDE}txet </script>"
TOLD = {"version": "1.2", "parameters": "1200000", "code": "https://example.org/code", "weights": "https://example.org/weights", "training_set": "closed",
        "device": "one core", "memory": "2 GB", "timed": "one map, files included", "contact": "a@example.org", "date": "2026-03-01",
        "reproduced_by": "'Somebody else, 2026: to rounding'"}
FREE = ("citation", "licence", "training_data", "url", "version", "device", "memory", "timed", "contact", "reproduced_by")  # any line


class Shown(toy.OverSubmissions):
    NOISES = (0.5, 2)

    def test_texts_of_strangers_are_text_everywhere(self):
        self.toy.with_card("evil.zip", card("EVIL", **{key: json.dumps(EVIL) for key in FREE}))
        self.toy.spoil("evil2.zip", lambda entries: entries.update({
            "card.yaml": card("EVIL2").encode(), "submission.yaml": entries["submission.yaml"] + "".join(
                f"{key}: {json.dumps(EVIL)}\n" for key in ("function", "ground_truth", "learned", "timed")).encode()}))
        self.rank()
        for path in self.toy.site.rglob("*.html"):
            text = path.read_text(encoding="utf-8")
            self.assertNotIn("<img", text, path)
            self.assertNotIn("txet </script>", text, path)
        self.assertGreaterEqual(self.toy.page("models/EVIL.html").count("&lt;img src=x onerror"), len(FREE))
        self.assertGreaterEqual(self.toy.page("models/EVIL2.html").count("&lt;img src=x onerror"), 4)
        cells = [cell for row in self.toy.table("submissions") for cell in row.values() if "img" in cell]
        self.assertEqual({cell for cell in cells if not cell.startswith("'=")}, set())
        self.assertGreaterEqual(len(cells), len(FREE) + 4)

    def test_a_card_and_what_it_leaves_out(self):
        self.toy.with_card("told.zip", card("TOLD", **TOLD))
        self.rank()
        told, untold = (unescape(self.toy.page(f"models/{name}.html")) for name in ("TOLD", "G1"))
        for text in TOLD.values():
            self.assertIn(text.strip("'"), told)
        self.assertIn('<a href="https://example.org/weights" rel="nofollow', told)
        self.assertIn("<dt>Reproduced, as it says</dt>", told)
        self.assertNotIn("not said", told.replace("not said: salbench submit writes them", ""))
        for why in ASKED_FOR.values():
            self.assertIn(f"not said: {why}", untold)
        row = next(row for row in self.toy.table("submissions") if row["model"] == "TOLD")
        self.assertEqual({key: row[key] for key in TOLD}, {key: text.strip("'") for key, text in TOLD.items()})

    def test_how_numbers_came_about_and_what_menus_choose(self):
        self.toy.with_card("open.zip", card("OPEN", weights="https://example.org/w"))
        self.toy.with_card("shut.zip", card("SHUT", weights="closed", overlap="[2, 5]"))
        self.rank()
        table = self.toy.page().split("<tbody>")[1].split("</tbody>")[0]
        rows = {row.split('scope="row"')[1].split(">")[1 if ">RS<" in row else 2].split("<")[0].strip(): row for row in table.split("<tr>")[1:]}
        chosen = {model: [cell.split(">")[1].split("<")[0].strip() for cell in row.split("<td")[-3:]] for model, row in rows.items()}
        self.assertEqual(chosen["OPEN"], ["yes", "no", BY_AUTHORS])
        self.assertEqual(chosen["SHUT"], ["no", "yes", BY_AUTHORS])
        self.assertEqual(chosen["G1"], ["not said", "no", BY_AUTHORS])
        self.assertIn("measured here", table)
        self.assertRegex(self.toy.page(), r">AUC</abbr> rank<", "which says of what it is")
        self.assertIn("2 items", rows["SHUT"])
        own = self.toy.page("models/OPEN.html").split('id="table-scores"')[1].split("</table>")[0].split("<tbody>")[1]
        self.assertEqual(own.count("<tr"), len([row for row in self.toy.table("compact") if row["model"] == "OPEN"]))
        self.assertIn("those among all models, whatever the menus leave in sight", self.toy.page())
        menus = [part.split("<")[0].strip() for part in self.toy.page().split("<label>")[1:]]
        self.assertEqual(menus[:2], ["Open weights", "Trained on this set"])
        self.assertNotIn("seconds", self.toy.page().partition("<table")[2].partition("</table>")[0].lower(), "cost is no column of a ranking")


class OfPages(unittest.TestCase):
    def test_a_model_without_a_rank(self):
        self.assertEqual([site.rank_cell({"rank": rank}).text for rank in (pandas.NA, 2)], ["", "2"])

    def test_the_spread_over_trainings_is_not_the_interval_over_shapes(self):
        frame = pandas.DataFrame([("meshes", "auc", "NET", seed, 6, mean) for seed, mean in (("", 0.5), ("1", 0.6), ("2", 0.7))]
                                 + [("meshes", "auc", "OTHER", "1", 6, 0.1)], columns=["dataset", "metric", "model", "seed", "n", "mean"])
        [table] = model_page.trainings(SimpleNamespace(tables={"seeds": frame}), "NET", [site.METRIC, site.DATA_SET])
        self.assertEqual([[cell.text for cell in row] for row in table.rows], [["AUC", "Meshes", "3", "0.600", "0.100", "0.500", "0.700"]])
        self.assertIn("(the one that is ranked, 1, 2)", table.caption)
        self.assertIn("the spread over trainings, not the interval over shapes", table.caption)
        for tables in ({}, {"seeds": frame[frame["model"] == "OTHER"]}):
            self.assertEqual(model_page.trainings(SimpleNamespace(tables=tables), "NET", []), [])

    def test_cost_is_said_with_what_was_timed(self):
        entry = Entry(Path("a.zip"), Submission(Card("A", device="one core", timed="with files"), Manifest(seconds=("0.12", "0.3"), timed="the function")), refused="")
        facts = {fact.term: fact.text for fact in model_page.cost(entry)[0].rows}
        self.assertEqual(facts, {"Seconds per shape": "median 0.12, 95th percentile 0.3", "What was timed": "the function; with files", "Device": "one core",
                                 "Peak memory": f"not said: {ASKED_FOR['memory']}"})
        self.assertIn("no ranking has it", model_page.cost(entry)[1].text)

    def test_distances_are_drawn_behind_the_best_whichever_way_is_better(self):
        for metric, better, means in (("auc", "higher", (2.0, 1.0)), ("kl", "lower", (1.0, 2.0))):
            rows = [("meshes", metric, model, mean) for model, mean in zip("AB", means)]
            difference = means[1] - means[0]
            tables = {"ranking": pandas.DataFrame(rows, columns=["dataset", "metric", "model", "mean"]),
                      "compact": pandas.DataFrame([*rows, ("meshes", metric, "RS", means[1] + difference)], columns=["dataset", "metric", "model", "mean"]),
                      "metrics": pandas.DataFrame([(metric, better)], columns=["metric", "better"]),
                      "significance": pandas.DataFrame([("meshes", metric, "B", "A", difference, difference - .5, difference + .5)],
                                                       columns=["dataset", "metric", "model_a", "model_b", "mean_difference", "joint95_low", "joint95_high"])}
            drawings = site.drawings_of(SimpleNamespace(tables=tables, leaders=[]))["meshes", "", metric]
            self.assertEqual({model: drawings[model].dot.between for model in "AB"}, {"A": "best mean", "B": "1.000 behind, 0.500 to 1.500"})
            self.assertLess(drawings["B"].dot.low, drawings["B"].dot.at)
            self.assertLess(drawings["B"].dot.high, drawings["A"].dot.at)
            self.assertEqual([(name, at < drawings["B"].dot.low) for name, at, _ in drawings["A"].axis.lines], [("chance", True)])
