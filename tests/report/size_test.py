# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole benchmark, 400 meshes and 4800 scans with made-up scores: time and size without pictures."""

import time
import unittest

import browser as chromium
import fixture
import support

CLASSES = ("human cup glasses airplane ant chair octopus table teddy hand plier fish bird spring armadillo buste mechanic bearing "
           "vase four-legged").split()


class Size(support.ReportTest):
    def test_400_meshes_and_4800_scans(self):
        out = self.folder / "whole"
        fixture.write_results(out, [(str(index + 1), CLASSES[index // 20]) for index in range(400)])
        begin = time.monotonic()
        to = self.report("whole")
        seconds = time.monotonic() - begin
        index = (to / "index.html").stat().st_size
        whole = sum(path.stat().st_size for path in to.rglob("*") if path.is_file())
        print(f"written in {seconds:.0f} s; index {index / 1e6:.2f} MB; whole {whole / 1e6:.1f} MB")
        self.assertLess(seconds, 180)
        self.assertLess(index, 3e6)
        self.assertLess(whole, 600e6)
        self.assertEqual(len(list((to / "shapes").glob("*.html"))), 400)
        if chromium.AVAILABLE:
            for path in ("index.html", "scores.html"):
                self.assert_usable_soon(to / path)

    def assert_usable_soon(self, path):
        browser = chromium.start()
        self.addCleanup(browser.quit)
        browser.get(path.as_uri())
        spent = browser.execute_script("return performance.timing.domContentLoadedEventEnd - performance.timing.navigationStart")
        print(f"{path.name}: usable after {spent} ms")
        self.assertLess(spent, 2000)


if __name__ == "__main__":
    unittest.main()
