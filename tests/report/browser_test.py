# SPDX-License-Identifier: GPL-3.0-or-later
"""The report in a browser, from disk: what a reader does with it."""

import base64
import time
import unittest
from io import BytesIO

import pandas
from PIL import Image

import browser as chromium
import support

if chromium.AVAILABLE:
    from selenium.webdriver.common.by import By
    from selenium.webdriver.support.ui import Select, WebDriverWait


class Browser(support.BrowserTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.start_with_report("a report & more", meshes=2)  # an address that has to be escaped

    def open(self, path):
        self.browser.get((self.to / path).as_uri())

    def texts(self, selector):
        return [element.text for element in self.browser.find_elements(By.CSS_SELECTOR, selector)]

    def tearDown(self):
        self.assertEqual(chromium.console_errors(self.browser), [])
        inside = self.to.as_uri()
        asked = chromium.requests(self.browser)
        self.assertTrue(asked, "requests are recorded")
        strangers = [url for url in asked if not url.startswith((inside, "data:"))]
        self.assertEqual(strangers, [], "requests that leave the folder")

    def wait(self, condition, seconds=60):
        return WebDriverWait(self.browser, seconds).until(lambda _: condition())

    def test_index_is_usable_within_two_seconds(self):
        self.open("index.html")
        spent = self.browser.execute_script("return performance.timing.domContentLoadedEventEnd - performance.timing.navigationStart")
        self.assertLess(spent, 2000)
        broken = self.browser.execute_script(
            "return Array.from(document.images).filter(i => i.loading !== 'lazy' && !i.naturalWidth).map(i => i.src)")
        self.assertEqual(broken, [])

    def test_a_table_sorts_by_number_and_back(self):
        self.open("statistics.html")
        head = self.browser.find_element(By.XPATH, "//table[@id='table-means']//th[button='Mean']")
        head.find_element(By.TAG_NAME, "button").click()
        self.assertEqual(head.get_attribute("aria-sort"), "descending")
        numbers = [float(text.replace("−", "-")) for text in self.texts("#table-means tbody tr td:nth-child(5)")]
        self.assertEqual(numbers, sorted(numbers, reverse=True))
        head.find_element(By.TAG_NAME, "button").click()
        self.assertEqual(head.get_attribute("aria-sort"), "ascending")

    def test_a_table_filters_by_model(self):
        self.open("statistics.html")
        Select(self.browser.find_element(By.CSS_SELECTOR, "form[data-for=table-means] select[data-column='1']")).select_by_visible_text("LS")
        shown = [text for text in self.texts("#table-means tbody tr td:nth-child(2)") if text]
        self.assertEqual(set(shown), {"LS"})

    def test_scores_sort_filter_and_lead_to_the_shape(self):
        self.open("scores.html")
        self.assertEqual(self.texts("#scores output"), ["rows 1 to 100 of 104"])
        Select(self.browser.find_element(By.CSS_SELECTOR, "[data-part=class]")).select_by_visible_text("teddy")
        Select(self.browser.find_element(By.CSS_SELECTOR, "[data-part=set]")).select_by_visible_text("Meshes")
        Select(self.browser.find_element(By.CSS_SELECTOR, "[data-part=metric]")).select_by_visible_text("NSS")
        self.assertEqual(self.texts("#scores tbody th"), ["3", "4"])
        self.browser.find_element(By.XPATH, "//div[@id='scores']//th/button[text()='LS']").click()
        numbers = [float(text.replace("−", "-")) for text in self.texts("#scores tbody td:nth-child(5)")]
        self.assertEqual(numbers, sorted(numbers, reverse=True))
        self.browser.find_element(By.CSS_SELECTOR, "#scores input[name=model][value='0']").click()
        self.assertNotIn("LS", [text.split()[0] for text in self.texts("#scores thead th")])
        self.browser.find_element(By.CSS_SELECTOR, "#scores tbody a").click()
        self.assertIn("teddy", self.browser.find_element(By.TAG_NAME, "h1").text)

    def test_scores_of_a_metric_that_stands_behind_the_menu(self):
        self.open("scores.html")
        self.assertEqual(self.browser.execute_script("return salbench.scores.scores.cc"), None)
        shown = "return document.querySelector('#scores tbody td:nth-child(5)').textContent"  # rows are replaced meanwhile
        before = self.browser.execute_script(shown)
        Select(self.browser.find_element(By.CSS_SELECTOR, "[data-part=metric]")).select_by_visible_text("CC")
        self.wait(lambda: self.browser.execute_script(shown) != before)
        first = self.browser.execute_script("return salbench.scores.scores.cc[0][0]")
        self.assertEqual(self.texts("#scores tbody td:nth-child(5)")[0], f"{first:.3f}".replace("-", "−"))

    def test_one_menu_chooses_the_metric_of_every_table(self):
        self.open("metrics.html")
        shown = [text for text in self.texts("#table-means-others tbody td:nth-child(3)") if text]
        self.assertEqual(set(shown), {"AUC (exact)"})
        Select(self.browser.find_element(By.CSS_SELECTOR, "#chooser select")).select_by_visible_text("CC")
        for column in ("#table-means-others tbody td:nth-child(3)", "#table-pairs-others tbody td:nth-child(2)",
                       "#table-classes-meshes-others tbody th"):
            self.assertEqual({text for text in self.texts(column) if text}, {"CC"}, column)

    def test_later_rows_of_the_scores(self):
        self.open("scores.html")
        self.browser.find_element(By.CSS_SELECTOR, "button[data-step='1']").click()
        self.assertEqual(self.texts("#scores output"), ["rows 101 to 104 of 104"])

    def canvas(self, index):
        data = self.browser.execute_script("return document.querySelectorAll('canvas')[arguments[0]].toDataURL()", index)
        return Image.open(BytesIO(base64.b64decode(data.partition(",")[2]))).convert("RGB")

    def viewer(self, path):
        self.open(path)
        self.wait(lambda: self.browser.find_element(By.CSS_SELECTOR, ".viewer").get_attribute("data-ready") == "yes")

    def test_the_model_turns_and_the_other_view_follows(self):
        self.viewer("shapes/1.html")
        before = [self.canvas(side) for side in (0, 1)]
        self.assertGreater(len(before[0].getcolors(1 << 20)), 50, "the canvas shows a painted shape")
        self.browser.find_element(By.CSS_SELECTOR, "[aria-label='Left view: turn right']").click()
        after = [self.canvas(side) for side in (0, 1)]
        self.assertNotEqual(before[0].tobytes(), after[0].tobytes())
        self.assertNotEqual(before[1].tobytes(), after[1].tobytes())
        self.browser.find_element(By.CSS_SELECTOR, "[data-part=coupled]").click()
        self.browser.find_element(By.CSS_SELECTOR, "[aria-label='Left view: turn right']").click()
        self.assertEqual(after[1].tobytes(), self.canvas(1).tobytes(), "uncoupled, the right view stays")

    def test_the_viewer_shows_a_scan_and_another_map(self):
        self.viewer("shapes/1.html")
        left = self.browser.find_element(By.CSS_SELECTOR, ".view")
        Select(left.find_element(By.CSS_SELECTOR, "[data-part=shape]")).select_by_visible_text("Scan 1")
        self.wait(lambda: "Scan 1" in left.find_element(By.CSS_SELECTOR, "[data-part=status]").text
                  and "points" in left.find_element(By.CSS_SELECTOR, "[data-part=status]").text)
        Select(left.find_element(By.CSS_SELECTOR, "[data-part=map]")).select_by_visible_text("PS, after matching")
        self.assertIn("PS, after matching", left.find_element(By.CSS_SELECTOR, "[data-part=status]").text)
        self.assertGreater(len(self.canvas(0).getcolors(1 << 20)), 20)

    def choose(self, place, name, text, within=None):
        Select((within or self.browser).find_elements(By.CSS_SELECTOR, f"[data-part={name}]")[place]).select_by_visible_text(text)

    def test_the_viewer_begins_with_unmatched_maps_and_switches_scale(self):
        self.viewer("shapes/1.html")
        maps = [Select(menu).first_selected_option.text for menu in self.browser.find_elements(By.CSS_SELECTOR, "[data-part=map]")]
        self.assertEqual(maps, ["Ground truth", "LS, before matching"])
        seen = [self.canvas(1).tobytes()]
        for scale in ("rank", "percentile", "value"):
            self.choose(0, "scale", scale)
            seen.append(self.canvas(1).tobytes())
        self.assertEqual(seen[0], seen[3])
        self.assertEqual(len(set(seen)), 3)

    def test_scales_of_a_map(self):
        """Four points: shares that lie lower are 0, 1/4, 1/2 and 3/4."""
        self.viewer("shapes/1.html")
        scaled = {scale: self.browser.execute_script(
            "return Array.from(salbench.scaled(Uint8Array.of(0, 51, 102, 255), 255, salbench.scales[arguments[0]]), x => +x.toFixed(4))", scale)
            for scale in ("value", "rank", "percentile")}
        self.assertEqual(scaled, {"value": [0, 0.2, 0.4, 1], "rank": [0, 0.3333, 0.6667, 1], "percentile": [0, 0, 0.2, 0.4]})

    def test_the_viewer_shows_where_a_model_is_wrong(self):
        self.viewer("shapes/1.html")
        self.choose(0, "scale", "rank")
        self.choose(1, "map", "LS, difference to the ground truth")
        ends = [end.text for end in self.browser.find_elements(By.CSS_SELECTOR, "[data-part=end]")]
        self.assertEqual(ends, ["lowest rank", "highest rank", "only people look", "only the model looks"])
        colours = [colour for _, colour in self.canvas(1).getcolors(1 << 20)]
        self.assertTrue(any(blue > red + 60 for red, _, blue in colours) and any(red > blue + 60 for red, _, blue in colours))
        picks = self.browser.find_element(By.CSS_SELECTOR, "[data-part=picks]")
        picks.click()  # which are blue
        self.assertFalse(any(blue > red + 60 for red, _, blue in (colour for _, colour in self.canvas(0).getcolors(1 << 20))))

    def tiles(self):
        return self.browser.execute_script("return Array.from(document.querySelectorAll('#gallery li:not([hidden])'), "
                                           "tile => [tile.querySelector('a').textContent, tile.querySelector('.scores').textContent])")

    def test_the_gallery_sorts_filters_and_changes_its_maps(self):
        self.open("gallery.html")
        self.assertEqual([name for name, _ in self.tiles()], ["1", "2"])
        self.choose(0, "metric", "NSS")
        self.choose(0, "model", "CS")
        for order, descending in (("score, worst first", False), ("score, best first", True)):
            self.choose(0, "order", order)
            shown = [float(text.replace("−", "-").split("NSS ")[1].split(",")[0]) for _, text in self.tiles()]
            self.assertEqual(shown, sorted(shown, reverse=descending))
            self.assertEqual(len(set(shown)), 2)
        self.choose(0, "order", "disagreement, largest first")
        shown = [float(text.split("disagreement ")[1]) for _, text in self.tiles()]
        self.assertEqual(shown, sorted(shown, reverse=True))
        self.choose(0, "map", "LS, difference to the ground truth")
        sources = self.browser.execute_script("return Array.from(document.querySelectorAll('#gallery li img'), i => i.getAttribute('src'))")
        self.assertEqual(sorted(sources), ["pictures/1/mesh-LS-difference.webp", "pictures/2/mesh-LS-difference.webp"])
        self.assertEqual(self.browser.find_element(By.CSS_SELECTOR, "#gallery output").text, "2 of 2 shapes")
        self.assertTrue(self.browser.find_element(By.CSS_SELECTOR, "[data-bar=diverging]").is_displayed())

    def test_every_page_opens_and_prints(self):
        for path in sorted(self.to.rglob("*.html")):
            self.open(path.relative_to(self.to))
            self.assertTrue(self.browser.find_element(By.TAG_NAME, "h1").text)
        self.open("paper.html")
        printed = base64.b64decode(self.browser.print_page())
        self.assertTrue(printed.startswith(b"%PDF"))
        self.assertGreater(len(printed), 50_000)

    def test_nothing_is_wider_than_a_phone(self):
        self.size(400, 800)
        for path in chromium.kinds_of_pages(self.to):
            self.open(path)
            time.sleep(0.2)
            wider = self.browser.execute_script("return document.documentElement.scrollWidth - document.documentElement.clientWidth")
            self.assertLessEqual(wider, 0, path)

    def size(self, width, height):
        """Of the page itself: Chromium's narrowest window is wider than a phone."""
        self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                     {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})
        self.addCleanup(self.browser.execute_cdp_cmd, "Emulation.clearDeviceMetricsOverride", {})

    def bottom(self, selector):
        """Of the last of the elements that are shown, which has to be one at least."""
        found = self.browser.execute_script(
            "return Array.from(document.querySelectorAll(arguments[0])).map(e => e.getBoundingClientRect()).filter(r => r.width && r.height)"
            ".map(r => [r.left, r.right, r.bottom])", selector)
        self.assertTrue(found, selector)
        for left, right, _ in found:
            self.assertTrue(left >= 0 and right <= self.browser.execute_script("return innerWidth"), selector)
        return max(entry[2] for entry in found)

    def test_the_first_screen_says_who_leads_how_sure_and_of_what_data(self):
        leaders = pandas.read_csv(self.folder / "full/leaders.csv").fillna({"metric": ""})
        ranked = pandas.read_csv(self.folder / "full/ranking.csv").query("dataset == 'meshes' and metric == 'auc'")
        first = ".level:first-of-type .dots:nth-of-type(1)"
        shown = {1280: (".said p", ".facts dd", ".three img", ".level", ".doors li"), 400: (".said p", ".facts dd", ".three img", first)}
        for width, selectors in shown.items():
            with self.subTest(width):
                self.size(width, 800)
                self.open("index.html")
                for selector in selectors:
                    self.assertLessEqual(self.bottom(selector), 800, selector)
                self.assertEqual(self.texts(".said p"), list(leaders.loc[leaders["metric"] == "", "sentence"]))
                row = self.browser.find_element(By.CSS_SELECTOR, ".dots tbody tr")
                cells = [row.find_element(By.CSS_SELECTOR, part).get_attribute("textContent") for part in ("th", ".track span", ".mean", ".group")]
                best = leaders.query("dataset == 'meshes' and metric == 'auc'").iloc[0]
                self.assertEqual(cells, [best["leaders"].split(", ")[0], f"{best['ci95_low']:.3f} to {best['ci95_high']:.3f}",
                                         f"{best['mean']:.3f}", ranked["group"].iloc[0]])
                facts = " ".join(self.texts(".facts dd"))
                self.assertIn("8 meshes, 96 scans", facts)
                self.assertIn("22 to 25 real people per shape", facts)

    def test_the_compact_table_sorts_and_its_arrow_has_words(self):
        self.open("ranking.html")
        head = self.browser.find_element(By.CSS_SELECTOR, "#table-compact-meshes th:nth-child(2)")
        self.assertIn("higher is better", head.get_attribute("textContent"))
        head.find_element(By.TAG_NAME, "button").click()
        numbers = [float(text.split()[0].replace("−", "-")) for text in self.texts("#table-compact-meshes tbody td:nth-child(2)")]
        self.assertEqual(numbers, sorted(numbers, reverse=True))
        self.assertEqual(len(self.browser.find_elements(By.CSS_SELECTOR, "#table-compact-meshes tbody td:nth-child(2) strong")), 1)


if __name__ == "__main__":
    unittest.main()
