#!/usr/bin/env python3
"""Opens a report page from the disk in headless Chromium, with the network off, and uses it as a reader does.

usage: report_in_browser.py REPORT.html [--no-webgl] [--picture FILE.png] [--colour NAME]

Fails (exit 1) when the console holds an error, when anything outside of the file is asked for, or when the slider, a
label's switch, the cutting plane, a jump to a worst place or a sort does not change what is shown. --no-webgl checks that
the page says so and stays usable. Exits 77 when Chromium, its driver or Selenium are absent.
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
    from selenium.webdriver.common.keys import Keys
    from selenium.webdriver.support.ui import Select
except ImportError as error:
    print(f"SKIPPED: {error}; install python3-selenium")
    sys.exit(77)

arguments = argparse.ArgumentParser()
arguments.add_argument("report")
arguments.add_argument("--no-webgl", action="store_true")
arguments.add_argument("--picture")
arguments.add_argument("--colour", help="of the 3-D view in the end")
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
    flags = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
             "--disable-component-update", "--disable-sync", "--disable-dev-shm-usage", "--force-prefers-reduced-motion",
             "--window-size=1280,1000",
             "--user-data-dir=" + profile,
             # No name is found and no proxy answers: the network is off.
             "--host-resolver-rules=MAP * ~NOTFOUND", "--proxy-server=127.0.0.1:9"]
    flags.append("--disable-3d-apis" if options.no_webgl else "--enable-unsafe-swiftshader")
    for flag in flags:
        chrome.add_argument(flag)
    chrome.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    return webdriver.Chrome(service=Service(chromedriver), options=chrome)


def is_ready(browser):
    return browser.execute_script("return document.documentElement.dataset.ready === 'yes'")


def settle(browser):
    browser.execute_async_script("const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 120)));")


def picture_of(browser, canvas):
    """A number that stands for what the canvas shows."""
    settle(browser)
    return browser.execute_script("""
        const views = window.reportViews, canvas = document.getElementById(arguments[0]);
        if (arguments[0] === 'solid-canvas') views.solid.renderNow();
        const text = canvas.toDataURL();
        let hash = 5381;
        for (let i = 0; i < text.length; ++i) hash = (hash * 33 + text.charCodeAt(i)) % 4294967296;
        return hash;""", canvas)


def ink_of(browser, canvas):
    """Share of the canvas that is not white."""
    return browser.execute_script("""
        const canvas = document.getElementById(arguments[0]);
        if (arguments[0] === 'solid-canvas') window.reportViews.solid.renderNow();
        const copy = document.createElement('canvas');
        copy.width = canvas.width; copy.height = canvas.height;
        const g = copy.getContext('2d');
        g.drawImage(canvas, 0, 0);
        const d = g.getImageData(0, 0, copy.width, copy.height).data;
        let n = 0;
        for (let i = 0; i < d.length; i += 4) if (d[i] < 245 || d[i + 1] < 245 || d[i + 2] < 245) ++n;
        return n / (d.length / 4);""", canvas)


def set_range(browser, name, value):
    browser.execute_script("const s = document.getElementById(arguments[0]); s.value = arguments[1]; s.dispatchEvent(new Event('input'));", name, value)


def changes(browser, canvas, text, action):
    before = picture_of(browser, canvas)
    action()
    check(picture_of(browser, canvas) != before, text)


def use_sections(browser):
    check(ink_of(browser, "section-canvas") > 0.01, "the section picture shows something")
    slider = browser.find_element(By.ID, "section-slider")
    text = browser.find_element(By.ID, "section-text").text
    here = int(slider.get_attribute("value"))
    changes(browser, "section-canvas", "the slider changes the section", lambda: set_range(browser, "section-slider", here - 2 if here > 1 else here + 2))
    check(browser.find_element(By.ID, "section-text").text != text, "its text changes")
    changes(browser, "section-canvas", "an arrow key moves the slider", lambda: slider.send_keys(Keys.ARROW_RIGHT))
    changes(browser, "section-canvas", "the mesh's cut can be hidden", lambda: browser.find_element(By.ID, "show-cut").click())
    browser.find_element(By.ID, "show-cut").click()
    changes(browser, "section-canvas", "a key zooms", lambda: browser.find_element(By.ID, "section-canvas").send_keys("+"))
    browser.find_element(By.ID, "section-fit").click()
    kept = len(browser.find_elements(By.CSS_SELECTOR, "#kept-sections figure"))
    check(kept > 0, "some sections are kept for printing")


def use_solid(browser):
    check(0.02 < ink_of(browser, "solid-canvas") < 0.9, "the 3-D view shows the mesh, and not only it")
    canvas = browser.find_element(By.ID, "solid-canvas")
    changes(browser, "solid-canvas", "an arrow key turns the mesh", lambda: canvas.send_keys(Keys.ARROW_LEFT))
    axis = Select(browser.find_element(By.ID, "clip-axis"))
    changes(browser, "solid-canvas", "a cut opens the mesh", lambda: axis.select_by_value("x"))
    changes(browser, "solid-canvas", "its slider moves the cut", lambda: set_range(browser, "clip-slider", 350))
    changes(browser, "solid-canvas", "page up moves the cut", lambda: canvas.send_keys(Keys.PAGE_UP))
    text = browser.find_element(By.ID, "clip-text").text
    if browser.execute_script("return window.reportViews.solid.mesh.tets !== null"):
        check("tetrahedra" in text and not text.startswith("0 "), "the cut says how many tets it meets: " + text)
        changes(browser, "solid-canvas", "whole tets are shown", lambda: browser.find_element(By.ID, "clip-whole").click())
    axis.select_by_value("none")
    colour = Select(browser.find_element(By.ID, "solid-colour"))
    changes(browser, "solid-canvas", "colours by quality", lambda: colour.select_by_value("quality"))
    if browser.find_element(By.CSS_SELECTOR, "#solid-colour [value=distance]").is_enabled():
        changes(browser, "solid-canvas", "colours by distance", lambda: colour.select_by_value("distance"))
    for value in ("set", "acts", "modulus", "mises"):
        if browser.find_element(By.CSS_SELECTOR, f"#solid-colour [value={value}]").is_enabled():
            changes(browser, "solid-canvas", "colours by " + value, lambda: colour.select_by_value(value))
            check(len(browser.find_element(By.ID, "solid-scale").text) > 5, "the legend says: " + browser.find_element(By.ID, "solid-scale").text.replace("\n", ", "))
        else:
            print(f"none   no colours by {value}")
    if options.colour:
        colour.select_by_value(options.colour)
    else:
        colour.select_by_value("label")


def use_page(browser):
    title = browser.find_element(By.TAG_NAME, "h1").text
    check(len(title) > 0, "it has a heading: " + title)
    check(browser.execute_script("return [...document.querySelectorAll('img')].every(i => i.alt)"), "every picture has a text")
    check(browser.execute_script("return [...document.querySelectorAll('canvas')].every(c => c.getAttribute('aria-label') || c.getAttribute('aria-hidden'))"),
          "every canvas has a text")
    check(browser.execute_script("return [...document.querySelectorAll('input, select')].every(i => i.labels.length > 0 || i.getAttribute('aria-label'))"),
          "every control has a label")
    check(browser.execute_script("return document.documentElement.scrollWidth <= window.innerWidth"), "nothing is wider than the window")
    check(browser.execute_script("return document.querySelectorAll('#charts canvas').length") >= 2, "the histograms are there")
    use_sections(browser)
    if options.no_webgl:
        check("WebGL" in browser.find_element(By.ID, "solid-missing").text, "it says that there is no WebGL")
        check(not browser.find_element(By.ID, "solid-controls").is_displayed(), "and hides the controls of the 3-D view")
    else:
        use_solid(browser)
    # One label alone, as in 3-D others may hide it; in the section with most in it that has it.
    box = browser.find_element(By.CSS_SELECTOR, "#label-switches input")
    browser.execute_async_script("""
        const [label, done] = arguments, v = window.reportViews.sections;
        (async () => {
          let best = 0, most = 0;
          for (let p = 0; p < v.planes.length; p += 2) {
            const lines = (await v.cut(0, p)).filter(l => v.labels[l.left].label === label || v.labels[l.right].label === label);
            const points = lines.reduce((n, l) => n + l.points.length, 0);
            if (points > most) { most = points; best = p; }
          }
          await v.go(best);
          done();
        })();""", int(box.get_attribute("data-label")))
    browser.find_element(By.ID, "labels-none").click()
    for canvas in ["section-canvas"] + ([] if options.no_webgl else ["solid-canvas"]):
        changes(browser, canvas, "a label is switched on in " + canvas, box.click)
        changes(browser, canvas, "and off again", box.click)
    browser.find_element(By.ID, "labels-all").click()
    show = browser.find_elements(By.CSS_SELECTOR, "#worst-places td.jump button")
    check(len(show) > 0, "worst places are listed")
    changes(browser, "section-canvas", "a button jumps to a worst place", lambda: browser.execute_script("arguments[0].click()", show[-1]))
    rows = lambda: [r.text for r in browser.find_elements(By.CSS_SELECTOR, "#worst-places tbody tr")]
    before = rows()
    head = browser.find_element(By.CSS_SELECTOR, "#worst-places th[data-sort='2'] button")
    browser.execute_script("arguments[0].click(); arguments[0].click()", head)
    check(rows() != before and sorted(rows()) == sorted(before), "a click on a head sorts the table")
    check(browser.find_element(By.CSS_SELECTOR, "#worst-places th[data-sort='2']").get_attribute("aria-sort") == "descending", "and says so")


profile = tempfile.mkdtemp(prefix="report_in_browser_")
browser = open_browser(profile)
try:
    start = time.time()
    browser.get("file://" + os.path.abspath(options.report))
    while not is_ready(browser) and time.time() - start < 120:
        time.sleep(0.1)
    check(is_ready(browser), f"the page is ready after {time.time() - start:.1f} s")
    if not problems:
        use_page(browser)
    if options.picture:
        browser.execute_script("document.getElementById('views').scrollIntoView({behavior: 'instant'})")
        settle(browser)
        browser.save_screenshot(options.picture)
    for entry in browser.get_log("browser"):
        check(entry["level"] not in ("SEVERE", "ERROR"), "console: " + entry["level"] + " " + entry["message"])
    asked = set()
    for entry in browser.get_log("performance"):
        message = json.loads(entry["message"])["message"]
        # The browser's own first tab asks for its own files: only what the page asks for counts.
        if message["method"] == "Network.requestWillBeSent" and message["params"]["documentURL"].startswith("file://"):
            asked.add(message["params"]["request"]["url"])
    outside = [u for u in asked if not u.startswith(("file://", "data:", "blob:"))]
    check(not outside, "nothing outside of the file is asked for" + (": " + ", ".join(outside) if outside else ""))
    files = {u for u in asked if u.startswith("file://")}
    check(len(files) == 1, "and no other file")
finally:
    browser.quit()
    shutil.rmtree(profile, ignore_errors=True)
print(f"{len(problems)} problems")
sys.exit(1 if problems else 0)
