# SPDX-License-Identifier: GPL-3.0-or-later
"""Trained models are stored as users write them: closures, lambdas, classes of scripts, networks; and a file lists the packages that it needs."""

import pickle
import subprocess
import sys
import threading

import numpy as np

import toy
from salbench.runs.kept import Kept, packages_in, pickled


class Network:
    """As a network of PyTorch: it holds what cannot be pickled, and gives its weights away."""

    def __init__(self):
        self.weights, self.training, self.lock = np.zeros(3), True, threading.Lock()

    def state_dict(self):
        return {"weights": self.weights}

    def load_state_dict(self, state):
        self.weights = state["weights"]

    def train(self, mode):
        self.training = mode


class OfSize(Network):
    def __init__(self, size):
        super().__init__()
        self.weights = np.zeros(size)


def predicting(network):
    return lambda shape: network.weights * shape


class Keeping(toy.InAFolder):
    def test_a_network_is_stored_by_its_state(self):
        network = Network()
        network.weights, network.training = np.array([1., 2, 3]), False
        loaded = pickle.loads(pickled(predicting(network)))
        self.assertEqual(loaded(2).tolist(), [2, 4, 6])
        self.assertFalse(loaded.__closure__[0].cell_contents.training)

    def test_a_class_that_needs_arguments_is_not(self):
        with self.assertRaisesRegex(TypeError, "cannot pickle '_thread.lock' object"):
            pickled(predicting(OfSize(3)))

    def test_elsewhere_the_users_modules_are_not_there(self):
        (self.folder / "mine.py").write_text("import numpy\nclass Height:\n    def __call__(self, shape):\n        return scale(shape)\n"
                                             "def scale(shape):\n    return numpy.asarray(shape) * 2\n")
        write = f"import sys; sys.path.insert(0, {str(self.folder)!r})\nimport mine\nfrom salbench.runs.kept import pickled\n" \
                "sys.stdout.buffer.write(pickled(mine.Height()))"
        data = subprocess.run([sys.executable, "-B", "-c", write], capture_output=True, check=True).stdout
        self.assertEqual(pickle.loads(data)([1, 2]).tolist(), [2, 4])
        self.assertIn(f"numpy=={np.__version__}", packages_in(data))
        self.assertFalse([name for name in packages_in(data) if "mine" in name or "salbench" in name])

    def test_a_file_has_the_seconds_of_its_training_beside_it(self):
        kept = Kept(self.folder / "kept", ["a"])
        self.assertEqual((kept.load(0), kept.seconds(0)), (None, None))
        kept.store(0, len, 2.5)
        self.assertEqual((kept.load(0), kept.seconds(0)), (len, 2.5))
        for damaged in (b"", b"two"):
            (self.folder / "kept/a.seconds").write_bytes(damaged)
            self.assertEqual((kept.load(0), kept.seconds(0)), (len, None))
