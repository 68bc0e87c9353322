# SPDX-License-Identifier: GPL-3.0-or-later
"""Shared by tests of the report: a report made in a temporary folder, and its pages as text and tables."""

import contextlib
import functools
import html
import io
import re
import tempfile
import unittest
import unittest.mock
import warnings
from pathlib import Path

import jinja2
import matplotlib.font_manager  # noqa: F401  or each report would look for fonts, in a folder of its own

import fixture
from salbench import __main__
from salbench.report import elements
from tests.support.without_figures import without_drawing, without_figures  # noqa: F401


class Compiled(jinja2.BytecodeCache):
    """Templates are compiled once, not for each report."""
    codes = {}

    def load_bytecode(self, bucket):
        if bucket.key in self.codes:
            bucket.bytecode_from_string(self.codes[bucket.key])

    def dump_bytecode(self, bucket):
        self.codes[bucket.key] = bucket.bytecode_to_string()


def make(out, to, *arguments):
    """Runs `salbench report` in this process; its exit status and what it wrote to the error stream."""
    errors = io.StringIO()
    environment = functools.partial(jinja2.Environment, bytecode_cache=Compiled())
    with (warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(errors),
          unittest.mock.patch("salbench.pages.rendering.Environment", environment),
          unittest.mock.patch("os.fsync")):  # no test waits for a disk
        # A test may have had a run in its process, whose threads may be there yet; for users, a report has a process of its own.
        warnings.filterwarnings("ignore", "This process .* is multi-threaded, use of fork", DeprecationWarning)
        status = __main__.main(["report", str(out), "--quiet", "--to", str(to), *map(str, arguments)])
    return status, errors.getvalue()


def drawn(folder, path):
    """The file of a report whose name has a digest: "pictures/1/mesh-LS-after.webp"."""
    stem, _, extension = path.rpartition(".")
    (found,) = Path(folder).glob(f"{stem}-{'[0-9a-f]' * 16}.{extension}")
    return found


def page(folder, path=None):
    """The text of a page; of the first one and all with figures and tables of scores, one after the other, if none is named."""
    if path is not None:
        return (Path(folder) / path).read_text(encoding="utf-8")
    paths = dict.fromkeys(["index.html", *(element.page for element in elements.ELEMENTS if element.page != "run.html")])
    return "".join(page(folder, path) for path in paths if (Path(folder) / path).is_file())


def section(text, identifier):
    """The part of a page with an id, up to the next section."""
    start = text.index(f'<section id="{identifier}"')
    return text[start:text.find("</section>", start)]


def rows(text, identifier):
    """The rows of a table as lists of cell texts."""
    start = text.index(f'id="table-{identifier}"')
    body = text[text.index("<tbody>", start):text.index("</tbody>", start)]
    found = []
    for row in re.findall(r"<tr[^>]*>(.*?)</tr>", body, flags=re.S):
        cells = re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row, flags=re.S)
        found.append([html.unescape(re.sub(r"<[^>]*>", " ", re.sub("</?abbr[^>]*>", "", cell))).strip() for cell in cells])
    return found


def bold(text, identifier):
    """The rows of a table as lists of cell texts, with lists of whether each is bold."""
    start = text.index(f'id="table-{identifier}"')
    lines = re.findall(r"<tr[^>]*>(.*?)</tr>", text[text.index("<tbody>", start):text.index("</tbody>", start)], flags=re.S)
    return list(zip(rows(text, identifier),
                    (["<strong>" in cell for cell in re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", line, flags=re.S)]
                     for line in lines)))


class ReportTest(unittest.TestCase):
    """A temporary folder per class; `report()` makes a report in it, without figures where a class does not say otherwise."""

    figures = staticmethod(without_figures)

    @classmethod
    def setUpClass(cls):
        cls.folder = Path(cls.enterClassContext(tempfile.TemporaryDirectory()))

    @classmethod
    def report(cls, name, *arguments, out=None):
        to = cls.folder / f"{name}-report"
        with cls.figures():
            status, errors = make(out or cls.folder / name, to, *arguments)
        assert status == 0, errors
        return to


def make_full(folder, meshes=6):
    """A results folder with everything: tables, an export of some meshes with pictures; of six, the
    lowest-scoring ones are among them. Returns its path."""
    out = Path(folder) / "full"
    fixture.write_results(out, fixture.eight_meshes(), extra='peak_memory_mb: 512\ncache_bytes: {mesh: 1000000, fpfh: 9000000}\n')
    fixture.write_costs(out)
    fixture.write_export(out / "shapes.h5", fixture.eight_meshes()[:meshes], views=3, size=64)
    return out
