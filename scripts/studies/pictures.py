# SPDX-License-Identifier: GPL-3.0-or-later
# Imported by scripts/figures.
"""Pictures of the report, in headless Chromium."""

import io
import sys

from PIL import Image, ImageOps
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import WebDriverWait

from .common import ROOT

sys.path.insert(0, str(ROOT / "tests/report"))

import browser as chromium  # noqa: E402


def pictures(demo, to):
    report = demo / "out/report"

    def save(png, name, part=None):
        image = Image.open(io.BytesIO(png)).convert("RGB").crop(part)
        ImageOps.expand(image, 16, "white").save(to / name, optimize=True)

    to.mkdir(parents=True, exist_ok=True)
    browser = chromium.start(1280, 1700)
    try:
        browser.get((report / "index.html").as_uri())
        chromium.settle(browser)
        save(browser.get_screenshot_as_png(), "report_first.png", (0, 0, 1280, 770))
        browser.get((report / "paper.html").as_uri())
        save(browser.find_element(By.ID, "figure-1").screenshot_as_png, "report_examples.png")
        shapes = report / "shapes"
        browser.get(
            next(
                page for page in (shapes / "lion-head.html", *sorted(shapes.glob("*.html"))) if page.is_file()
            ).as_uri()
        )
        viewer = browser.find_element(By.CSS_SELECTOR, ".viewer")
        WebDriverWait(browser, 60).until(lambda _: viewer.get_attribute("data-ready") == "yes")
        # down to the first maps
        save(browser.get_screenshot_as_png(), "report_shape.png", (60, 0, 1220, 1150))
    finally:
        browser.quit()
