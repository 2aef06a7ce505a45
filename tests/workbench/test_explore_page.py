"""The live page in a real browser."""

import json
import shutil
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("workbench.web.live.server", reason="the extra explore is not installed", exc_type=ImportError)
pytest.importorskip("selenium", reason="selenium is not installed: pip install '.[test]'")

from matplotlib.image import imread
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from studies.loader import loads
from tests.workbench.live import served
from tests.workbench.pictures import share_of_hue
from workbench.figures import style

BROWSER, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
pytestmark = pytest.mark.skipif(
    not (BROWSER and DRIVER), reason="there is no Chromium here: apt-get install chromium chromium-driver"
)
FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader", "--disable-quic",
         "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync",
         "--window-size=1500,1100")  # fmt: skip
PATIENCE = 600  # s that anything is waited for, on a machine with much else to do


class Page:
    """A tab with the live page in it."""

    def __init__(self, driver: Any) -> None:
        self.driver = driver
        self.tab = driver.current_window_handle

    def __call__(self, script: str, *args: Any) -> Any:
        self.driver.switch_to.window(self.tab)
        return self.driver.execute_script(script, *args)

    def until(self, condition: Callable[[], Any], what: str) -> Any:
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            if found := condition():
                return found
            time.sleep(0.03)
        pytest.fail(f"the page does not come to {what}: {self('return document.body.innerText')[:600]}")

    def drawn(self) -> str:
        """Waits until nothing is asked or about to be; returns the ticket of the shape that is drawn."""
        self.until(lambda: self("return view !== null && !busy && !again && page.head.ticket"), "a shape")
        return str(self("return page.head.ticket"))

    def slide(self, name: str, share: int) -> None:
        self("const s = document.getElementById('s-' + arguments[0]); s.value = arguments[1];"
             "s.dispatchEvent(new Event('input', { bubbles: true }));", name, share)  # fmt: skip

    def click(self, name: str) -> None:
        """As a person does: the browser allows downloads and copies only then."""
        self.driver.switch_to.window(self.tab)
        self.driver.find_element(By.ID, name).click()

    def type(self, name: str, text: str) -> None:
        self.driver.switch_to.window(self.tab)
        field = self.driver.find_element(By.ID, f"n-{name}")
        field.send_keys(Keys.CONTROL, "a")
        field.send_keys(text or Keys.DELETE, Keys.TAB)

    def points(self) -> np.ndarray:
        """The corners of the rod in the browser's own scene."""
        return np.array(self("return Array.from(actors.rod.getMapper().getInputData(0).getPoints().getData())"))


@pytest.fixture(scope="module")
def port() -> Iterator[int]:
    with served() as port:
        yield port


