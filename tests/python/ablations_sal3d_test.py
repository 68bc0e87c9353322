# SPDX-License-Identifier: GPL-3.0-or-later
"""The night of ablations_test over SAL3D, whose own splits take no part."""

import os
import unittest

import ablations_test


@unittest.skipUnless(os.environ.get("SALBENCH_DATA"), "SALBENCH_DATA names no data")
class OverSal3d(ablations_test.Ablations):
    @staticmethod
    def data_set(work):
        return os.path.join(os.environ["SALBENCH_DATA"], "sal3d"), "sal3d"


def load_tests(loader, tests, pattern):
    """Not those of the module that it imports."""
    return loader.loadTestsFromTestCase(OverSal3d)


if __name__ == "__main__":
    unittest.main()
