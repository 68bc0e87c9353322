# SPDX-License-Identifier: GPL-3.0-or-later
"""The report in a browser, from disk: what a reader does with it."""

import base64
import re
from io import BytesIO

import pandas
from PIL import Image

import browser as chromium
import support

if chromium.AVAILABLE:
    from selenium.webdriver.common.by import By
    from selenium.webdriver.support.ui import Select, WebDriverWait


@chromium.needs_browser
class Browser(support.ReportTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.to = cls.report("a report & more", out=support.make_full(cls.folder, meshes=2))  # an address that has to be escaped
        cls.browser = chromium.start()
        cls.addClassCleanup(cls.browser.quit)

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

    def wait(self, condition, seconds=600):
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
        numbers = [float(text.replace("−", "-")) for text in self.column("means", 4)]
        self.assertEqual(numbers, sorted(numbers, reverse=True))
        head.find_element(By.TAG_NAME, "button").click()
        self.assertEqual(head.get_attribute("aria-sort"), "ascending")

    def test_a_table_filters_by_model(self):
        self.open("statistics.html")
        self.pick("means", 0, "LS")
        self.assertEqual(self.column("means", 0), ["LS"])
        self.pick("means", 1, "Scans")
        self.assertEqual(self.column("means", 1), ["Scans"])

    def column(self, table, at):
        """Texts of the rows that are shown, whether the column is or not."""
        return self.browser.execute_script(
            "return Array.from(document.querySelectorAll(`#table-${arguments[0]} tbody tr:not([hidden])`), row => row.cells[arguments[1]].textContent.trim())",
            table, at)

    def pick(self, table, column, text):
        """Picks an entry in a menu above a table."""
        Select(self.browser.find_element(By.CSS_SELECTOR, f"form[data-for=table-{table}] select[data-column='{column}']")).select_by_visible_text(text)

    def test_ranking_and_pairs_open_on_one_metric_and_one_data_set(self):
        for page, table, of_models in (("ranking.html", "ranking", 6), ("statistics.html", "pairs", 15), ("statistics.html", "means", 6)):
            with self.subTest(table):
                self.open(page)
                self.assertEqual((self.column(table, 1), self.column(table, 2)), (["Meshes"] * of_models, ["AUC"] * of_models))
                menus = [[option.text for option in Select(menu).options] for menu in
                         self.browser.find_elements(By.CSS_SELECTOR, f"form[data-for=table-{table}] select")][:2]
                self.assertEqual(menus, [["Meshes", "Scans"], ["AUC", "NSS", "LCC"]], "no choice mixes metrics")
                self.pick(table, 2, "NSS")
                self.assertEqual(set(self.column(table, 2)), {"NSS"})
                rows = (self.to / page).read_text(encoding="utf-8").partition(f'id="table-{table}"')[2].partition("</tbody>")[0]
                self.assertNotIn("<tr hidden", rows, "without JavaScript every row is there")

    def unfold(self):
        """Until what scrolls is known."""
        self.browser.execute_script("document.querySelectorAll('details').forEach(one => { one.open = true; })")
        chromium.settle(self.browser)

    def test_no_verdict_is_outside_the_screen(self):
        self.size(1280, 800)
        found = 0
        for path in chromium.kinds_of_pages(self.to):
            self.open(path)
            self.unfold()
            places = self.browser.execute_script(
                "return Array.from(document.querySelectorAll('.holds, .fails, .open'), e => e.getBoundingClientRect()).filter(r => r.width)"
                ".map(r => [r.left, r.right])")
            found += len(places)
            self.assertEqual([place for place in places if place[0] < 0 or place[1] > 1280], [], path)
        self.assertGreater(found, 15)  # of rankings, pairs and means of papers
        for page, table in (("ranking.html", "ranking"), ("classes.html", "classes-meshes-auc")):
            self.open(page)
            chromium.settle(self.browser)
            box = self.browser.find_element(By.CSS_SELECTOR, f"#sheet-{table} .scroll")
            self.assertIsNone(box.get_attribute("data-scrolls"), f"{table} fits")

    def test_on_a_phone_nothing_is_wider_links_are_large_enough_and_what_scrolls_says_so(self):
        """The first column stays where a table scrolls."""
        self.size(400, 800)
        scrolling = set()
        for path in chromium.kinds_of_pages(self.to):
            self.open(path)
            chromium.settle(self.browser)
            wider = self.browser.execute_script("return document.documentElement.scrollWidth - document.documentElement.clientWidth")
            self.assertLessEqual(wider, 0, path)
            self.unfold()
            low = self.browser.execute_script("return Array.from(document.querySelectorAll('a')).filter(a => a.getBoundingClientRect().height)"
                                              ".filter(a => a.getBoundingClientRect().height < 24).map(a => a.textContent)")
            self.assertEqual(low, [], path)
            seen = self.browser.execute_script("""return Array.from(document.querySelectorAll('.scroll')).filter(box => box.clientWidth).map(box => {
              box.scrollLeft = 150;
              const first = box.querySelector('tbody tr:not([hidden]) th');
              return [box.scrollWidth > box.clientWidth + 1, getComputedStyle(box, '::before').content.includes('scroll'),
                first ? first.getBoundingClientRect().left - box.getBoundingClientRect().left : 0];
            })""")
            for scrolls, says, left in seen:
                self.assertEqual((scrolls, abs(left) < 2), (says, True), path)
            scrolling |= {path} if any(scrolls for scrolls, _, _ in seen) else set()
        self.assertLessEqual({"ranking.html", "classes.html", "statistics.html", "scores.html", "paper.html"}, scrolling)

    def test_letters_have_titles_and_a_line_each(self):
        self.open("index.html")
        letters = self.texts(".letters dt")
        self.assertEqual(letters, ["LS", "CS", "PS", "MS", "HS", "RS", "AUC", "NSS", "LCC"])
        text = self.browser.find_element(By.CSS_SELECTOR, ".letters").text
        for said in ("Shtrom, Leifman, Tal 2013", "0 to 1, higher is better", "random number"):
            self.assertIn(said, text)
        for page, selector in (("ranking.html", "#table-ranking tbody th abbr"), ("statistics.html", "#table-pairs tbody th abbr")):
            self.open(page)
            titles = {e.get_attribute("textContent"): e.get_attribute("title") for e in self.browser.find_elements(By.CSS_SELECTOR, selector)}
            self.assertEqual(titles["LS"], "Saliency of large point sets, Shtrom, Leifman, Tal 2013")

    def test_the_page_of_a_shape_has_scores_beside_the_viewer_and_leads_on(self):
        self.size(1280, 800)
        self.viewer("shapes/1.html")
        viewer, scores = (self.browser.find_element(By.CSS_SELECTOR, part).rect for part in (".viewer", "#sheet-mesh-scores"))
        self.assertGreaterEqual(scores["x"], viewer["x"] + viewer["width"])
        self.assertLess(scores["y"] + scores["height"], 800)
        self.assertFalse(self.browser.find_element(By.CSS_SELECTOR, "#sheet-scan-scores").is_displayed(), "scans are folded")
        self.browser.find_element(By.CSS_SELECTOR, ".steps a[rel=next]").click()
        self.assertIn("Mesh 2", self.browser.find_element(By.TAG_NAME, "h1").text)
        self.browser.find_element(By.CSS_SELECTOR, ".steps a[rel=prev]").click()
        self.assertIn("Mesh 1", self.browser.find_element(By.TAG_NAME, "h1").text)
        self.assertEqual(len(self.browser.find_elements(By.CSS_SELECTOR, ".steps a[rel=prev]")), 0)

    def test_the_list_of_shapes_begins_with_meshes_and_is_searched(self):
        self.open("scores.html")
        self.assertEqual(set(self.texts("#scores tbody td:nth-child(2)")), {"Meshes"})
        self.browser.find_element(By.CSS_SELECTOR, "[data-part=search]").send_keys("TEDD")
        self.assertEqual(self.texts("#scores tbody th"), ["3", "4"])
        self.browser.find_element(By.CSS_SELECTOR, "[data-part=search]").send_keys("y 3")
        self.assertEqual(self.texts("#scores tbody th"), ["3"])

    def test_scores_sort_filter_and_lead_to_the_shape(self):
        self.open("scores.html")
        self.assertEqual(self.texts("#scores output"), ["rows 1 to 8 of 8"])
        Select(self.browser.find_element(By.CSS_SELECTOR, "[data-part=class]")).select_by_visible_text("teddy")
        Select(self.browser.find_element(By.CSS_SELECTOR, "[data-part=set]")).select_by_visible_text("Meshes")
        Select(self.browser.find_element(By.CSS_SELECTOR, "[data-part=metric]")).select_by_visible_text("NSS")
        self.assertEqual(self.texts("#scores tbody th"), ["3", "4"])
        self.browser.find_element(By.XPATH, "//div[@id='scores']//th/button[.='LS']").click()
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
        self.assertEqual(set(self.column("means-others", 2)), {"AUC (exact)"})
        Select(self.browser.find_element(By.CSS_SELECTOR, "#chooser select")).select_by_visible_text("CC")
        for table, column in (("means-others", 2), ("pairs-others", 2), ("classes-meshes-others", 1)):
            self.assertEqual(set(self.column(table, column)), {"CC"}, table)

    def test_later_rows_of_the_scores(self):
        self.open("scores.html")
        Select(self.browser.find_element(By.CSS_SELECTOR, "[data-part=set]")).select_by_visible_text("all")
        self.browser.find_element(By.CSS_SELECTOR, "button[data-step='1']").click()
        self.assertEqual(self.texts("#scores output"), ["rows 101 to 104 of 104"])

    def canvas(self, index):
        data = self.browser.execute_script("return document.querySelectorAll('canvas')[arguments[0]].toDataURL()", index)
        return Image.open(BytesIO(base64.b64decode(data.partition(",")[2]))).convert("RGB")

    def viewer(self, path):
        self.open(path)
        self.wait(lambda: self.browser.find_element(By.CSS_SELECTOR, ".viewer").get_attribute("data-ready") == "yes")

    def sides(self):
        """Azimuth and elevation that each view says it is seen from."""
        parts = self.browser.find_elements(By.CSS_SELECTOR, "[data-part=side]")
        return [tuple(map(int, re.findall(r"-?\d+", part.text))) for part in parts]

    def test_the_model_turns_and_the_other_view_follows(self):
        self.viewer("shapes/1.html")
        before = [self.canvas(side) for side in (0, 1)]
        sides = self.sides()
        self.assertGreater(len(before[0].getcolors(1 << 20)), 50, "the canvas shows a painted shape")
        self.browser.find_element(By.CSS_SELECTOR, "[aria-label='Left view: turn right']").click()
        after = [self.canvas(side) for side in (0, 1)]
        self.assertNotEqual(before[0].tobytes(), after[0].tobytes())
        (azimuth, elevation), = set(sides)
        self.assertEqual(self.sides(), [((azimuth + 15 + 180) % 360 - 180, elevation)] * 2)
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
        # The shares of four points that lie lower are 0, 1/4, 1/2 and 3/4.
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
        picks = self.browser.find_element(By.CSS_SELECTOR, "[data-part=picks]")  # which are blue, and hidden at first
        for shown in (False, True):
            self.assertEqual(any(blue > red + 60 for red, _, blue in (colour for _, colour in self.canvas(0).getcolors(1 << 20))), shown)
            picks.click()

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
        self.assertEqual(sorted(sources), [str(support.drawn(self.to, f"pictures/{item}/mesh-LS-difference.webp").relative_to(self.to)) for item in (1, 2)])
        self.assertEqual(self.browser.find_element(By.CSS_SELECTOR, "#gallery output").text, "2 of 2 shapes")
        self.assertTrue(self.browser.find_element(By.CSS_SELECTOR, "[data-bar=diverging]").is_displayed())
        self.browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
        self.addCleanup(self.browser.execute_cdp_cmd, "Emulation.setEmulatedMedia", {"media": ""})
        self.assertTrue(all(part.is_displayed() for part in self.browser.find_elements(By.CSS_SELECTOR, "#gallery [data-part]")))
        lines = self.browser.execute_script("return Array.from(document.querySelectorAll('.tiles:not(.wrap)'), list => ['li', 'img'].map("
                                            "tag => new Set(Array.from(list.querySelectorAll(tag), e => e.getBoundingClientRect().top)).size))")
        self.assertTrue(lines)
        for tiles, pictures in lines:
            self.assertEqual(tiles, pictures)

    def test_every_page_opens_and_prints(self):
        for path in sorted(self.to.rglob("*.html")):
            self.open(path.relative_to(self.to))
            self.assertTrue(self.browser.find_element(By.TAG_NAME, "h1").text)
        self.open("paper.html")
        printed = base64.b64decode(self.browser.print_page())
        self.assertTrue(printed.startswith(b"%PDF"))
        self.assertGreater(len(printed), 50_000)

    def test_no_serious_finding_on_any_kind_of_page(self):
        """By axe-core, which looks for what keeps people from using a page."""
        self.open("index.html")
        pages, script = chromium.kinds_of_pages(self.to), chromium.axe()
        self.assertGreaterEqual(len(pages), 10)
        for path in pages:
            for scheme, found in chromium.findings(self.browser, script, self.to / path):
                self.assertEqual(found, [], (path, scheme))

    def size(self, width, height):
        """Sets the size of the page itself, because Chromium's narrowest window is wider than a phone."""
        self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                     {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})
        self.addCleanup(self.browser.execute_cdp_cmd, "Emulation.clearDeviceMetricsOverride", {})

    def bottom(self, selector):
        """Bottom of the last visible element; requires at least one."""
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
        shown = {1280: (".said p", ".facts dd", ".three img", ".level", ".letters dt"), 400: (".said p", ".facts dd", ".three img", first)}
        for width, selectors in shown.items():
            with self.subTest(width):
                self.size(width, 800)
                self.open("index.html")
                for selector in selectors:
                    self.assertLessEqual(self.bottom(selector), 800, selector)
                said = self.texts(".said p")
                self.assertEqual([text.partition(":")[0] for text in said], ["Meshes", "Scans"])
                for text in said:
                    self.assertNotRegex(text, "[0-9]")
                    self.assertLessEqual(len(re.sub(r"\(.*?\)", "", text.partition(":")[2]).split()), 12, text)
                row = self.browser.find_element(By.CSS_SELECTOR, ".dots tbody tr")
                cells = [row.find_element(By.CSS_SELECTOR, part).get_attribute("textContent") for part in ("th", ".track span", ".mean", ".group")]
                best = leaders.query("dataset == 'meshes' and metric == 'auc'").iloc[0]
                self.assertEqual(cells, [best["leaders"].split(", ")[0], "best mean", f"{best['mean']:.3f}", ranked["group"].iloc[0]])
                second = self.browser.find_element(By.CSS_SELECTOR, ".dots tbody tr:nth-child(2) .track span").get_attribute("textContent")
                lead = [f"{best[column]:.3f}".replace("-", "−") for column in ("lead", "lead_low", "lead_high")]
                self.assertEqual(second, f"{lead[0]} behind, {lead[1]} to {lead[2]}")
                facts = " ".join(self.texts(".facts dd"))
                self.assertIn("8 meshes, 96 scans", facts)
                self.assertIn("22 to 25 participants per shape", facts)

    def test_the_compact_table_sorts_and_its_arrow_has_words(self):
        self.open("ranking.html")
        head = self.browser.find_element(By.CSS_SELECTOR, "#table-compact-meshes th:nth-child(2)")
        self.assertIn("higher is better", head.get_attribute("textContent"))
        head.find_element(By.TAG_NAME, "button").click()
        numbers = [float(text.split()[0].replace("−", "-")) for text in self.texts("#table-compact-meshes tbody td:nth-child(2)")]
        self.assertEqual(numbers, sorted(numbers, reverse=True))
        self.assertEqual(len(self.browser.find_elements(By.CSS_SELECTOR, "#table-compact-meshes tbody td:nth-child(2) strong")), 1)
