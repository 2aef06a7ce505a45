"""The pages of docs as sources of the site: copied, with smaller pictures, and with a table of contents.

The pages are plain Markdown that reads well without the site, so nothing in them is for Sphinx alone.
"""

import re
import shutil
from pathlib import Path

from PIL import Image

WIDEST = 1600  # pixels of a picture on the site
ROOT_PAGES = ("README.md", "CHANGELOG.md", "CONTRIBUTING.md")
PICTURE = re.compile(r"((?:figures|scenes)/[\w-]+)\.png(?=[)\"])")
ENTRY = re.compile(r"^- \[([^\]]+)\]\(([^)#]+)\.md\)", re.MULTILINE)

# What is made by `docs.build` and stands below the lists of docs/index.md: caption -> pages.
MADE = {
    "Examples": ("gallery/index", "live"),
    "Made from the code": ("reference/python", "reference/command-line", "reference/study-keys", "reference/variables"),
    "Project": ("readme", "changelog", "contributing"),
}
ON_THE_SITE = """
## On the site

- [Examples](gallery/index.rst): ten short scripts, each with its picture and its check.
- [The live page](live.md): move sliders, and see the rod change; it needs no server.
- [Python](reference/python.rst): every public name, from its docstring.
- [Command line](reference/command-line.md): every option of every command.
- [Keys of a study](reference/study-keys.md): type, default and limits, from the model that reads them.
- [Variables of a file](reference/variables.md): dimensions, units and attributes, from a file that was made.
"""


def copy(root: Path, folder: Path) -> None:
    """Copy the pages, pictures and examples of a checkout to the folder of the sources."""
    docs = root / "docs"
    for page in sorted(docs.rglob("*.md")):
        _put(folder / page.relative_to(docs), page.read_text(encoding="utf-8").replace("](../../README.md", "](../readme.md"))
    for name in ROOT_PAGES:
        text = (root / name).read_text(encoding="utf-8").replace("](docs/", "](").replace('src="docs/', 'src="')
        for other in ROOT_PAGES:
            text = text.replace(f"]({other})", f"]({other.lower()})")
        _put(folder / name.lower(), text)
    for kind in ("figures", "scenes"):
        for picture in sorted((docs / kind).glob("*.*")):
            _copy_picture(picture, folder / kind)
    for study in docs.glob("*.toml"):
        shutil.copy(study, folder)
    shutil.copytree(root / "examples", folder / "examples")
    shutil.copytree(docs / "website" / "static", folder / "_static")


def add_contents(folder: Path) -> None:
    """Add the tables of contents to the first page: its own lists, then the pages that were made."""
    index = folder / "index.md"
    text = index.read_text(encoding="utf-8")
    parts = re.split(r"^## (.*)$", text, flags=re.MULTILINE)
    captions = {
        heading: tuple(page for _, page in ENTRY.findall(body))
        for heading, body in zip(parts[1::2], parts[2::2], strict=True)
    }
    tables = [_contents(caption, pages) for caption, pages in {**captions, **MADE}.items()]
    index.write_text(text + ON_THE_SITE + "".join(tables), encoding="utf-8")


def _contents(caption: str, pages: tuple[str, ...]) -> str:
    return "\n".join(["", "```{toctree}", ":hidden:", f":caption: {caption}", "", *pages, "```", ""])


def _put(path: Path, text: str) -> None:
    """Write a page that shows the smaller pictures."""
    path.parent.mkdir(parents=True, exist_ok=True)
    text = PICTURE.sub(r"\1.webp", text).replace("```csv\n", "```text\n")  # Pygments has no lexer of that name
    path.write_text(text, encoding="utf-8")


def _copy_picture(picture: Path, folder: Path) -> None:
    """Copy a picture; a PNG becomes WebP and at most `WIDEST` pixels wide, which takes a fifth of the bytes."""
    folder.mkdir(exist_ok=True)
    if picture.suffix != ".png":
        shutil.copy(picture, folder)
        return
    with Image.open(picture) as image:
        small = image.convert("RGBA" if image.mode in ("RGBA", "P", "LA") else "RGB")
        if small.width > WIDEST:
            small = small.resize((WIDEST, round(small.height * WIDEST / small.width)), Image.Resampling.LANCZOS)
        small.save(folder / f"{picture.stem}.webp", quality=88, method=4)
