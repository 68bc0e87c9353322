#!/usr/bin/python3 -B
# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens every page of reports in headless Chromium, from disk: pages, time, and whatever is wrong with them.

open_report.py REPORT...    exit status 1 if a page logs an error or asks for something outside its folder
"""

import sys
import time
from pathlib import Path

import browser as chromium


def wrong(browser, report, page):
    """What is wrong with a page, one line each."""
    browser.get(page.as_uri())
    if browser.execute_script("return document.querySelector('.viewer') !== null"):
        deadline = time.monotonic() + 600
        while browser.execute_script("return document.querySelector('.viewer').dataset.ready") != "yes":
            if time.monotonic() > deadline:
                yield "the viewer does not start"
                break
            time.sleep(0.05)
    yield from chromium.console_errors(browser)
    for url in chromium.requests(browser):
        if not url.startswith((report.as_uri(), "data:")):
            yield f"asks for {url}"


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    browser, found = chromium.start(), 0
    try:
        for report in map(Path.resolve, map(Path, sys.argv[1:])):
            begin, pages = time.monotonic(), sorted(report.rglob("*.html"))
            for page in pages:
                for line in wrong(browser, report, page):
                    print(f"{page}: {line}")
                    found += 1
            print(f"{report}: {len(pages)} pages opened in {time.monotonic() - begin:.0f} s")
    finally:
        browser.quit()
    print(f"{found} findings")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
