# SPDX-License-Identifier: GPL-3.0-or-later
"""axe-core, which looks for what keeps people from using a page. It comes from npm into a temporary folder."""

import shutil
import subprocess
import unittest

import browser
import support

AXE = "axe-core@4.10.2"
GRAVE = ("serious", "critical")


class Accessibility(support.BrowserTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        npm = shutil.which("npm")
        if npm is None:
            raise unittest.SkipTest("npm is not installed")
        try:
            subprocess.run([npm, "install", "--no-audit", "--no-fund", "--ignore-scripts", AXE], cwd=cls.folder, check=True,
                           capture_output=True, timeout=120)
        except (OSError, subprocess.SubprocessError):
            raise unittest.SkipTest("npm cannot reach its registry") from None
        cls.axe = (cls.folder / "node_modules/axe-core/axe.min.js").read_text(encoding="utf-8")
        with support.without_drawing():
            cls.start_with_report("report", meshes=1)

    def findings(self, path):
        self.browser.get((self.to / path).as_uri())
        self.browser.execute_script(self.axe)
        found = self.browser.execute_async_script("axe.run().then(arguments[arguments.length - 1])")
        return [f"{finding['id']}: {finding['help']}: {[node['target'] for node in finding['nodes']][:3]}"
                for finding in found["violations"] if finding["impact"] in GRAVE]

    def test_no_serious_finding_on_any_kind_of_page(self):
        pages = browser.kinds_of_pages(self.to)
        self.assertGreaterEqual(len(pages), 10)
        for scheme in ("light", "dark"):
            self.browser.execute_cdp_cmd("Emulation.setEmulatedMedia",
                                         {"features": [{"name": "prefers-color-scheme", "value": scheme}]})
            for path in pages:
                with self.subTest(path, scheme=scheme):
                    self.assertEqual(self.findings(path), [])


if __name__ == "__main__":
    unittest.main()