@pytest.fixture(scope="module")
def driver(tmp_path_factory) -> Iterator[Any]:
    options = webdriver.ChromeOptions()
    options.binary_location = BROWSER
    for flag in (*FLAGS, f"--user-data-dir={tmp_path_factory.mktemp('chromium')}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    folder = str(tmp_path_factory.mktemp("downloads"))
    options.add_experimental_option("prefs", {"download.default_directory": folder})
    driver = webdriver.Chrome(options=options, service=Service(DRIVER))
    driver.folder = Path(folder)
    try:
        yield driver
    finally:
        driver.quit()


@pytest.fixture
def page(driver, port) -> Iterator[Page]:
    """A fresh page, whose console must have stayed without errors and which must have asked nobody else."""
    driver.switch_to.new_window("tab")
    found = Page(driver)
    driver.get_log("browser"), driver.get_log("performance")
    driver.get(f"http://127.0.0.1:{port}/")
    found.drawn()
    yield found
    errors = [entry["message"] for entry in driver.get_log("browser") if entry["level"] == "SEVERE"]
    expected = "the server responded with a status of 422"  # Chromium says so of every refusal
    assert [error for error in errors if expected not in error] == []
    messages = [json.loads(entry["message"])["message"] for entry in driver.get_log("performance")]
    asked = {m["params"]["request"]["url"] for m in messages if m["method"] == "Network.requestWillBeSent"}
    own = (f"http://127.0.0.1:{port}/", "data:", "blob:", "chrome://")
    assert [url for url in asked if not url.startswith(own)] == []
    assert any(url.endswith("/shape") for url in asked)


def test_the_page_draws_a_rod_and_says_what_it_is(page, tmp_path) -> None:
    page.until(lambda: "max κ" in page("return document.getElementById('numbers').innerText"), "its observables")
    assert "6" in page("return document.getElementById('numbers').innerText")
    assert page("return document.querySelectorAll('.diagram path').length") == 4
    page.driver.save_screenshot(str(tmp_path / "page.png"))
    picture = imread(tmp_path / "page.png")[:, :, :3]
    assert share_of_hue(picture, style.LIFTED) > 0.01
    assert share_of_hue(picture, style.PUSHED) > 0.003


def test_a_slider_moves_the_shape(page) -> None:
    before, points = page.drawn(), page.points()
    page.slide("E", 700)
    page.until(lambda: page.drawn() != before, "another shape")
    E = page("return page.state.base.E")
    assert pytest.approx(1.07e4 / 5 * 25**0.7, rel=1e-4) == E
    assert np.abs(page.points() - points).max() > 0.1
    assert float(page("return document.getElementById('n-E').value")) == pytest.approx(E)


def test_what_outgrows_the_view_is_seen_from_farther(page) -> None:
    page("page.begin('cable')")
    page.until(lambda: page("return page.units.length") == "mm" and page.drawn(), "the cable")
    scale, before = page("return view.renderer.getActiveCamera().getParallelScale()"), page.drawn()
    page.slide("R", 505)  # hardly
    page.until(lambda: page.drawn() != before, "a drum of 183 mm")
    assert page("return view.renderer.getActiveCamera().getParallelScale()") == scale
    before = page.drawn()
    page.slide("R", 900)
    page.until(lambda: page.drawn() != before, "a drum of 650 mm")
    assert page("return view.renderer.getActiveCamera().getParallelScale()") > 2.5 * scale


def test_of_many_moves_the_last_is_drawn(page) -> None:
    for share in (100, 900, 300, 800, 620):
        page.slide("R", share)
    page.drawn()
    R = page("return page.state.base.R")
    assert pytest.approx(0.15 * 25**0.62, rel=1e-4) == R
    rho = np.hypot(*page.points().reshape(-1, 3).T[:2]).min()
    assert rho == pytest.approx(R, rel=1e-5)


@pytest.mark.parametrize(
    "name, text, sentence", [("E", "-1", "Rod.E must be positive"), ("R", "", "R must be a number, got nothing")]
)
def test_bad_input_is_explained_in_place_and_the_last_good_shape_stays(page, name, text, sentence) -> None:
    before, points = page.drawn(), page.points()
    page.type(name, text)
    told = page.until(
        lambda: page("return document.getElementById('why-' + arguments[0])?.innerText", name), "a reason"
    )
    assert sentence in told
    assert sentence in page("return document.getElementById('problem').innerText")
    assert page("return document.getElementById('n-' + arguments[0]).getAttribute('aria-invalid')", name) == "true"
    np.testing.assert_array_equal(page.points(), points)
    page.type(name, "0.9")
    page.until(lambda: page.drawn() != before and not page("return document.getElementById('problem')"), "a good shape")


def test_where_drawing_is_slow_a_lighter_tube_is_drawn_until_the_slider_rests(page) -> None:
    drawn = "return actors.rod.getMapper().getInputData(0).getPolys().getData().length"
    whole = page(drawn)
    page("keys.coarse = 2; PATIENCE.whole = 1e6; waiting.whole = null")  # as if it were, and no end to the moving
    before = page.drawn()
    page.slide("E", 600)
    page.until(lambda: page.drawn() != before, "another shape")
    assert page(drawn) < 0.51 * whole
    assert page(
        "return waiting.whole !== null"
    )  # fewer pixels, too; the browser may lay the page out at any time since
    size = "view.openglRenderWindow.getSize()[0]"
    few, all_ = page(
        f"page.sketch(); const few = {size}; clearTimeout(waiting.whole); page.whole(); return [few, {size}]"
    )
    assert page(drawn) == whole
    assert all_ > 1.9 * few


def test_two_tabs_do_not_disturb_each_other(page, driver, port) -> None:
    points = page.points()
    driver.switch_to.new_window("tab")
    other = Page(driver)
    driver.get(f"http://127.0.0.1:{port}/")
    other.drawn()
    other.slide("E", 900)
    other("document.getElementById('preset').value = 'dna'; page.begin('dna')")
    other.until(lambda: other("return page.units.length") == "nm" and other.drawn(), "the DNA")
    np.testing.assert_array_equal(page.points(), points)
    assert page("return page.units.length") == "cm"
    before = page.drawn()
    page.slide("E", 520)
    page.until(lambda: page.drawn() != before, "another shape")
    assert other("return page.units.length") == "nm"
    assert other("return page.state.base.E") == 262.0


def test_every_preset_is_drawn_and_its_equilibria_can_be_stepped_through(page) -> None:
    for name in page("return page.presets.map((one) => one.name)"):
        before = page.drawn()
        page("page.begin(arguments[0])", name)
        page.until(lambda before=before: page.drawn() != before, name)
        assert page("return page.wrong.sentence") == ""
    count = page.until(lambda: page("return page.list.length"), "the equilibria")
    assert count == 5
    assert page("return page.here") == 0
    before, points = page.drawn(), page.points()
    page.click("next")
    page.until(lambda: page.drawn() != before, "the next one")
    assert page("return page.here") == 1
    assert np.abs(page.points() - points).max() > 1


def test_a_rod_held_by_both_its_ends_keeps_its_shape(page) -> None:
    beta = page("return Array.from(page.curves.beta)")
    page.click("by-ends")
    page.until(lambda: page("return page.head.problem") == "ends", "both ends")
    np.testing.assert_allclose(
        page("return Array.from(page.curves.beta)")[::2], beta, atol=1e-3
    )  # degrees, single precision


def test_a_link_brings_back_the_rod(page, driver) -> None:
    before = page.drawn()
    page.slide("L", 650)
    page.until(lambda: page.drawn() != before, "another shape")
    page.click("copy-link")
    points, link = page.points(), page("return location.href")
    driver.switch_to.new_window("tab")
    other = Page(driver)
    driver.get(link)
    other.drawn()
    np.testing.assert_array_equal(other.points(), points)


def test_a_broken_link_is_explained_and_the_page_still_works(page, driver, port) -> None:
    driver.get("about:blank")
    driver.get(f"http://127.0.0.1:{port}/#nonsense")
    page.drawn()
    assert page("return page.head.outcome") == "solved"


def test_the_copied_study_is_the_rod_that_is_shown(page) -> None:
    page.type("E", "20000")
    page.until(
        lambda: page("return page.head.fields && page.state.base.E") == 20000 and page.drawn(), "the stiffer rod"
    )
    page.click("copy-study")
    text = page.until(lambda: page("return document.getElementById('study-text').value"), "the study")
    study = loads(text)
    assert (study.base.E, study.reading) == (20000.0, "force-first/tension/paper")


def test_picture_and_csv_are_downloaded(page, driver) -> None:
    for button, ending in (("picture", "png"), ("csv", "csv")):
        page.click(button)
        path = driver.folder / f"table1.{ending}"
        page.until(lambda path=path: path.exists() and path.stat().st_size, f"the {ending}")
    picture = imread(driver.folder / "table1.png")[:, :, :3]
    assert share_of_hue(picture, style.LIFTED) > 0.02
    assert (driver.folder / "table1.csv").read_text().startswith("s [cm],x [cm],")


def test_what_cannot_be_downloaded_is_explained(page) -> None:
    page.click("step")
    told = page.until(lambda: page("return document.getElementById('message').innerText"), "a reason")
    assert "no solid: the rod passes through itself" in told or "Open Cascade" in told
