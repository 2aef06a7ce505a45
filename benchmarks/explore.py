"""From a slider to the new shape in the browser: how long, and where the time goes.

    .venv/bin/python benchmarks/explore.py [MOVES]

Needs the extra test, and Debian's chromium and chromium-driver. The page is saved as a file and opened without a
server; each slider is moved one step at a time, as a hand moves it, and each step waits until the pixels of the rod are
there (a pixel is read back). `page` ends when the frame with the diagrams beside the rod is painted, too. Chromium
draws in software here, so `pixels` is more than on a machine with a graphics card. At the end the moves of one second
without a pause between them are counted.
"""

import json
import statistics
import sys
import tempfile
from pathlib import Path

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.support.ui import WebDriverWait

from workbench.web.live import live_document
from workbench.web.live.presets import PRESETS

FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader", "--disable-quic",
         "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync",
         "--window-size=1500,1100")  # fmt: skip
SLIDERS = {"table1": "E", "dna": "F3", "pipe": "FZ", "cable": "R"}
PARTS = ("solve", "draw", "diagrams", "pixels", "all", "page")
WARM = 20  # moves that are not counted

MOVE = """
const [slider, moves, done] = [document.getElementById(arguments[0]), arguments[1], arguments[2]], found = [];
const centre = Number(slider.value);
let i = 0;
function move() {
  slider.value = centre - 50 + ((37 * i) % 101);
  slider.dispatchEvent(new Event("input", { bubbles: true }));
}
document.addEventListener("drawn", function seen(event) {
  const { since, ...parts } = event.detail, from = performance.now();
  page.view.scene.wait();
  const there = performance.now(), channel = new MessageChannel();
  found.push({ ...parts, pixels: there - from, all: there - since });
  channel.port1.onmessage = () => { // the first task after the frame is painted
    found.at(-1).page = performance.now() - since;
    i += 1;
    if (i < moves) setTimeout(move, 60);
    else { document.removeEventListener("drawn", seen); done(JSON.stringify(found)); }
  };
  requestAnimationFrame(() => channel.port2.postMessage(0));
});
move();
"""
RATE = """
const [slider, done] = [document.getElementById(arguments[0]), arguments[1]], centre = Number(slider.value);
const end = performance.now() + 1000, channel = new MessageChannel(); // setTimeout would wait 4 ms
let i = 0;
function move() {
  slider.value = centre - 50 + ((37 * i++) % 101);
  slider.dispatchEvent(new Event("input", { bubbles: true }));
  page.view.scene.wait();
  if (performance.now() < end) channel.port2.postMessage(0); else done(i);
}
channel.port1.onmessage = move;
move();
"""


def main(moves: int) -> None:
    """Save the page, move one slider of each rod, print medians / 95th percentiles in milliseconds."""
    folder = Path(tempfile.mkdtemp())
    (folder / "rod.html").write_text(live_document.text(PRESETS, served=False), encoding="utf-8")
    options = webdriver.ChromeOptions()
    options.binary_location = "/usr/bin/chromium"
    for flag in (*FLAGS, f"--user-data-dir={folder / 'profile'}"):
        options.add_argument(flag)
    driver = webdriver.Chrome(options=options, service=Service("/usr/bin/chromedriver"))
    try:
        driver.set_script_timeout(300)
        driver.get((folder / "rod.html").as_uri())
        WebDriverWait(driver, 120).until(lambda driver: driver.execute_script("return window.page && page.shape"))
        print("| rod, slider | solve | scene | diagrams | pixels | all | page | moves in 1 s |")
        print("|---|---|---|---|---|---|---|---|")
        for preset, slider in SLIDERS.items():
            driver.execute_script("page.begin(arguments[0])", preset)
            rows = json.loads(driver.execute_async_script(MOVE, f"s-{slider}", moves + WARM))[WARM:]
            middle = {key: statistics.median(row[key] for row in rows) for key in PARTS}
            worst = {key: statistics.quantiles([row[key] for row in rows], n=20)[-1] for key in PARTS}
            cells = " | ".join(f"{middle[key]:.1f} / {worst[key]:.1f}" for key in PARTS)
            driver.execute_script("page.begin(arguments[0])", preset)
            print(f"| {preset}, {slider} | {cells} | {driver.execute_async_script(RATE, f's-{slider}')} |")
    finally:
        driver.quit()


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 200)
