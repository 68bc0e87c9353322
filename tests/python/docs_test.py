# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs code on the pages that tests/docs does not: expressions in tables and lines, and the notebook, with a small data set in the form of the
Schelling study.
"""

import contextlib
import io
import os
import pathlib
import re
import sys
import tempfile
import unittest
from unittest import mock

import numpy as np

import toy
from tests.support import toy_data

DOCS = toy.ROOT / "docs"
TORCH = """import numpy as np

class Tensor(np.ndarray):
    def softmax(self, axis):
        return np.exp(self) / np.exp(self).sum(axis)
    def numpy(self):
        return np.asarray(self)

def tensor(values):
    return np.asarray(values).view(Tensor)

def manual_seed(seed):
    np.random.seed(seed)

class no_grad:
    def __enter__(self): pass
    def __exit__(self, *_): pass

class nn:
    class Linear:
        def __init__(self, many, few):
            self.weights = np.random.normal(size=(many, few))
        def __call__(self, x):
            return x @ self.weights
    class ReLU:
        def __call__(self, x):
            return x.clip(0)
    class Sequential:
        def __init__(self, *layers):
            self.layers = layers
        def __call__(self, x):
            for layer in self.layers:
                x = layer(x)
            return x
"""  # as much of PyTorch as the page names


class Docs(unittest.TestCase):
    def setUp(self):
        folder = self.enterContext(tempfile.TemporaryDirectory())
        # The first mesh has no ground truth, as most of the published set have none.
        toy_data.study(pathlib.Path(folder, "SchellingData"), (1, 2, 3, 4), participants=2, without_truth=(1,))
        self.enterContext(contextlib.chdir(folder))

    def executed(self, source, name):
        """The names that it leaves. Functions need a file that inspect finds their source in."""
        path = pathlib.Path(name)
        path.write_text(source)
        names = {"__name__": "docs"}
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            exec(compile(source, str(path.resolve()), "exec"), names)  # noqa: S102: our own text
        return names, printed.getvalue()

    def test_text_of_an_export_compares_as_the_dictionary_says(self):
        import h5py

        config = pathlib.Path("config.yaml")
        config.write_text("dataset: {scans: false}\nmodels: {LS: {}, RS: {}}\n")
        toy.run(config, "--data", "SchellingData", "--items", "2", "--cache", "c", "--out", "o")
        toy.export(config, "--data", "SchellingData", "--items", "2", "--cache", "c", "--to", "all.h5")
        expression = re.search(r"`(numpy\.char\.decode\([^`]+)`", (DOCS / "data_dictionary.md").read_text())[1]
        with h5py.File("all.h5") as file:
            self.assertEqual(eval(expression, {"numpy": np, "file": file}).tolist(), [True, False])  # noqa: S307

    def test_the_table_of_equivalents_gives_equal_numbers(self):
        import salbench  # noqa: F401: of the expressions
        import scipy.stats
        import sklearn.metrics

        rng = np.random.default_rng(2)
        names = {"np": np, "scipy": scipy, "sklearn": sklearn, "salbench": salbench, "map": rng.random(50),
                 "saliency": rng.random(50), "picks": rng.choice(50, 8, replace=False)}
        names["map"] = (names["map"] - names["map"].min()) / np.ptp(names["map"])
        names["is_picked"] = np.isin(np.arange(50), names["picks"])
        rows = re.findall(r"^\| `([^`]+)` \| `([^`]+)`", (DOCS / "bring_your_model.md").read_text(), flags=re.M)
        compared = 0
        for theirs, ours in rows:
            if "map" not in theirs or "Model" in theirs:
                continue
            self.assertAlmostEqual(eval(theirs, names), eval(ours, names), places=9, msg=theirs)  # noqa: S307
            compared += 1
        self.assertEqual(compared, 6)

    def test_the_network_is_kept(self):
        """Runs the page's PyTorch example with a substitute: closures over a network are stored and loaded."""
        import salbench

        pathlib.Path("torch.py").write_text(TORCH)
        text = re.search(r"```text\n(def fit\(shapes\):\n.*?)```", (DOCS / "bring_your_model.md").read_text(), re.S)[1]
        with mock.patch.object(sys, "path", [os.getcwd(), *sys.path]):
            self.addCleanup(sys.modules.pop, "torch", None)
            names, _ = self.executed("import torch\n" + text, "network.py")
            model = salbench.Model(names["fit"], reads=["fpfh"])
            runs = [salbench.cross_validate(model, "SchellingData", {"dataset": {"scans": False}}, folds=3, by="mesh", models={}, keep="kept",
                                            cache=f"cache{number}", out=f"out{number}", progress=False) for number in range(2)]
        self.assertEqual([run.models["MINE"]["trained"] for run in runs], [3, 0])
        self.assertEqual([run.failures for run in runs], [[], []])
        self.assertTrue(runs[0].scores.equals(runs[1].scores))

    def test_the_notebook(self):
        names, _ = self.executed((DOCS / "paper_table.py").read_text(), "paper_table.py")
        self.assertEqual(set(names["table"].index), {"CENTRE", "LS", "CS", "PS", "MS", "RS"})
        self.assertEqual(names["results"].failures, [])
