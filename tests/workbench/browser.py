"""Chromium for tests, where it is installed, and axe-core, which judges the accessibility of a page."""

import base64
import hashlib
import json
import re
import shutil
import subprocess
import tarfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

BROWSER, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
MISSING = "there is no Chromium here: apt-get install chromium chromium-driver"
FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader", "--disable-quic",
         "--no-first-run", "--disable-background-networking", "--disable-component-update",
         "--disable-sync")  # fmt: skip
AXE = ("axe-core@4.14.1", "29348999450cdf2849a8e70b7912fc2da85a849da39c0d0d5394f51d4a9ed95c")


@contextmanager
def chromium(profile: Path, size: str, downloads: Path | None = None) -> Iterator[Any]:
    """A browser with a window of `size` ("1500,1100"), or a skipped test. profile: an empty folder."""
    webdriver = pytest.importorskip("selenium.webdriver", reason="pip install '.[test]'")
    if not (BROWSER and DRIVER):
        pytest.skip(MISSING)
    options = webdriver.ChromeOptions()
    options.binary_location = BROWSER
    for flag in (*FLAGS, f"--window-size={size}", f"--user-data-dir={profile}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    if downloads:
        options.add_experimental_option("prefs", {"download.default_directory": str(downloads)})
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(DRIVER))
    driver.set_script_timeout(300)  # s, on a machine with much else to do
    try:
        yield driver
    finally:
        driver.quit()


def axe(folder: Path) -> str:
    """The script of axe-core; the test is skipped where npm has none."""
    npm = shutil.which("npm")
    command = [npm or "npm", "pack", AXE[0]]
    done = subprocess.run(command, cwd=folder, capture_output=True, timeout=120, check=False) if npm else None
    if done is None or done.returncode != 0:
        pytest.skip("npm does not offer axe-core here")
    with tarfile.open(next(folder.glob("*.tgz"))) as archive:
        text = archive.extractfile("package/axe.min.js").read()
    assert hashlib.sha256(text).hexdigest() == AXE[1]
    return text.decode()


def barriers(driver: Any, script: str) -> list[tuple[str, list[str]]]:
    """What axe-core finds in the page that is shown: rule and elements; [] where nothing bars people."""
    driver.execute_script(script)
    # the letters of the triad stand on a picture, whose colours axe cannot see; they are hidden from readers of screens
    run = "const done = arguments[0]; axe.run({ exclude: [['.triad']] }).then(done)"
    found = driver.execute_async_script(run)
    assert "color-contrast" in [one["id"] for one in found["passes"]]
    told = found["violations"] + found["incomplete"]
    return [(one["id"], [node["html"][:300] for node in one["nodes"]]) for one in told]


def emulate(driver: Any, **media: str) -> None:
    """Media features of the page, such as prefers_color_scheme="dark"."""
    features = [{"name": name.replace("_", "-"), "value": value} for name, value in media.items()]
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": features})


def medium(driver: Any, name: str) -> None:
    """The medium that the page is laid out for, "print" or "" for the screen."""
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": name})


def requests_of(driver: Any) -> set[str]:
    """The addresses that the page has asked for since the last time."""
    messages = [json.loads(entry["message"])["message"] for entry in driver.get_log("performance")]
    return {m["params"]["request"]["url"] for m in messages if m["method"] == "Network.requestWillBeSent"}


def prints_a_picture(driver: Any) -> bool:
    """Whether a picture of 1600 pixels, that of a rod, is on the pages that are printed."""
    pdf = base64.b64decode(driver.execute_cdp_cmd("Page.printToPDF", {"printBackground": True})["data"])
    sizes = re.findall(rb"/Subtype /Image\s+/Width (\d+)\s+/Height (\d+)", pdf)
    return any(int(wide) == 1600 and int(high) > 400 for wide, high in sizes)
