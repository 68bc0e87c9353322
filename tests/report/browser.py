# SPDX-License-Identifier: GPL-3.0-or-later
"""Headless Chromium on pages from disk, with everything that it logs and asks for."""

import hashlib
import io
import json
import shutil
import tarfile
import unittest
import urllib.request

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
except ImportError:
    webdriver = None

AXE = "https://registry.npmjs.org/axe-core/-/axe-core-4.10.2.tgz"  # looks for what keeps people from using a page
AXE_SHA256 = "9ea2d2d6917da998122bdacfd3b473e31ead53f4b87146c716a12edf89158100"
DRIVER, CHROMIUM = shutil.which("chromedriver"), shutil.which("chromium")
AVAILABLE = webdriver is not None and DRIVER is not None and CHROMIUM is not None
needs_browser = unittest.skipUnless(AVAILABLE, "needs Debian's chromium, chromium-driver and python3-selenium")


def start(width=1280, height=1000):
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--enable-unsafe-swiftshader",
                     "--disable-background-networking", f"--window-size={width},{height}"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    browser = webdriver.Chrome(service=Service(DRIVER), options=options)
    browser.set_page_load_timeout(600)
    browser.set_script_timeout(600)
    return browser


def settle(browser):
    """Until the page is laid out, its observers of sizes have been told, and what these changed is laid out, too: two frames later."""
    browser.execute_async_script("const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done)))")


def kinds_of_pages(report):
    """One page of each kind, within the report."""
    return [path.name for path in sorted(report.glob("*.html"))] + [f"shapes/{path.name}" for path in sorted(report.glob("shapes/*.html"))[:1]]


def console_errors(browser):
    """Warnings of the graphics driver say nothing about the pages."""
    return [entry["message"] for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]


def requests(browser):
    """Addresses that pages asked for since the last call."""
    found = []
    for entry in browser.get_log("performance"):
        message = json.loads(entry["message"])["message"]
        if message["method"] == "Network.requestWillBeSent":
            found.append(message["params"]["request"]["url"])
    return found


def axe():
    """The script of axe-core, from npm's registry. SkipTest if it cannot be reached."""
    try:
        with urllib.request.urlopen(AXE, timeout=120) as answer:
            packed = answer.read()
    except OSError:
        raise unittest.SkipTest("npm's registry cannot be reached") from None
    assert hashlib.sha256(packed).hexdigest() == AXE_SHA256, f"{AXE} is another file than the one that was looked at"
    with tarfile.open(fileobj=io.BytesIO(packed)) as files:
        return files.extractfile("package/axe.min.js").read().decode("utf-8")


def findings(browser, script, page):
    """(colour scheme, what is serious) of a page: by every rule where it is light, by those of colours where it is dark."""
    browser.get(page.as_uri())
    browser.execute_script(script)
    for scheme, rules in (("light", {}), ("dark", {"runOnly": ["color-contrast", "link-in-text-block"]})):
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": scheme}]})
        found = browser.execute_async_script("axe.run(arguments[0]).then(arguments[1])", {**rules, "preload": False})  # a page from disk loads no text
        yield scheme, [f"{finding['id']}: {finding['help']}: {[node['target'] for node in finding['nodes']][:3]}"
                       for finding in found["violations"] if finding["impact"] in ("serious", "critical")]
