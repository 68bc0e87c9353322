# SPDX-License-Identifier: GPL-3.0-or-later
"""axe-core, which looks for what keeps people from using a page. It comes from npm into a temporary folder."""

import shutil
import subprocess
import unittest

import browser
import support
from salbench.report import leaderboard

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

    def findings(self, page):
        self.browser.get(page.as_uri())
        self.browser.execute_script(self.axe)
        found = self.browser.execute_async_script("axe.run().then(arguments[arguments.length - 1])")
        return [f"{finding['id']}: {finding['help']}: {[node['target'] for node in finding['nodes']][:3]}"
                for finding in found["violations"] if finding["impact"] in GRAVE]

    def expect_nothing_serious(self, pages):
        for scheme in ("light", "dark"):
            self.browser.execute_cdp_cmd("Emulation.setEmulatedMedia",
                                         {"features": [{"name": "prefers-color-scheme", "value": scheme}]})
            for page in pages:
                with self.subTest(page.name, scheme=scheme):
                    self.assertEqual(self.findings(page), [])

    def test_no_serious_finding_on_any_kind_of_page(self):
        pages = browser.kinds_of_pages(self.to)
        self.assertGreaterEqual(len(pages), 10)
        self.expect_nothing_serious([self.to / path for path in pages])

    def test_no_serious_finding_on_a_leaderboard(self):
        site = self.folder / "site"
        shutil.copytree(self.folder / "full", site / "data")
        (site / "data/submissions.csv").write_text(
            "file,model,status,reason,remark,date,citation,licence,training_data,test_overlap,url,program\n"
            "a.zip,LS,ranked,,,2026-11-23,Somebody,MIT,none,none,,0.2.0\nb.zip,,refused,is cut short,,,,,,,,\n")
        (site / "data/metrics.csv").write_text("metric,unit,better\nauc,1,higher\nnss,,higher\n")
        (site / "data/history.csv").write_text("dataset,metric,date,file,model,mean,best\nmeshes,auc,2026-11-23,a.zip,LS,0.6,yes\n")
        (site / "data/protocol.yaml").write_text("seed: 2016\n")
        leaderboard.write_pages(site)
        self.expect_nothing_serious([*sorted(site.glob("*.html")), site / "models/LS.html"])


if __name__ == "__main__":
    unittest.main()
