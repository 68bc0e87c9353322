# SPDX-License-Identifier: GPL-3.0-or-later
"""The plotted numbers of a small fixed results folder equal golden data (golden/*.csv). After a wanted change:
REPORT_GOLDEN=write python3 -m unittest figures_test, and look at the difference."""

import contextlib
import os
from pathlib import Path

import numpy
import pandas

import fixture
import support

GOLDEN = Path(__file__).resolve().parent / "golden"
FIGURES = ["costs", "distributions-meshes", "distributions-scans", "human-curves", "performance-meshes-auc", "performance-meshes-lcc",
           "performance-meshes-nss", "ranking-scans", "stages"]


class Figures(support.ReportTest):
    figures = staticmethod(contextlib.nullcontext)

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        out = cls.folder / "fixed"
        fixture.write_results(out, fixture.eight_meshes())
        fixture.write_costs(out)
        cls.out, cls.to = out, cls.report("fixed")

    def test_plotted_numbers_equal_the_golden_ones(self):
        for name in FIGURES:
            with self.subTest(name):
                made = pandas.read_csv(self.to / "data" / f"{name}.csv")
                if os.environ.get("REPORT_GOLDEN") == "write":
                    GOLDEN.mkdir(exist_ok=True)
                    made.round(10).to_csv(GOLDEN / f"{name}.csv", index=False)
                golden = pandas.read_csv(GOLDEN / f"{name}.csv")
                self.assertEqual(list(made), list(golden))
                for column in golden:
                    if golden[column].dtype == object:
                        self.assertEqual(made[column].tolist(), golden[column].tolist(), column)
                    else:
                        numpy.testing.assert_allclose(made[column], golden[column], atol=1e-9, err_msg=column)

    def test_every_figure_is_there_as_svg_pdf_and_numbers(self):
        for name in FIGURES:
            self.assertTrue(support.drawn(self.to, f"figures/{name}.svg").read_bytes().startswith(b"<?xml"), name)
            self.assertTrue(support.drawn(self.to, f"figures/{name}.pdf").read_bytes().startswith(b"%PDF"), name)

    def test_cumulative_distributions_rise_from_0_to_1(self):
        data = pandas.read_csv(self.to / "data/distributions-meshes.csv").drop(columns="value")
        self.assertEqual(set(data.iloc[0]), {0.0})
        numpy.testing.assert_allclose(data.iloc[-1], 1)
        self.assertTrue((data.diff().iloc[1:] >= 0).all(axis=None))
