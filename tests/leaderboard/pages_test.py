# SPDX-License-Identifier: GPL-3.0-or-later
"""The pages of a leaderboard in a browser: with names that break pages, on a narrow screen, and for people who cannot see them."""

import tempfile
import unittest
from pathlib import Path

import toy

from tests.report import browser

NAMES = ("<img src=x onerror=alert(1)>", "\N{GRINNING FACE}" * 30, "\N{RIGHT-TO-LEFT OVERRIDE}gpj.zip", "=1+1", "x" * 250)
LONG = "W" * 40  # a name of a model

# Elements that reach beyond the screen, but for those within something that scrolls.
CUT = """
return Array.from(document.querySelectorAll("body *")).filter((element) => {
  if (!element.checkVisibility() || element.closest(".unseen, .skip")) return false;
  for (let above = element.parentElement; above; above = above.parentElement)
    if (["auto", "scroll"].includes(getComputedStyle(above).overflowX)) return false;
  const box = element.getBoundingClientRect();
  return box.right > 401 || box.left < -1;
}).map((element) => element.tagName + " " + element.textContent.slice(0, 40));
"""


@browser.needs_browser
class Pages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        made = toy.Toy(Path(cls.enterClassContext(tempfile.TemporaryDirectory())))
        assert made.submit("G0", 0.5).returncode == 0
        made.with_card(f"{NAMES[0]}.zip".replace("/", ""), toy.card("SEEN", overlap="[1, 2]", url="javascript:alert(1)"))
        made.with_card("long.zip", toy.card(LONG, citation='"' + "W" * 1900 + '"', licence='"\N{RIGHT-TO-LEFT OVERRIDE}txet"'))
        made.with_card("open.zip", toy.card("OPEN", weights="https://example.org/w", device='"' + "W" * 1900 + '"', contact='"<b>"', reproduced_by="me"))
        for name in NAMES[1:]:
            (made.submissions / f"{name}.zip").write_bytes(b"no archive")
        done = made.rank()
        assert done.returncode == 1, done.stderr
        cls.site = made.site
        cls.pages = [*sorted(cls.site.glob("*.html")), *sorted(cls.site.glob("models/*.html"))]
        cls.browser = browser.start()
        cls.addClassCleanup(cls.browser.quit)

    def test_nothing_is_cut_at_400_pixels(self):
        self.phone()
        self.assertGreaterEqual(len(self.pages), 8)
        for page in self.pages:
            with self.subTest(page.name):
                self.browser.get(page.as_uri())
                self.browser.execute_script("document.querySelectorAll('details').forEach((one) => { one.open = true; });")
                self.assertEqual(self.browser.execute_script(CUT), [])
                self.assertLessEqual(self.browser.execute_script("return document.documentElement.scrollWidth"), 400)

    def phone(self):
        self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {"width": 400, "height": 800, "deviceScaleFactor": 1, "mobile": True})
        self.addCleanup(self.browser.execute_cdp_cmd, "Emulation.clearDeviceMetricsOverride", {})

    def test_the_ranking_is_on_the_first_screen_of_a_phone(self):
        """The first three models, with rank, mean, interval and letters by the first metric, and their distance from the best."""
        self.phone()
        self.browser.get((self.site / "index.html").as_uri())
        browser.settle(self.browser)
        for cell in ("th", "td:nth-child(2)", "td:nth-child(3) .after", "td:nth-child(3) svg .mark"):
            what = f"tbody tr:nth-child(-n+3) {cell}"
            boxes = self.browser.execute_script("return Array.from(document.querySelectorAll('[id^=table-ranking] ' + arguments[0]), (one) => {"
                                                "const box = one.getBoundingClientRect(); return [box.left, box.right, box.bottom]; })", what)
            self.assertEqual(len(boxes), 3, what)
            for left, right, bottom in boxes:
                self.assertTrue(0 <= left < right <= 400 and bottom <= 800, (what, left, right, bottom))

    def test_a_menu_chooses_models_and_ranks_stay(self):
        self.browser.get((self.site / "index.html").as_uri())
        rows = ("return Array.from(document.querySelectorAll('[id^=table-ranking] tbody tr')).filter((row) => row.checkVisibility())"
                ".map((row) => row.cells[0].innerText.split(/\\s/)[0] + ' ' + row.cells[1].innerText)")
        every = self.browser.execute_script(rows)
        menu = self.browser.find_element("css selector", "select[data-label='Open weights']")
        menu.send_keys("yes")  # by the keyboard
        chosen = self.browser.execute_script(rows)
        self.assertEqual(chosen, [row for row in every if row.split()[0] in ("OPEN", "RS", "HS", "constant")])
        self.assertTrue(0 < len(chosen) < len(every))
        self.assertIn(f"{len(chosen)} of {len(every)} rows", self.browser.find_element("css selector", "form.filters output").text)

    def test_names_are_text(self):
        self.browser.get((self.site / "submissions.html").as_uri())
        text = self.browser.find_element("tag name", "body").text
        for name in NAMES[:2]:
            self.assertIn(name, text)
        for page in self.pages:
            self.browser.get(page.as_uri())
            self.assertEqual(self.browser.execute_script("return document.querySelectorAll('img, a[href^=javascript]').length"), 0, page.name)
            self.assertEqual(browser.console_errors(self.browser), [], page.name)

    def test_no_serious_finding(self):
        script = browser.axe()
        for page in [*self.site.glob("*.html"), self.site / "models/OPEN.html"]:
            for scheme, found in browser.findings(self.browser, script, page):
                self.assertEqual(found, [], (page.name, scheme))
