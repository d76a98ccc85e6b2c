"""The HTML report in headless Chromium: it loads without the network, hovers and turns."""

import json
import re
import shutil

import h5py
import pytest
from post_runs import bar_deck
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import WebDriverWait

pytest_plugins = ["lost_point_runs"]
OPTIONS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-dev-shm-usage",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--window-size=1280,900",
)
PATIENCE = 60  # [s]
LOCAL = ("data:", "blob:", "about:", "chrome:", "devtools:")
HOSTILE = (
    "</script><script>document.title='taken';window.taken=1</script><img src=x onerror=taken=1>"
)


def program(name, package):
    """Path of a program of the browser; the test fails without it."""
    path = shutil.which(name)
    if path is None:
        pytest.fail(f"{name} is not there: install it (Debian: apt-get install {package})", False)
    return path


@pytest.fixture(scope="module")
def chromium():
    """Chromium without a window, started once."""
    options = webdriver.ChromeOptions()
    options.binary_location = program("chromium", "chromium")
    for option in OPTIONS:
        options.add_argument(option)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(
        options=options, service=Service(program("chromedriver", "chromium-driver"))
    )
    yield driver
    driver.quit()


@pytest.fixture
def load(chromium, post, tmp_path):
    """load(job, *options): writes the page, opens it from the disk and waits for all plots."""

    def open_page(job, *options):
        path = tmp_path / "page.html"
        code, _, err = post("report", job, "-o", path, *options)
        assert code == 0, err
        for kind in ("browser", "performance"):
            chromium.get_log(kind)  # forgets what came before
        chromium.get(path.as_uri())
        WebDriverWait(chromium, PATIENCE).until(all_are_drawn)
        return path.as_uri()

    return open_page


def all_are_drawn(driver):
    """Whether plotly has drawn every plot."""
    return driver.execute_script(
        "const all = [...document.querySelectorAll('div.plot')];"
        "return all.length > 0 && all.every((one) => one._fullLayout && one.querySelector('svg'));"
    )


def complaints(driver):
    """Errors of the console."""
    return [entry for entry in driver.get_log("browser") if entry["level"] == "SEVERE"]


def requests(driver):
    """Addresses that the page asked for, but those inside the page itself."""
    messages = [json.loads(entry["message"])["message"] for entry in driver.get_log("performance")]
    urls = [
        message["params"]["request"]["url"]
        for message in messages
        if message["method"] == "Network.requestWillBeSent"
    ]
    urls += [
        message["params"]["url"]
        for message in messages
        if message["method"] == "Network.webSocketCreated"
    ]
    return [url for url in urls if not url.startswith(LOCAL)]


def hover_over(driver, plot, trace, point):
    """Moves the mouse onto a point of a curve; the text of the hover label."""
    element = driver.find_element(By.ID, plot)
    driver.execute_script(
        "document.documentElement.style.scrollBehavior = 'auto';"
        "arguments[0].scrollIntoView({block: 'center'});",
        element,
    )
    x, y = driver.execute_script(
        "const [plot, trace, point] = arguments;"
        "const {xaxis, yaxis, _size} = plot._fullLayout;"
        "const data = plot._fullData[trace];"
        "const box = plot.getBoundingClientRect();"
        "return [_size.l + xaxis.d2p(data.x[point]) - box.width / 2,"
        " _size.t + yaxis.d2p(data.y[point]) - box.height / 2];",
        element,
        trace,
        point,
    )
    move = ActionChains(driver).move_to_element_with_offset(element, round(x) - 8, round(y) - 8)
    move.move_by_offset(8, 8).perform()
    label = WebDriverWait(driver, PATIENCE).until(
        lambda d: d.find_elements(By.CSS_SELECTOR, f"#{plot} .hoverlayer .hovertext")
    )
    lines = driver.execute_script(
        "return [...arguments[0].querySelectorAll('tspan.line')].map((one) => one.textContent);",
        label[0],
    )
    return [line.replace("−", "-") for line in lines]  # noqa: RUF001


@pytest.mark.parametrize(
    "any_job", ["footing", "stretch", "strip-footing", "bar", "single", "killed"], indirect=True
)
def test_page_loads_without_complaint_and_without_any_request(chromium, load, any_job):
    address = load(any_job)
    assert complaints(chromium) == []
    assert requests(chromium) == [address]


def test_hover_shows_the_history_with_units(chromium, load, bar):
    load(bar)
    with h5py.File(bar.with_suffix(".vtkhdf"), "r") as file:
        force = file["tessera/history/RF1[X1]"][2]
        moved = file["tessera/history/U1[X1]"][2]
    lines = hover_over(chromium, "reaction", 0, 2)
    found = [re.fullmatch(r"(\S+) = (\S+) (\S+)", line).groups() for line in lines[:2]]
    assert [(name, unit) for name, _, unit in found] == [("RF1[X1]", "kN/m"), ("U1[X1]", "m")]
    assert float(found[0][1]) == pytest.approx(force, rel=1e-5)
    assert float(found[1][1]) == pytest.approx(moved, rel=1e-5)
    assert lines[2] == "increment 2"


