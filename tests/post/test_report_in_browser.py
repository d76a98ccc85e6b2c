"""The report in a browser: no error, no request, values under the mouse, a view that turns."""

import json
import re
import shutil
import time

import h5py
import numpy as np
import pytest
from post_runs import bar_deck
from selenium import webdriver
from selenium.webdriver import ActionChains
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import WebDriverWait

HOSTILE = "</script><script>alert(1)</script><img src=x onerror=alert(2)>"
PATIENCE = 60  # seconds; drawing in 3-D without a graphics card takes some
FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-dev-shm-usage",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--window-size=1280,900",
)


def needed(*names):
    """Path of the first program that there is."""
    for name in names:
        path = shutil.which(name)
        if path:
            return path
    pytest.fail(f"{' or '.join(names)} is not installed: sh tools/setup.sh test", pytrace=False)


@pytest.fixture(scope="module")
def browser():
    """Chromium without a window; it keeps its console and its requests."""
    options = webdriver.ChromeOptions()
    options.binary_location = needed("chromium", "chromium-browser")
    for flag in FLAGS:
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(options, Service(needed("chromedriver")))
    driver.set_page_load_timeout(PATIENCE)
    yield driver
    driver.quit()


def requests(driver):
    """Addresses that the page asked for since the last call."""
    messages = [json.loads(entry["message"])["message"] for entry in driver.get_log("performance")]
    sent = [m["params"] for m in messages if m["method"] == "Network.requestWillBeSent"]
    urls = [one["request"]["url"] for one in sent]
    return [url for url in urls if not url.startswith(("data:", "blob:"))]


def open_page(driver, path):
    """Opens a page and waits until all its plots are drawn."""
    driver.get_log("browser")
    driver.get_log("performance")
    driver.get(path.as_uri())
    drawn = (
        "const plots = [...document.querySelectorAll('div.plot')];"
        "return plots.length > 0 && plots.every(e => e._fullLayout)"
    )
    WebDriverWait(driver, PATIENCE).until(lambda d: d.execute_script(drawn))


@pytest.fixture
def page(browser, post, tmp_path):
    """page(job): the report of a job, open in the browser."""

    def show(job):
        path = tmp_path / "page.html"
        code, _, err = post("report", job, "-o", path)
        assert code == 0, err
        open_page(browser, path)
        return browser

    return show


def middle_of_point(driver, plot, number):
    """Where a point of the first curve of a plot is, from the middle of the plot [pixel]."""
    script = """
        const e = document.getElementById(arguments[0]), l = e._fullLayout, i = arguments[1];
        const trace = e._fullData[0], box = e.getBoundingClientRect();
        return [l.xaxis._offset + l.xaxis.d2p(trace.x[i]) - box.width / 2,
                l.yaxis._offset + l.yaxis.d2p(trace.y[i]) - box.height / 2];
    """
    return [round(value) for value in driver.execute_script(script, plot, number)]


def test_example_opens_without_errors_and_requests(page, example, tmp_path):
    for name in ("footing", "stretch", "strip-footing"):
        driver = page(example(name, "fbar"))
        assert [e for e in driver.get_log("browser") if e["level"] == "SEVERE"] == []
        assert requests(driver) == [(tmp_path / "page.html").as_uri()]
        assert driver.find_element(By.ID, "status").text == "finished"
        assert len(driver.find_elements(By.CSS_SELECTOR, "div.plot .main-svg")) > 3
        loaded = "return [...document.images].every(e => e.complete && e.naturalWidth > 300)"
        assert driver.execute_script(loaded)


def test_killed_and_single_jobs_open_without_errors(page, killed, single):
    for job in (killed, single):
        driver = page(job)
        assert [e for e in driver.get_log("browser") if e["level"] == "SEVERE"] == []
    assert driver.find_element(By.ID, "status").text == "finished"


def test_hover_shows_the_values_of_the_history(page, bar):
    driver = page(bar)
    plot = driver.find_element(By.ID, "reaction")
    driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", plot)
    with h5py.File(f"{bar}.vtkhdf", locking=False) as file:
        history = file["tessera/history"]
        x, y = history["U1[X1]"][3], history["RF1[X1]"][3]
    across, down = middle_of_point(driver, "reaction", 3)
    ActionChains(driver).move_to_element_with_offset(plot, across, down).perform()
    label = WebDriverWait(driver, PATIENCE).until(
        lambda d: d.find_element(By.CSS_SELECTOR, "#reaction .hoverlayer .hovertext")
    )
    numbers = [float(text) for text in re.findall(r"-?\d+\.\d+", label.text.replace("−", "-"))]  # noqa: RUF001
    assert any(number == pytest.approx(x, rel=1e-4) for number in numbers), label.text
    assert any(number == pytest.approx(y, rel=1e-4) for number in numbers), label.text
    assert "kN/m" in label.text


def test_view_turns_with_the_mouse(page, example):
    driver = page(example("stretch", "fbar"))
    view = driver.find_element(By.ID, "view")
    driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", view)
    canvas = driver.find_element(By.CSS_SELECTOR, "#view canvas")
    alive = "const g = arguments[0].getContext('webgl'); return g !== null && !g.isContextLost()"
    assert driver.execute_script(alive, canvas)
    eye = (
        "const c = document.getElementById('view')._fullLayout.scene._scene.getCamera().eye;"
        "return [c.x, c.y, c.z]"
    )
    before = driver.execute_script(eye)
    drag = ActionChains(driver, duration=50).move_to_element(view).click_and_hold()
    for _ in range(10):
        drag = drag.move_by_offset(10, 2)
    drag.release().perform()
    deadline = time.monotonic() + PATIENCE
    while np.allclose(driver.execute_script(eye), before, atol=1e-3):
        assert time.monotonic() < deadline, "the camera has not moved"
        time.sleep(0.1)


def test_hostile_heading_does_not_run(page, run_deck, tmp_path):
    folder = tmp_path / "hostile"
    folder.mkdir()
    driver = page(run_deck(folder, bar_deck(heading=HOSTILE)))
    assert driver.find_element(By.TAG_NAME, "h1").text == HOSTILE  # an alert would raise here
    assert [e for e in driver.get_log("browser") if e["level"] == "SEVERE"] == []


def test_narrow_page_does_not_scroll_sideways(page, bar, tmp_path):
    driver = page(bar)
    driver.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride",
        {"width": 400, "height": 800, "deviceScaleFactor": 1, "mobile": True},
    )
    try:
        open_page(driver, tmp_path / "page.html")
        widths = "return [document.documentElement.scrollWidth, window.innerWidth]"
        content, window = driver.execute_script(widths)
        assert content <= window == 400
    finally:
        driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
