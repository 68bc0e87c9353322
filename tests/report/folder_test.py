# SPDX-License-Identifier: GPL-3.0-or-later
"""A report that is written again leaves nothing of the one before, and nothing of the user's is removed."""

import contextlib
import errno
import io
import os
import resource
import shutil
import subprocess
import sys
import unittest
import unittest.mock

import fixture
import support
from salbench import __main__
from salbench.report.folder import LIST
from tests.support import forked

ITEMS = fixture.eight_meshes()[:3]
OWN = {"notes.html": "my own notes", "data/notes.txt": "more", "figures/mine/plot.svg": "<svg/>", "thesis.tex": "years of work"}


def write_auc(out, models):
    """Results of the third mesh and a scan of it, by one metric."""
    table = fixture.with_metrics(fixture.results_table(ITEMS[2:], models, views=1), ["auc"])
    fixture.write_results(out, ITEMS[2:], models, results=table, extra=fixture.metric_lines(["auc"]))


def files_of(folder):
    """Path within the folder -> content."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


class WrittenAgain(support.ReportTest):
    @classmethod
    def setUpClass(cls):
        """A rich run, and a poor one of the same name, to be reported in the same place."""
        super().setUpClass()
        models, metrics = fixture.MODELS[:3], ("auc", "nss", "lcc", "kl")
        table = fixture.with_metrics(fixture.results_table(ITEMS, models, views=1), metrics)
        cls.rich = cls.folder / "rich" / "out"
        fixture.write_results(cls.rich, ITEMS, models, results=table, extra=fixture.metric_lines(metrics))
        fixture.write_export(cls.rich / "shapes.h5", ITEMS[:2], models, views=1, size=32)
        cls.poor = cls.folder / "poor" / "out"
        write_auc(cls.poor, models[:2])
        cls.fresh = cls.made(cls, cls.poor, "fresh")

    def made(self, out, name, *arguments):
        with support.without_figures():
            status, errors = support.make(out, self.folder / name, *arguments)
        assert status == 0, errors
        return files_of(self.folder / name)

    def add_own(self, name):
        for path, text in OWN.items():
            (self.folder / name / path).parent.mkdir(parents=True, exist_ok=True)
            (self.folder / name / path).write_text(text)

    def expect_fresh_and_own(self, name):
        files = files_of(self.folder / name)
        self.assertEqual({path: files.pop(path, b"").decode() for path in OWN}, OWN)
        self.assertEqual(sorted(files), sorted(self.fresh))
        self.assertEqual([path for path in files if files[path] != self.fresh[path]], [])

    def test_what_only_the_call_before_wrote_is_gone(self):
        before = self.made(self.rich, "again")
        self.assertTrue({"metrics.html", "shapes/1.html"} <= set(before))
        self.assertEqual(sorted(before[LIST].decode().splitlines() + [LIST]), sorted(before))
        self.add_own("again")
        self.made(self.poor, "again")
        self.expect_fresh_and_own("again")
        self.assertFalse((self.folder / "again/pictures/1").exists())

    def interrupted(self, name):
        """Makes the rich report to the point where its first page begins."""
        with support.without_figures(), unittest.mock.patch("salbench.report.front.sentences", side_effect=KeyboardInterrupt):
            status, errors = support.make(self.rich, self.folder / name)
        self.assertEqual(status, 130)
        self.assertIn(f"salbench report {self.rich} --quiet --to {self.folder / name}\n", errors)
        return files_of(self.folder / name)

    def test_a_call_that_was_ended_leaves_the_report_before(self):
        """Its drawings are kept beside the report, and the next call removes those that it does not use."""
        before = self.made(self.poor, "ended")
        files = self.interrupted("ended")
        self.assertEqual({path: files[path] for path in before if path != LIST}, {path: data for path, data in before.items() if path != LIST})
        self.assertEqual({path.partition("/")[0] for path in files if path not in before}, {"pictures", "shapes"})
        self.assertEqual(self.made(self.poor, "ended"), self.fresh)

    def test_what_a_call_that_was_ended_has_drawn_is_kept(self):
        files = self.interrupted("begun")
        self.assertIn("This report is not finished", files["index.html"].decode())
        drawn = {path: data for path, data in files.items() if path not in (LIST, "index.html")}
        self.assertTrue(drawn)
        with unittest.mock.patch("salbench.report.shape_files.draw", side_effect=AssertionError):
            self.assertLessEqual(drawn.items(), self.made(self.rich, "begun").items())

    def test_a_call_that_was_killed_leaves_nothing_that_stays(self):
        """At a rename; shutil.rmtree would be the last that the process does."""
        for at in (0, 20):
            replaced = unittest.mock.Mock(side_effect=[*[unittest.mock.DEFAULT] * at, KeyboardInterrupt], wraps=os.replace)
            with support.without_figures(), unittest.mock.patch("os.replace", replaced), unittest.mock.patch("shutil.rmtree"):
                self.assertEqual(support.make(self.rich, self.folder / f"killed-{at}")[0], 130)
            self.made(self.poor, f"killed-{at}")
            self.assertEqual(files_of(self.folder / f"killed-{at}"), self.fresh)

    def test_a_list_that_names_other_files(self):
        precious = self.folder / "precious"
        precious.write_text("years of work")
        self.made(self.poor, "spoilt")
        (self.folder / "spoilt" / LIST).write_text(f"../precious\n{precious}\ndata\n\n.\n\0\n")
        shutil.rmtree(self.folder / "spoilt/shapes")
        self.made(self.poor, "spoilt")
        self.assertEqual(precious.read_text(), "years of work")
        self.assertEqual(sorted(files_of(self.folder / "spoilt")), sorted(self.fresh))


TWO_FIGURES = """from salbench.report.report import Report
draw_figures = Report.draw_figures
def draw_two(report):
    del report.waiting[2:]
    draw_figures(report)
