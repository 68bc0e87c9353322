# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of a small results folder: each is there in every form, and plots what the tables of the folder have. Scores: statistics_test.py."""

import contextlib
import re

import numpy
import pandas

import fixture
import support

FIGURES = ["costs", "distributions-meshes", "distributions-scans", "human-curves", "performance-meshes-auc", "performance-meshes-nss",
           "ranking-scans", "stages"]


class Figures(support.ReportTest):
    figures = staticmethod(contextlib.nullcontext)

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        out = cls.folder / "fixed"
        fixture.write_results(out, fixture.eight_meshes())
        fixture.write_costs(out)
        cls.out, cls.to = out, cls.report("fixed", "--metrics", "auc,nss")

    def plotted(self, name):
        return pandas.read_csv(self.to / "data" / f"{name}.csv")

    def test_every_figure_is_there_as_svg_pdf_and_numbers(self):
        for name in FIGURES:
            self.assertTrue(support.drawn(self.to, f"figures/{name}.svg").read_bytes().startswith(b"<?xml"), name)
            self.assertTrue(support.drawn(self.to, f"figures/{name}.pdf").read_bytes().startswith(b"%PDF"), name)
            self.assertTrue(len(self.plotted(name)), name)

    def test_pages_show_figures_in_their_size(self):
        shown = re.findall(r'<img src="(figures/[^"]*)" [^>]*width="(\d+)"', support.page(self.to))
        self.assertEqual(len(shown), len(FIGURES))
        for file, width in shown:
            points = re.search(r'<svg [^>]*width="([\d.]+)pt"', (self.to / file).read_text())
            self.assertAlmostEqual(int(width), float(points[1]) / 72 * 96, delta=.51, msg=file)

    def test_cumulative_distributions_are_sums_of_the_histograms(self):
        for dataset in ("meshes", "scans"):
            data, shares = self.plotted(f"distributions-{dataset}"), pandas.read_csv(self.out / f"mean_histograms_{dataset}.csv")
            self.assertEqual(list(data), ["value", *shares.columns[1:]])
            numpy.testing.assert_allclose(data["value"], numpy.arange(101) / 100)
            numpy.testing.assert_allclose(data.iloc[1:, 1:], shares.iloc[:, 1:].cumsum() / 100, atol=1e-12)
            self.assertEqual(set(data.iloc[0]), {0.0})

    def test_curves_of_people_are_those_of_the_file(self):
        rows = pandas.read_csv(self.out / "human_curve.csv").dropna(subset=["mean"])
        expected = pandas.concat([rows[rows["metric"] == metric] for metric in ("auc", "nss")], ignore_index=True)
        data = self.plotted("human-curves")
        self.assertEqual((len(data), list(data)), (22, ["n", "n_meshes", "mean", "ci95_low", "ci95_high", "metric"]))
        pandas.testing.assert_frame_equal(data, expected[list(data)], check_dtype=False)

    def test_costs_are_medians_and_95th_percentiles_and_stages_are_those_that_took_time(self):
        rows = [[dataset, model, 4.5 * share, 7.65 * share] for dataset in ("meshes", "scans") for model, share in (("LS", 1), ("RS", 0.1))]
        expected = pandas.DataFrame(rows, columns=["dataset", "model", "median", "p95"])
        pandas.testing.assert_frame_equal(self.plotted("costs"), expected)
        self.assertEqual(self.plotted("stages").to_numpy().tolist(), [["map.LS", 12.5]])
