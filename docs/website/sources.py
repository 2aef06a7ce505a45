"""The pages of docs as sources of the site: copied, with smaller pictures, and with a table of contents.

The pages are plain Markdown that reads well without the site, so nothing in them is for Sphinx alone.
"""

import re
import shutil
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
WIDEST = 1500  # pixels of a picture on the site
ROOT_PAGES = ("README.md", "CHANGELOG.md", "ARCHITECTURE.md", "CONTRIBUTING.md")
PICTURE = re.compile(r"((?:figures|scenes)/[\w-]+)\.png(?=[)\"])")
ENTRY = re.compile(r"^- \[([^\]]+)\]\(([^)#]+)\.md\)", re.MULTILINE)

# What is made by `docs.build`: caption -> title and page; it stands behind the list of docs/index.md of that heading.
MADE = {
    "Tutorial": ("Examples", (("Results", "results"), ("Gallery", "gallery/index"), ("The live page", "live"))),
    "Reference": (
        "Made from the code",
        (
            ("Python", "reference/python"),
            ("Command line", "reference/command-line"),
            ("Keys of a study", "reference/study-keys"),
            ("Variables of a file", "reference/variables"),
        ),
    ),
    "Explanation": (
        "Project",
        (
            ("Read me", "readme"),
            ("Changes", "changelog"),
            ("Architecture", "architecture"),
            ("Contributing", "contributing"),
        ),
    ),
}
KINDS = (
    "The pages are of four kinds. A tutorial teaches by doing. A how-to page solves one task. A reference page lists "
    "facts. An explanation page says why."
)
ON_THE_SITE = """## On this site

- [Results](results.md): twenty pictures, each with the commands that draw it.
- [Gallery](gallery/index.rst): ten short scripts, each with its picture and its check.
- [The live page](live.md): move sliders, and see the rod change; it needs no server.
- [Python](reference/python.rst): every public name, from its docstring.
- [Command line](reference/command-line.md): every option of every command.
- [Keys of a study](reference/study-keys.md): type, default and limits, from the model that reads them.
- [Variables of a file](reference/variables.md): dimensions, units and attributes, from files that were made.

## Tutorial
"""

HERO = re.compile(r'<img src="docs/([^"]+)" width="[^"]*" alt="([^"]*)">')

Entries = tuple[tuple[str, str], ...]  # title and page


def copy(root: Path, folder: Path) -> None:
    """Copy the pages, pictures and examples of a checkout to the folder of the sources."""
    docs = root / "docs"
    for page in sorted(docs.rglob("*.md")):
        text = page.read_text(encoding="utf-8")
        for name in ROOT_PAGES:
            text = re.sub(rf"\]\(((?:\.\./)*)\.\./{re.escape(name)}", rf"](\1{name.lower()}", text)
        _put(folder / page.relative_to(docs), text)
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
    """Add what was made to the first page, and the tables of contents: the lists of that page, and what was made."""
    index = folder / "index.md"
    text = _first_page(index.read_text(encoding="utf-8"))
    parts = re.split(r"^## (.*)$", text, flags=re.MULTILINE)
    tables = []
    for heading, body in zip(parts[1::2], parts[2::2], strict=True):
        tables.append(_contents(heading, tuple(ENTRY.findall(body))))
        if heading in MADE:
            tables.append(_contents(*MADE[heading]))
    index.write_text(text.replace("## Tutorial\n", ON_THE_SITE) + "".join(tables), encoding="utf-8")


def _first_page(text: str) -> str:
    """The first page of docs with the beginning of the README, its pictures and its question, above its lists."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8").partition("\n## ")[0].replace("](docs/", "](")
    heading, *paragraphs = readme.split("\n\n")
    pictures = " ".join(f'<img class="hero" src="{src}" alt="{alt}">' for src, alt in HERO.findall(readme))
    words = [one for one in paragraphs if not one.startswith("<img")]
    lists = text.partition("## Tutorial\n")
    pictures = PICTURE.sub(r"\1.webp", pictures)  # as `_put` writes them
    return "\n\n".join([heading, pictures, *words, f"{KINDS}\n\n"]) + "".join(lists[1:])


def _contents(caption: str, entries: Entries) -> str:
    named = [f"{title.replace('`', '')} <{page}>" for title, page in entries]
    return "\n".join(["", "```{toctree}", ":hidden:", f":caption: {caption}", "", *named, "```", ""])


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
        small.save(folder / f"{picture.stem}.webp", quality=82, method=4)
