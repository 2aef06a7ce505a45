"""The live page as a part of the site: the offline file of `workbench explore --save` in a frame."""

import subprocess
import sys
from pathlib import Path

PAGE = """# The live page

Move a slider, and the shape follows. The solver runs in this browser; nothing is loaded from a network.
[Use the live page](how-to/use-the-live-page.md) explains its parts. [Open it alone](_static/rod.html){.external}.

<iframe src="_static/rod.html" title="The live page" class="live"></iframe>
"""


def write(folder: Path) -> None:
    """Write the page and the file that it shows."""
    saved = folder / "_static" / "rod.html"
    saved.parent.mkdir(exist_ok=True)
    subprocess.run([sys.executable, "-m", "workbench", "explore", "--save", str(saved)], check=True)
    (folder / "live.md").write_text(PAGE, encoding="utf-8")
