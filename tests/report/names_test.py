# SPDX-License-Identifier: GPL-3.0-or-later
"""Whatever items and models are called, their files are apart, on macOS and Windows too."""

import html
import itertools
import re
import unittest
import urllib.parse

from markupsafe import escape

import fixture
import support
from salbench.pages.looks import looks_of
from salbench.report.names import file_name, file_names, natural, short

ALIKE = ["case", "Case", "CASE"]
ODD = ["con", "CON", "Con.obj", "lpt1", "aux ", "nul.", "com1.", "dot.", "dots..", "space ", ".hidden", "a:b", "a/b", "a\\b", "line\nbreak",
       "tab\t", "..", ".", "+", "+2b+", "~", "", "a+20+b", "é", "E\u0301", "\u212a", "ß", "\ud800", "²", "x" * 250, "X" * 250, "形" * 60,
       "形" * 61]
RESERVED = {"con", "prn", "aux", "nul", *(f"{port}{digit}" for port in ("com", "lpt") for digit in range(10))}


class FileNames(unittest.TestCase):
    def expect_apart_everywhere(self, names):
        """names: name -> file name."""
        folded = [name.casefold() for name in names.values()]
        self.assertEqual(len(set(folded)), len(names), names)
        for name in names.values():
            self.assertRegex(name, r"^[A-Za-z0-9._+~-]+$")
            self.assertNotIn(name.lower().split(".")[0], RESERVED)
            self.assertFalse(name.startswith(".") or name.endswith("."), name)
            self.assertLessEqual(len(name), 200)

    def test_of_odd_names_are_apart(self):
        self.expect_apart_everywhere(file_names(ALIKE + ODD))

    def test_of_all_short_names_are_apart(self):
        names = ["".join(letters) for n in (1, 2, 3, 4) for letters in itertools.product("aA4+1.", repeat=n)]
        self.expect_apart_everywhere(file_names(names))

    def test_do_not_depend_on_the_order(self):
        names = ALIKE + ODD
        self.assertEqual(file_names(names), file_names(reversed(names)))
        self.assertEqual(file_names(ALIKE), {"case": "case", "Case": "+43+ase", "CASE": "+43++41++53++45+"})

    def test_are_as_they_were_where_nothing_is_alike(self):
        for name, known in (("52", "52"), ("52_3", "52_3"), ("LS", "LS"), ("Armadillo.v2", "Armadillo.v2"), ("a b", "a+20+b"),
                            (".x", "+2e+x"), ("ground truth", "ground+20+truth"), ("console", "console"), ("x" * 200, "x" * 200)):
            self.assertEqual(file_names([name, "other"])[name], known)
            self.assertEqual(file_name(name), known)

    def test_any_name_has_its_place_in_the_order(self):
        self.assertEqual(sorted(["10", "9", "²", "x2"], key=natural), ["9", "10", "x2", "²"])


class ShortNames(unittest.TestCase):
    def test_are_cut_and_apart(self):
        for names, known in ((["LS", "PN-without-transform-net-and-normals"], ["LS", "PN-without-t…and-normals"]),
                             (["PointTransformer-small-finetuned_fold1", "PointTransformer-large-finetuned_fold1"],
                              ["…small-finetuned_fold1", "…large-finetuned_fold1"]),
                             (["A" * 40, "A" * 41], [f"…{'A' * 12}", f"…{'A' * 13}"])):
            self.assertEqual(list(short(names).values()), known)


class Files(support.ReportTest):
    def test_of_a_report_are_apart_and_each_link_leads_to_its_own(self):
        names = [name for name in ALIKE + ODD if "\ud800" not in name and name not in ("", ".", "..")] + ["../up", "NA", 'a <b>&"\'c d']
        category = '<i>&"class\''
        items = [(name, category) for name in names]
        models = ("LS", "ls", "RS", '<script>alert("1")</script>')
        out = self.folder / "out"
        fixture.write_results(out, items, models, results=fixture.results_table(items, models, views=1))
        fixture.write_export(out / "shapes.h5", items[:8], models, views=1, size=16)
        to = self.report("out")
        paths = [path.relative_to(to) for path in to.rglob("*")]
        folded = [str(path).casefold() for path in paths]
        self.assertEqual(len(set(folded)), len(paths))
        for part in {part for path in paths for part in path.parts}:
            self.assertRegex(part, r"^[A-Za-z0-9._+~-]{1,255}$")
            self.assertNotIn(part.casefold().split(".")[0], RESERVED)
            self.assertFalse(part.endswith("."), part)
        for path in to.rglob("*.html"):
            text = path.read_text(encoding="utf-8")
            for markup in ("<script>alert", "<i>&", "<b>&"):
                self.assertNotIn(markup, text, path)
            for link in re.findall(r'(?:href|src)="([^"#:]+)"', text):
                self.assertTrue((path.parent / urllib.parse.unquote(html.unescape(link))).is_file(), f"{path}: {link}")
        links = dict(re.findall(r'<a href="(shapes/[^"]*)">([^<]*)</a>', support.page(to, "scores.html").split('class="links"')[1]))
        self.assertEqual(sorted(html.unescape(name) for name in links.values()), sorted(names))
        for link, name in links.items():
            self.assertIn(f"<h1>Mesh {name}, {escape(category)}</h1>", support.page(to, link))
        shown = re.findall(r"<h4>Mesh (.*?)</h4>", support.page(to, "paper.html"))
        self.assertLessEqual(set(map(html.unescape, shown)), set(names))
        self.assertNotEqual("".join(shown).lower(), "".join(shown))
        pictures = {path.parent.name for path in to.glob("pictures/*/*-ls-after-*.webp")}
        self.assertEqual(len(pictures), 8)
        for folder in pictures:
            ours, theirs = (support.drawn(to, f"pictures/{folder}/mesh-{model}-after.webp") for model in ("+4c++53+", "ls"))
            self.assertNotEqual(ours.read_bytes(), theirs.read_bytes())


class Looks(unittest.TestCase):
    MODELS = [*fixture.MODELS, *(f"own {number}" for number in range(20))]

    @staticmethod
    def luminance(colour):
        parts = [int(colour[at:at + 2], 16) / 255 for at in (1, 3, 5)]
        linear = [part / 12.92 if part <= 0.03928 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    def test_every_colour_has_a_contrast_of_3_to_1_on_white(self):
        for model, look in looks_of(["GS", *self.MODELS]).items():
            self.assertGreaterEqual(1.05 / (self.luminance(look.colour) + 0.05), 3, model)

    def test_no_two_models_look_alike_and_built_in_ones_differ_without_colour(self):
        looks = looks_of(self.MODELS)
        self.assertEqual(len(set(looks.values())), len(self.MODELS))
        self.assertEqual(len({looks[model].marker for model in fixture.MODELS}), len(fixture.MODELS))
        self.assertEqual(len({looks[model].dash for model in fixture.MODELS}), len(fixture.MODELS))
