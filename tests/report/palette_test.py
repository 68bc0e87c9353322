# SPDX-License-Identifier: GPL-3.0-or-later
"""The colours of maps as people see them: in grey, and without one of three kinds of cones (Machado, Oliveira and Fernandes 2009,
severity 1, on linear RGB)."""

import unittest

import numpy

from salbench.report.painting import colours

SIGHTS = {
    "usual": numpy.eye(3),
    "protanopia": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "deuteranopia": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    "tritanopia": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
}


def seen(table, sight):
    """Linear RGB of 8-bit sRGB as someone sees it."""
    value = table / 255
    linear = numpy.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
    return numpy.clip(linear @ numpy.transpose(SIGHTS[sight]), 0, 1)


def lightness(table, sight):
    """CIE L*, 0 to 100, of what would be printed in grey."""
    luminance = seen(table, sight) @ [0.2126, 0.7152, 0.0722]
    return numpy.where(luminance > 0.008856, 116 * numpy.cbrt(luminance) - 16, 903.3 * luminance)


class Palette(unittest.TestCase):
    def test_maps_begin_light_and_neutral_and_end_saturated(self):
        table = colours("palette").astype(int)
        self.assertEqual(table.shape, (256, 3))
        self.assertLess(numpy.ptp(table[0]), 6)
        self.assertGreater(lightness(table, "usual")[0], 80)
        self.assertGreater(numpy.ptp(table[192]), 100)

    def test_maps_are_ever_darker_in_even_steps_to_every_eye(self):
        for sight in SIGHTS:
            with self.subTest(sight):
                levels = lightness(colours("palette"), sight)
                self.assertLess(numpy.diff(levels).max(), 0.1, "no step up beyond what 8 bits round")
                self.assertTrue((levels[4:] < levels[:-4]).all())
                self.assertGreater(levels[0] - levels[-1], 55)
        steps = -numpy.diff(lightness(colours("palette"), "usual")[::32])
        self.assertLess(steps.max(), 1.8 * steps.min())

    def test_differences_are_darker_to_either_side_and_their_ends_differ_to_every_eye(self):
        table = colours("diverging")
        self.assertLess(numpy.ptp(table[127:129].astype(int)), 6)
        for sight in SIGHTS:
            with self.subTest(sight):
                levels = lightness(table, sight)
                self.assertTrue((levels[:124] < levels[4:128]).all())
                self.assertTrue((levels[132:] < levels[128:-4]).all())
                self.assertLess(abs(levels[0] - levels[-1]), 20, "neither end looks larger")
                self.assertGreater(abs(seen(table[0], sight) - seen(table[-1], sight)).max(), 0.2)

    def test_picks_stand_out_from_every_colour_of_maps(self):
        for table in (colours("palette"), colours("diverging")[128:]):
            self.assertGreater(numpy.linalg.norm(table - colours("pick").astype(float), axis=1).min(), 80)
