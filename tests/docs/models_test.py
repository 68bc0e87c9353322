# SPDX-License-Identifier: GPL-3.0-or-later
"""Every folder of models/ runs, without its container, and has a card and a Containerfile of the form that CONTRIBUTING.md asks for."""

import csv
import functools
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

import yaml

import pages

MODELS = sorted(path for path in (pages.ROOT / "models").iterdir() if path.is_dir())
LEARNING = [path for path in MODELS if path.name == "forest"]
FILES = ("model.yaml", "card.yaml", "Containerfile")
CARD = ("name", "citation", "licence", "training_data", "test_overlap")


def own(folder):
    """Sections of model.yaml that are commands, by name."""
    sections = yaml.safe_load((folder / "model.yaml").read_text(encoding="utf-8"))["models"]
    return {name: section for name, section in sections.items() if section and "command" in section}


def name_of(folder):
    return yaml.safe_load((folder / "card.yaml").read_text(encoding="utf-8"))["name"]


def run_line(folder):
    """The command that runs a model: the program, or what trains it."""
    place = folder.relative_to(pages.ROOT)
    if own(folder):
        return [pages.PROGRAM, "run", place / "model.yaml", "--data", "SchellingData", "--out", "out", "--quiet"]
    return ["/usr/bin/python3", place / "model.py", "SchellingData", "--folds", str(len(pages.MESHES)), "--out", "out"]


def objections(text):
    """Faults in the form of a Containerfile."""
    lines = re.sub(r"\\\n", " ", re.sub(r"^\s*#.*\n", "", text, flags=re.M)).strip().splitlines()
    instructions = [tuple(line.split(None, 1)) for line in lines if line.strip()]
    known = {"ARG", "FROM", "RUN", "COPY", "ENV", "WORKDIR", "USER", "LABEL", "ENTRYPOINT", "CMD"}
    yield from (f"unknown instruction {name[0]}" for name in instructions if name[0] not in known or len(name) < 2)
    names = [name[0] for name in instructions]
    if not names or names[0] not in ("FROM", "ARG"):
        yield "does not begin with FROM"
    for name, *rest in instructions:
        if name == "FROM" and (":" not in rest[0] or rest[0].endswith(":latest")):
            yield f"FROM {rest[0]}: name a release"
        if name == "RUN" and re.search(r"\b(curl|wget)\b", rest[0]) and "sha256sum" not in rest[0]:
            yield "fetches a file without checking its digest"
    if names.count("ENTRYPOINT") != 1:
        yield "needs one ENTRYPOINT"


@functools.cache
def rows_of(folder, threads="1"):
    """Rows of a run of the model."""
    with tempfile.TemporaryDirectory() as name:
        here = Path(name)
        environment = pages.workspace(here) | {"OMP_NUM_THREADS": threads}
        done = subprocess.run(run_line(folder), cwd=here, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        with open(here / "out/results.csv", encoding="utf-8") as file:
            return list(csv.DictReader(line for line in file if not line.startswith("#")))


class Models(unittest.TestCase):
    def test_there_are_some_with_all_files(self):
        self.assertTrue(MODELS)
        for folder in MODELS:
            for name in FILES:
                self.assertTrue((folder / name).is_file(), f"{folder.name}/{name}")

    def test_each_runs_beside_chance_and_gives_a_value_per_point(self):
        for folder in MODELS:
            for model in [name_of(folder), "RS"]:
                scored = [row for row in rows_of(folder) if row["model"] == model and row["dataset"] == "meshes" and row["nss"]]
                self.assertEqual(len(scored), len(pages.MESHES), f"{folder.name}: {model}")

    def test_one_that_learns_makes_the_same_maps_with_any_number_of_threads(self):
        for folder in LEARNING:
            self.assertEqual(rows_of(folder, "5"), rows_of(folder), folder.name)  # with the digests of the maps

    def test_one_that_learns_prints_its_means_and_none_by_splits_that_took_no_part(self):
        divided = ("from salbench.datasets import Item, match\n\n"
                   "def items(root):\n"
                   "    return [Item(one.item, [one.path], split='test' if one.item == '125' else 'train',\n"
                   "                 saliency=f'{root}/SchellingData/Distributions/{one.item}.val') for one in match(root, 'SchellingData/Meshes/{item}.off')]\n")
        for folder in LEARNING:
            with tempfile.TemporaryDirectory() as name:
                here = Path(name)
                environment = pages.workspace(here)
                (here / "own.py").write_text(divided)
                (here / "config.yaml").write_text("dataset: {layout: own.py, scans: false}\nmodels: {RS: }\nmetrics: {names: [cc]}\n")
                line = ["/usr/bin/python3", folder.relative_to(pages.ROOT) / "model.py", ".", "--config", "config.yaml", "--out", "out"]
                model = name_of(folder)
                for arguments in (["--by", "mesh", "--folds", "3"], ["--by", "split"]):  # folds of its own are not the splits of the set
                    with self.subTest(folder.name, arguments=arguments):
                        done = subprocess.run([*line, *arguments], cwd=here, env=environment, capture_output=True, text=True)
                        self.assertEqual(done.returncode, 0, done.stderr)
                        names = [re.findall(r"[A-Za-z]\w*", row) for row in done.stdout.splitlines()[1:]]
                        self.assertEqual(sorted(row for row in names if model in row or "RS" in row), sorted([["RS"], [model]]), done.stdout)
                done = subprocess.run([*line, "--by", "class"], cwd=here, env=environment, capture_output=True, text=True)
                self.assertRegex(done.stderr, r"\nmodel.py: error: .*no class")

    def test_each_has_a_card_of_the_model_and_depends_on_its_files(self):
        for folder in MODELS:
            card = yaml.safe_load((folder / "card.yaml").read_text(encoding="utf-8"))
            self.assertEqual([key for key in CARD if not str(card.get(key) or "").strip()], [], folder.name)
            self.assertTrue(card["test_overlap"] == "none" or isinstance(card["test_overlap"], list), folder.name)
            self.assertEqual([] if folder in LEARNING else [card["name"]], list(own(folder)))
            for section in own(folder).values():
                named = re.findall(r"models/[\w./-]+", section["command"])
                self.assertLessEqual(set(named), set(section["depends"]))

    def test_each_containerfile_has_the_form(self):
        for folder in MODELS:
            text = (folder / "Containerfile").read_text(encoding="utf-8")
            self.assertEqual(list(objections(text)), [], folder.name)
            for copied in re.findall(r"^COPY (\S+) ", text, flags=re.M):
                self.assertTrue((folder / copied).exists(), copied)

    def test_a_containerfile_without_the_form_is_seen(self):
        good = "FROM debian:12-slim\nRUN true\nENTRYPOINT [\"x\"]\n"
        self.assertEqual(list(objections(good)), [])
        for bad in (good.replace(":12-slim", ""), good.replace("12-slim", "latest"), good.replace("RUN", "RNU"), good.replace("ENTRYPOINT", "CMD"),
                    good.replace("true", "wget https://example.org/weights.pt"), good.partition("\n")[2]):
            self.assertEqual(len(list(objections(bad))), 1, bad)