def test_no_button_sends_anything_away(chromium, load, bar):
    load(bar)
    titles = chromium.execute_script(
        "return [...document.querySelectorAll('.modebar-btn')]"
        ".map((one) => one.getAttribute('data-title') || one.ariaLabel || '');"
    )
    assert titles
    assert not [title for title in titles if re.search("share|cloud|edit|plotly", title, re.I)]


def camera_of(driver):
    """The direction that the view is seen from."""
    return driver.execute_script(
        "return document.getElementById('view')._fullLayout.scene._scene.getCamera().eye;"
    )


def test_view_is_turned_with_the_mouse(chromium, load, example):
    load(example("stretch", "fbar"))
    view = chromium.find_element(By.ID, "view")
    chromium.execute_script(
        "document.documentElement.style.scrollBehavior = 'auto';"
        "arguments[0].scrollIntoView({block: 'center'});",
        view,
    )
    has_webgl = chromium.execute_script(
        "const canvas = arguments[0].querySelector('canvas');"
        "return Boolean(canvas && (canvas.getContext('webgl') || canvas.getContext('webgl2')));",
        view,
    )
    assert has_webgl
    before = camera_of(chromium)
    drag = ActionChains(chromium).move_to_element_with_offset(view, -60, 20).click_and_hold()
    for _ in range(6):
        drag.move_by_offset(25, 4)
    drag.release().perform()
    WebDriverWait(chromium, PATIENCE).until(
        lambda driver: abs(camera_of(driver)["x"] - before["x"]) > 0.05
    )
    assert complaints(chromium) == []


def test_view_is_not_blank_and_switches_to_points(chromium, load, example):
    load(example("stretch", "fbar"))

    def shown():
        return chromium.execute_script(
            "return document.getElementById('view')._fullData.map((one) => one.visible);"
        )

    assert shown() == [True, False, True]
    buttons = chromium.find_elements(By.CSS_SELECTOR, "#view .updatemenu-button")
    assert len(buttons) == 2
    ActionChains(chromium).scroll_to_element(buttons[1]).click(buttons[1]).perform()
    WebDriverWait(chromium, PATIENCE).until(lambda _: shown() == [False, True, True])
    colors = chromium.execute_async_script(
        "const done = arguments[0];"
        "Plotly.toImage('view', {format: 'png', width: 400, height: 300}).then((url) => {"
        "  const image = new Image();"
        "  image.onload = () => {"
        "    const canvas = document.createElement('canvas');"
        "    canvas.width = 400; canvas.height = 300;"
        "    const context = canvas.getContext('2d');"
        "    context.drawImage(image, 0, 0);"
        "    const data = context.getImageData(0, 0, 300, 300).data;"
        "    const seen = new Set();"
        "    for (let i = 0; i < data.length; i += 4)"
        "      seen.add(data.slice(i, i + 3).join());"
        "    done(seen.size);"
        "  };"
        "  image.src = url;"
        "});"
    )
    assert colors > 50


def test_hostile_heading_does_not_run(chromium, load, run_deck, tmp_path):
    deck = bar_deck(heading=HOSTILE).replace("FORCE=kN", f'FORCE="{HOSTILE}"')
    address = load(run_deck(tmp_path, deck))
    assert chromium.execute_script("return typeof window.taken;") == "undefined"
    assert chromium.title == f"{HOSTILE} – bar"  # noqa: RUF001
    assert chromium.find_element(By.TAG_NAME, "h1").text == HOSTILE
    assert complaints(chromium) == []
    assert requests(chromium) == [address]


@pytest.mark.parametrize("width", [1280, 400])
def test_page_is_no_wider_than_the_window(chromium, load, bar, width):
    metrics = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 600}
    chromium.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
    try:
        load(bar)
        widths = chromium.execute_script(
            "const page = document.documentElement;"
            "const plots = [...document.querySelectorAll('div.plot svg.main-svg')];"
            "return [page.scrollWidth, ...plots.map((one) => one.getBoundingClientRect().right)];"
        )
        assert max(widths) <= width
        sizes = chromium.execute_script(
            "return [...document.querySelectorAll('p, td, th, .plot text')]"
            ".filter((one) => one.textContent.trim() && one.getClientRects().length)"
            ".map((one) => parseFloat(getComputedStyle(one).fontSize));"
        )
        assert min(sizes) >= 10.0
    finally:
        chromium.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