Report.draw_figures = draw_two
"""

FILES = (LIST, "run.html", "static/report.css", "shapes/3.html")  # that a stranger may have made links, and pipes


class OfAStranger(support.ReportTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.out = cls.folder / "out"
        write_auc(cls.out, ("LS",))
        fixture.write_export(cls.out / "shapes.h5", ITEMS[2:], ("LS",), views=1, size=32)
        with support.without_figures():
            assert support.make(cls.out, cls.folder / "fresh") == (0, "")
        cls.fresh = files_of(cls.folder / "fresh")

    def setUp(self):
        self.theirs = self.folder / "theirs"
        self.theirs.mkdir()
        (self.theirs / "years").write_text("of work")
        self.to = self.out / "report"
        shutil.copytree(self.folder / "fresh", self.to)

    def tearDown(self):
        self.assertEqual(files_of(self.theirs), {"years": b"of work"}, "nothing was written or removed")
        shutil.rmtree(self.theirs)
        self.to.unlink() if self.to.is_symlink() else shutil.rmtree(self.to)

    def made(self, *arguments):
        with support.without_figures(), contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()) as errors:
            return __main__.main(["report", str(self.out), "--quiet", *map(str, arguments)]), errors.getvalue()

    def test_a_link_in_place_of_a_folder_is_named(self):
        for name in ("data", "pictures/3"):
            path = self.to / name
            path.rename(self.to / "before")
            path.symlink_to(self.theirs)
            with self.subTest(name):
                status, errors = self.made()
                self.assertEqual((status, errors.count("\n")), (2, 1), errors)
                self.assertIn(f"error: {path}: ", errors)
            path.unlink()
            (self.to / "before").rename(path)
        (self.to / LIST).write_text("pictures/link/years\n")
        (self.to / "pictures/link").symlink_to(self.theirs)
        self.assertEqual(self.made()[0], 2)

    def test_the_site_of_a_leaderboard(self):
        (self.to / "data").mkdir(exist_ok=True)
        (self.to / "data/submissions.csv").write_text("file,model\n")
        (self.to / LIST).unlink()
        before = files_of(self.to)
        status, errors = self.made()
        self.assertEqual((status, files_of(self.to), str(self.to) in errors), (2, before, True), errors)

    def test_a_report_that_is_a_link(self):
        shutil.rmtree(self.to)
        (self.folder / "elsewhere").mkdir()
        self.to.symlink_to(self.folder / "elsewhere")
        self.assertEqual(self.made(), (0, ""))
        self.assertEqual(files_of(self.folder / "elsewhere"), self.fresh)

    def test_what_stands_in_place_of_a_file_is_replaced(self):
        for what, make in (("a link", lambda path: path.symlink_to(self.theirs / "years")), ("a pipe", os.mkfifo)):
            with self.subTest(what):
                (self.to / "index.html").unlink()
                make(self.to / "index.html")
                self.assertEqual(self.made()[0], 2)
                (self.to / "index.html").unlink()
                (self.to / "index.html").write_bytes(self.fresh["index.html"])
                for name in FILES:
                    (self.to / name).unlink()
                    make(self.to / name)
                self.assertEqual(self.made(), (0, ""))
                self.assertEqual(files_of(self.to), self.fresh)

    def test_results_that_are_none(self):
        for names in (("results.csv",), ("summary.csv",), ("run.yaml", "conclusions.json", "shapes.h5", "leaders.csv")):
            odd = shutil.copytree(self.out, self.folder / "odd", ignore=shutil.ignore_patterns("report"))
            for name in names:
                (odd / name).unlink()
                os.mkfifo(odd / name)
            with self.subTest(names), support.without_figures():
                self.assertEqual(support.make(odd, self.folder / "of-odd"), (0, ""))
            shutil.rmtree(odd)

    def test_texts_that_are_bombs(self):
        """Each ends a parser that recurses."""
        brackets = "[" * 100_000
        odd = shutil.copytree(self.out, self.folder / "bombs")
        for listed, record, document in (("/\n../x\n\0\n", brackets, brackets), (brackets, "- " * 100_000, "[]"), ("", "metrics: &a {x: *a}\n", '{"files": 3}')):
            for name, text in ((LIST, listed), ("../run.yaml", record), ("../conclusions.json", document)):
                (odd / "report" / name).write_text(text)
            with self.subTest(record[:10]), support.without_figures():
                self.assertEqual(support.make(odd, odd / "report"), (0, ""))

    def test_trouble_of_the_system_is_no_defect(self):
        """A disk without room, and what may not be written. The report that is there is as it was."""
        for function, number in (("os.replace", errno.ENOSPC), ("os.fsync", errno.EACCES), ("Path.mkdir", errno.EROFS)):
            error = OSError(number, os.strerror(number))
            with self.subTest(function), unittest.mock.patch(f"salbench.system.files.{function}", side_effect=error):
                status, errors = self.made()
                self.assertEqual((status, errors.count("\n")), (3, 1), errors)
                self.assertIn(os.strerror(number), errors)
                self.assertEqual(files_of(self.to), self.fresh)

    def test_a_limit_on_the_size_of_files(self):
        """As a full disk: of the folder, or of the scratch folder."""
        for most in (3_000, 20_000):
            done = forked.salbench("report", self.out, "--to", self.folder / "limited",
                                   before=lambda most=most: resource.setrlimit(resource.RLIMIT_FSIZE, (most, most)))
            with self.subTest(most):
                self.assertEqual((done.returncode, done.stderr.count("\n"), os.strerror(errno.EFBIG) in done.stderr), (3, 1, True), done.stderr)
            shutil.rmtree(self.folder / "limited")

    def test_whatever_the_user_has_set_for_matplotlib(self):
        settings = self.folder / "settings"
        settings.mkdir()
        (settings / "matplotlibrc").write_text("font.size: 30\nsavefig.facecolor: red\nfont.family: none of them\n"
                                               "axes.facecolor: red\npatch.linewidth: 9\nlines.linewidth: 9\n")
        words = ["report", self.out, "--quiet", "--no-viewer", "--to"]
        usual = forked.salbench(*words, self.folder / "usual", before=lambda: exec(TWO_FIGURES, {}))
        code = TWO_FIGURES + "import sys\nfrom salbench.__main__ import main\nsys.exit(main())\n"
        done = subprocess.run([sys.executable, "-P", "-B", "-c", code, *words, self.folder / "set"], capture_output=True, text=True,
                              env=os.environ | {"MPLBACKEND": "none of them", "MATPLOTLIBRC": str(settings)},
                              cwd=settings)  # where Matplotlib looks for settings first
        self.assertEqual((usual.returncode, done.returncode, done.stderr), (0, 0, ""))
        made = files_of(self.folder / "set")
        self.assertEqual(made, files_of(self.folder / "usual"))
        self.assertEqual(len([path for path in made if path.endswith(".pdf")]), 2)
