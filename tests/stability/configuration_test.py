# SPDX-License-Identifier: GPL-3.0-or-later
"""A configuration means what it meant: complete.yaml is what `salbench config meshes.yaml` printed."""


import yaml

import support


def differences(old, today, path=""):
    """Keys of the old one that today's lacks or has another value of. New keys are no difference."""
    if isinstance(old, dict) and isinstance(today, dict):
        return [found for key, value in old.items() for found in differences(value, today.get(key, "no such key"), f"{path}.{key}")]
    return [] if old == today else [f"{path[1:]}: {old} -> {today}"]


class Configuration(support.OldExamples):
    def test_of_few_keys_and_the_complete_one_are_what_they_were(self):
        old = yaml.safe_load((support.EXAMPLES / "complete.yaml").read_text(encoding="utf-8"))
        for name in ("meshes.yaml", "complete.yaml"):
            with self.subTest(name):
                self.assertEqual(differences(old, yaml.safe_load(self.said(f"config {name}"))), [])

    def test_the_complete_one_is_the_same_run(self):
        self.assertEqual(self.said("plan complete.yaml"), self.said("plan meshes.yaml"))

    def test_a_difference_is_seen(self):
        self.assertEqual(differences({"a": {"b": 1, "c": [2]}, "d": 3}, {"a": {"b": 1, "c": [], "new": 5}}),
                         ["a.c: [2] -> []", "d: 3 -> no such key"])
