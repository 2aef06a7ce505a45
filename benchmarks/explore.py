"""From a slider to the new shape in the browser: how long, and where the time goes.

    .venv/bin/python benchmarks/explore.py [MOVES]

Needs the extras explore and test, and Debian's chromium and chromium-driver. The page is moved one step at a time, as a
hand moves a slider, and each step waits until the pixels are there (a pixel is read back). `page` ends later: when the
frame with the diagrams beside the rod, too, is laid out and handed over. Chromium draws in software here, so `pixels`
is more than on a machine with a graphics card.
"""

import json
import re
import statistics
import subprocess
import sys
import tempfile
import time

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.support.ui import WebDriverWait

FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader", "--disable-quic",
         "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync",
         "--window-size=1500,1100")  # fmt: skip
SLIDERS = {"table1": "E", "dna": "F3", "pipe": "FZ", "cable": "R"}
PARTS = ("solve", "mesh", "transfer", "draw", "pixels", "all", "page")
WARM = 10  # moves that are not counted

MOVE = """
const [slider, moves, done] = [document.getElementById(arguments[0]), arguments[1], arguments[2]], found = [];
const centre = Number(slider.value);
let i = 0;
function move() {
  slider.value = centre - 50 + ((37 * i) % 101);
  slider.dispatchEvent(new Event("input", { bubbles: true }));
}
document.addEventListener("drawn", function seen(event) {
  const gl = view.openglRenderWindow.get3DContext(), from = performance.now();
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  const there = performance.now(), pixels = there - from, channel = new MessageChannel();
  found.push({ ...event.detail, pixels, all: event.detail.all + pixels });
  channel.port1.onmessage = () => { // the first task after the frame is painted
    found.at(-1).page = found.at(-1).all + performance.now() - there;
    i += 1;
    if (i < moves) setTimeout(move, 60);
    else { document.removeEventListener("drawn", seen); done(JSON.stringify(found)); }
  };
  requestAnimationFrame(() => channel.port2.postMessage(0));
});
move();
"""
DRAWN = "return typeof view !== 'undefined' && view !== null && !busy && !again && page.head.ticket"


def main(moves: int) -> None:
    """Serve the page, move one slider of each preset, print medians / 95th percentiles in milliseconds."""
    server = subprocess.Popen([sys.executable, "-m", "workbench", "explore", "--port", "0"], stdout=-1, text=True)
    options = webdriver.ChromeOptions()
    options.binary_location = "/usr/bin/chromium"
    for flag in (*FLAGS, f"--user-data-dir={tempfile.mkdtemp()}"):
        options.add_argument(flag)
    driver = webdriver.Chrome(options=options, service=Service("/usr/bin/chromedriver"))
    try:
        assert server.stdout is not None
        address = re.search(r"http://\S+", server.stdout.readline())[0]  # type: ignore[index]
        driver.set_script_timeout(300)
        driver.get(address)
        wait = WebDriverWait(driver, 120)
        before = wait.until(lambda driver: driver.execute_script(DRAWN))
        print("| rod, slider | solve | mesh | transfer | scene | pixels | all | page |")
        print("|---|---|---|---|---|---|---|---|")
        for preset, slider in SLIDERS.items():
            driver.execute_script("page.begin(arguments[0])", preset)
            wait.until(lambda driver, before=before: driver.execute_script(DRAWN) not in (False, before))
            time.sleep(4)  # until what is asked at rest is answered
            before = driver.execute_script(DRAWN)
            found = json.loads(driver.execute_async_script(MOVE, f"s-{slider}", moves + WARM))[WARM:]
            rows = [{**one, "transfer": one["back"] - one["solve"] - one["mesh"]} for one in found]
            middle = {key: statistics.median(row[key] for row in rows) for key in PARTS}
            worst = {key: statistics.quantiles([row[key] for row in rows], n=20)[-1] for key in PARTS}
            cells = " | ".join(f"{middle[key]:.1f} / {worst[key]:.1f}" for key in PARTS)
            print(f"| {preset}, {slider} | {cells} |")
    finally:
        driver.quit()
        server.terminate()
        server.wait(10)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 200)
