#!/usr/bin/env python3
"""Opens a cohort's page from the disk in headless Chromium, with the network off, and uses it as a reader does.

usage: cohort_in_browser.py cohort.html [--cases N] [--first ID] [--no-pictures] [--picture FILE.png] [--most-seconds S]

Fails (exit 1) when the console holds an error, when anything outside of the cohort's folder is asked for, when the page takes longer
than --most-seconds (3) to be ready, or when filter, order, chart or links do not do what they should. --first: the id that has to be
the first in the table of cases. Exits 77 when Chromium, its driver or Selenium are absent.
"""
import argparse
import json
import os
import shutil
import sys
import tempfile
import time

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.by import By
    from selenium.webdriver.support.ui import Select
except ImportError as error:
    print(f"SKIPPED: {error}; install python3-selenium")
    sys.exit(77)

arguments = argparse.ArgumentParser()
arguments.add_argument("page")
arguments.add_argument("--cases", type=int)
arguments.add_argument("--first")
arguments.add_argument("--no-pictures", action="store_true")
arguments.add_argument("--picture")
arguments.add_argument("--most-seconds", type=float, default=3)
options = arguments.parse_args()

chromium, chromedriver = shutil.which("chromium"), shutil.which("chromedriver")
if not chromium or not chromedriver:
    print("SKIPPED: no chromium or no chromedriver; install chromium and chromium-driver")
    sys.exit(77)

problems = []


def check(fine, text):
    print(("ok     " if fine else "FAILED ") + text)
    if not fine:
        problems.append(text)


def open_browser(profile):
    chrome = Options()
    chrome.binary_location = chromium
    for flag in ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync",
                 "--disable-dev-shm-usage", "--force-prefers-reduced-motion", "--window-size=1280,1400", "--user-data-dir=" + profile,
                 # No name is found and no proxy answers: the network is off.
                 "--host-resolver-rules=MAP * ~NOTFOUND", "--proxy-server=127.0.0.1:9"]:
        chrome.add_argument(flag)
    chrome.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    return webdriver.Chrome(service=Service(chromedriver), options=chrome)


def rows(browser, shown=True):
    return browser.execute_script("return [...document.querySelectorAll('#case-table tbody tr')]" + (".filter(r => !r.hidden)" if shown else "") + ".map(r => r.cells[1].textContent)")


def chart_hash(browser):
    browser.execute_async_script("const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 50)));")
    return browser.execute_script("""
        const text = document.getElementById('strip').toDataURL();
        let hash = 5381;
        for (let i = 0; i < text.length; ++i) hash = (hash * 33 + text.charCodeAt(i)) % 4294967296;
        return hash;""")


def type_filter(browser, text):
    browser.execute_script("const f = document.getElementById('filter'); f.value = arguments[0]; f.dispatchEvent(new Event('input'));", text)


def use_page(browser):
    all_rows = rows(browser)
    failed = browser.execute_script("return document.querySelectorAll('#failed tbody tr').length")
    if options.cases is not None:
        check(len(all_rows) + failed == options.cases, f"{len(all_rows)} cases and {failed} without a result are listed")
    if options.first:
        check(all_rows[0] == options.first, "the first of the cases is " + all_rows[0])
    check(browser.execute_script("return [...document.querySelectorAll('img')].every(i => i.alt)"), "every picture has a text")
    check(browser.execute_script("return [...document.querySelectorAll('canvas')].every(c => c.getAttribute('aria-label'))"), "every canvas has a text")
    check(browser.execute_script("return [...document.querySelectorAll('input, select')].every(i => i.labels.length > 0 || i.getAttribute('aria-label'))"), "every control has a label")
    check(browser.execute_script("return document.documentElement.scrollWidth <= window.innerWidth"), "nothing is wider than the window")
    if not options.no_pictures:
        state = browser.execute_async_script("""
            const done = arguments[0], img = document.querySelector('#case-table img');
            if (!img) return done('none');
            img.loading = 'eager';
            const say = () => done(img.naturalWidth + 'x' + img.naturalHeight);
            if (img.complete && img.naturalWidth) say(); else { img.onload = say; img.onerror = () => done('error'); setTimeout(() => done('timeout'), 5000); }""")
        check(state == "192x144", "the first picture is there: " + state)
    last = all_rows[-1]
    type_filter(browser, last)
    check(last in rows(browser) and all(last.lower() in r.lower() for r in rows(browser)), "the filter finds " + last)
    type_filter(browser, "")
    check(len(rows(browser)) == len(all_rows), "and shows all again")
    head = browser.find_element(By.CSS_SELECTOR, "#case-table th[data-sort=text]")
    browser.execute_script("arguments[0].querySelector('button').click()", head)
    check(sorted(rows(browser)) == sorted(all_rows) and (len(all_rows) < 2 or rows(browser) != all_rows), "a click on a head orders the table")
    check(head.get_attribute("aria-sort") == "descending", "and says so")
    metric = Select(browser.find_element(By.ID, "metric"))
    check(len(metric.options) >= 5, f"{len(metric.options)} figures have distributions")
    seen = set()
    for i in range(len(metric.options)):
        metric.select_by_index(i)
        seen.add(chart_hash(browser))
    check(len(seen) > len(metric.options) // 2, f"{len(seen)} different charts of {len(metric.options)} figures")
    metric.select_by_index(0)
    before = chart_hash(browser)
    browser.execute_script("document.getElementById('logarithmic').click()")
    check(chart_hash(browser) != before, "the scale can be changed")
    check(browser.execute_script("return document.querySelectorAll('#strip-table tbody tr').length") >= 1, "the chart has a table")


profile = tempfile.mkdtemp(prefix="cohort_in_browser_")
browser = open_browser(profile)
try:
    browser.get("data:text/html,<p>ready</p>")
    start = time.time()
    browser.get("file://" + os.path.abspath(options.page))
    while browser.execute_script("return document.documentElement.dataset.ready") != "yes" and time.time() - start < 60:
        time.sleep(0.02)
    took = time.time() - start
    size = os.path.getsize(options.page)
    check(browser.execute_script("return document.documentElement.dataset.ready") == "yes", "the page is ready")
    check(took < options.most_seconds, f"after {took:.2f} s; {size / 1e6:.2f} MB")
    if options.picture:
        browser.save_screenshot(options.picture)
        browser.execute_script("document.getElementById('distributions').scrollIntoView({behavior: 'instant'})")
        time.sleep(0.3)
        browser.save_screenshot(options.picture.replace(".png", "_chart.png"))
    use_page(browser)
    for entry in browser.get_log("browser"):
        check(entry["level"] not in ("SEVERE", "ERROR"), "console: " + entry["level"] + " " + entry["message"])
    asked = set()
    for entry in browser.get_log("performance"):
        message = json.loads(entry["message"])["message"]
        if message["method"] == "Network.requestWillBeSent" and message["params"]["documentURL"].startswith("file://"):
            asked.add(message["params"]["request"]["url"])
    folder = "file://" + os.path.dirname(os.path.abspath(options.page)) + "/"
    outside = [u for u in asked if not u.startswith(("data:", "blob:", folder))]
    check(not outside, "nothing outside of the cohort's folder is asked for" + (": " + ", ".join(sorted(outside)[:5]) if outside else ""))
finally:
    browser.quit()
    shutil.rmtree(profile, ignore_errors=True)
print(f"{len(problems)} problems")
sys.exit(1 if problems else 0)
