# SPDX-License-Identifier: GPL-3.0-or-later
"""axe-core, which looks for what keeps people from using a page, on the pages of a report."""


import browser
import support


class Accessibility(support.BrowserTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.axe = browser.axe()
        cls.start_with_report("report", meshes=1)

    def test_no_serious_finding_on_any_kind_of_page(self):
        pages = browser.kinds_of_pages(self.to)
        self.assertGreaterEqual(len(pages), 10)
        for path in pages:
            for scheme, found in browser.findings(self.browser, self.axe, self.to / path):
                self.assertEqual(found, [], (path, scheme))
