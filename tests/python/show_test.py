# SPDX-License-Identifier: GPL-3.0-or-later
"""A shape in the viewer: one page that needs nothing else."""

import base64
import html
import html.parser
import json
import os
import re
import unittest
import unittest.mock
import zlib

import numpy as np

import salbench
from salbench.pages import viewer_parts

POINTS = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3], [1, 1, 1]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], np.int32)
try:
    WITHOUT_THREE = not viewer_parts.three_js()
except FileNotFoundError:
    WITHOUT_THREE = True


def shape(name="52", **known):
    return salbench.Shape(name, POINTS, FACES, **known)


class Elements(html.parser.HTMLParser):
    """Tags with their attributes, and the texts of scripts and styles."""

    def __init__(self, page):
        super().__init__()
        self.tags, self.texts = [], {"script": [], "style": [], "title": []}
        self._within = None
        self.feed(page)

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        self._within = tag

    def handle_endtag(self, tag):
        self._within = None

    def handle_data(self, data):
        if self._within in self.texts:
            self.texts[self._within].append(data)


def given(page):
    """Name, description and data that the page's script gives to the viewer."""
    script = "".join(Elements(page).texts["script"])
    call = re.search(r'^salbench\.give\((".*"), (\{.*\}), "([A-Za-z0-9+/=]+)"\);$', script, re.MULTILINE)
    return json.loads(call[1]), json.loads(call[2]), zlib.decompress(base64.b64decode(call[3]))


def map_of(page, name):
    _, description, data = given(page)
    n, f = description["points"], description["faces"]
    maps = np.frombuffer(data, np.uint8, offset=6 * n + 12 * f).reshape(-1, n)
    return maps[description["maps"].index(name)].tolist()


@unittest.skipIf(WITHOUT_THREE, "three.js is not installed: libjs-three")
class Pages(unittest.TestCase):
    def test_the_page_holds_the_shape(self):
        name, description, data = given(str(shape().show(POINTS[:, 2])))
        self.assertEqual((name, description["points"], description["faces"]), ("52", 5, 4))
        axes = np.frombuffer(data, "<u2", 15).reshape(3, 5).cumsum(axis=1, dtype="<u2")
        np.testing.assert_allclose(axes.T / description["steps"] * description["edge"] + description["corner"], POINTS, atol=1e-4)
        np.testing.assert_array_equal(np.frombuffer(data, "<i4", 12, 30).cumsum().reshape(4, 3), FACES)

    def test_maps(self):
        truth = np.array([0, 1, np.nan, 4, 2])
        known = shape(ground_truth=truth, participants=(np.array([3, 3, 1], np.int32),))
        page = str(known.show([5, 5, 5, 10, 0]))
        self.assertEqual(given(page)[1]["maps"], ["Ground truth", "Values"])
        self.assertEqual(given(page)[1]["picks"], [1, 3])
        self.assertEqual(map_of(page, "Ground truth"), [0, 64, 0, 255, 128])
        self.assertEqual(map_of(page, "Values"), [128, 128, 128, 255, 0])
        self.assertEqual(given(str(shape().show({"mine": np.ones(5), "yours": POINTS[:, 0]})))[1]["maps"], ["mine", "yours"])
        self.assertEqual(given(str(shape().show()))[1]["maps"], [])

    def test_a_view_for_each_of_two_maps(self):
        def views(page):
            return sum(tag == "canvas" for tag, _ in Elements(page).tags)

        self.assertEqual(views(str(shape().show(POINTS[:, 0]))), 1)
        self.assertEqual(views(str(shape(ground_truth=POINTS[:, 1]).show(POINTS[:, 0]))), 2)

    def test_the_page_needs_nothing_else(self):
        page = str(shape().show(POINTS[:, 2]))
        elements = Elements(page)
        for tag, attributes in elements.tags:
            self.assertNotIn(tag, ("link", "img", "iframe", "object", "embed", "base"))
            self.assertFalse({"src", "href", "srcset", "action", "poster"} & set(attributes), tag)
        self.assertNotIn("@import", "".join(elements.texts["style"]))
        self.assertNotIn("url(", "".join(elements.texts["style"]))
        policy = [row["content"] for tag, row in elements.tags if row.get("http-equiv") == "Content-Security-Policy"]
        self.assertEqual(len(policy), 1)
        self.assertTrue(policy[0].startswith("default-src 'none';"))
        self.assertNotIn("http", policy[0])
        self.assertEqual(sum(tag == "script" for tag, _ in elements.tags), 6)

    def test_names_are_escaped(self):
        name = '</script><img src=x onerror="alert(1)"><!--\'&'
        known = shape(name, ground_truth=POINTS[:, 0])
        view = known.show({name: POINTS[:, 2]})
        elements = Elements(str(view))
        self.assertNotIn("img", [tag for tag, _ in elements.tags])
        self.assertEqual("".join(elements.texts["title"]), name)
        self.assertEqual((given(str(view))[0], given(str(view))[1]["maps"][1]), (name, name))
        entries = [row["data-shapes"] for tag, row in elements.tags if "data-shapes" in row]
        self.assertEqual(json.loads(entries[0])[0]["title"], name)
        frame = Elements(view._repr_html_()).tags
        self.assertEqual([tag for tag, _ in frame], ["iframe"])
        self.assertEqual(frame[0][1]["srcdoc"], str(view))

    def test_a_shape_shows_itself(self):
        known = shape(ground_truth=POINTS[:, 0])
        self.assertEqual(known._repr_html_(), known.show()._repr_html_())
        self.assertIsNone(salbench.Shape("none", np.empty((0, 3)))._repr_html_())

    def test_separate_points(self):
        grid = np.stack(np.meshgrid(np.arange(20.0), np.arange(20.0), [0.0]), -1).reshape(-1, 3)
        description = given(str(salbench.Shape("grid", grid).show(grid[:, 0])))[1]
        self.assertEqual((description["faces"], description["spacing"], description["levels"]), (0, 1, 63))
        self.assertEqual(given(str(salbench.Shape("one", grid[:1]).show()))[1]["spacing"], 0)

    def test_values_that_do_not_fit(self):
        for values in (np.ones(4), np.ones((5, 1)), 3, "abc", [[1], 2], {"mine": [1]}):
            with self.assertRaisesRegex(ValueError, "values must"):
                shape().show(values)
        with self.assertRaisesRegex(ValueError, "none has no points"):
            salbench.Shape("none", np.empty((0, 3))).show()


class WithoutThree(unittest.TestCase):
    def setUp(self):
        self.enterContext(unittest.mock.patch.dict(os.environ, XDG_DATA_DIRS="/nowhere"))

    def test_says_what_is_missing(self):
        with self.assertRaisesRegex(FileNotFoundError, "libjs-three"):
            shape().show()
        self.assertIsNone(shape()._repr_html_())
