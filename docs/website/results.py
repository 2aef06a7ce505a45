"""Results, one picture each, with the commands that draw it: a page of the site, made when the site is built.

A picture is drawn anew only if its commands, the files of examples or the code have changed.
"""

import shlex
import subprocess
import sys
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from pathlib import Path

from PIL import Image, ImageChops

ROOT = Path(__file__).resolve().parents[2]
PAGE = "results"
SIZE, EDGE = (640, 448), 12  # pixels of a thumbnail, as of the gallery of examples, and its margin
HIGHEST = 1.6  # times as high as a thumbnail, at its width: of a higher picture only the upper part is shown


@dataclass(frozen=True)
class Result:
    """A picture NAME.png: what it shows, in a few words, and the commands without the word workbench."""

    name: str
    words: str
    commands: tuple[str, ...]


def _of(name: str, words: str, *commands: str) -> Result:
    return Result(name, words, commands)


def _plot(name: str, words: str, study: str, *options: str) -> Result:
    file = f"{Path(study).stem}.h5"
    return _of(name, words, f"run {study} --out {file}", " ".join(("plot", file, *options, f"-o {name}.png")))


README = (
    _plot("pipe_buckles", "A drill pipe buckles as the load grows", "examples/pipe.toml", "--kind curves"),
    _of("dna", "DNA on histones", "scene examples/dna.toml --kind double-helix -o dna.png"),
    _of(
        "let_go",
        "A rod that the cylinder holds on, and the same rod let go",
        "scene examples/release.toml --kind let-go -o let_go.png",
    ),
)
RESULTS = (
    *README,
    _of("cable", "A cable on a drum", "scene examples/cable.toml --kind contact -o cable.png"),
    _of(
        "branches_held",
        "Force over height of a rod that snaps through, with the rod at eight points",
        "equilibria examples/snap.toml --axis height=-2.5:4.9:21 --plot branches_held.png",
    ),
    _of("curvature", "How tightly the rod is bent", "scene fig6 --kind curvature -o curvature.png"),
    _of("twist", "A stripe that turns with the material", "scene fig6 --kind twist -o twist.png"),
    _of("stiffer", "Nine rods from soft to stiff", "scene fig7_1_modulus --kind grid -o stiffer.png"),
    _of("angles", "Rods to three end angles, in one picture", "scene fig7_4_end_angle --kind ghosts -o angles.png"),
    _plot("laws", "What a wider cylinder does, and its law", "fig7_2_radius", "--panel kappa_max"),
    _plot("unrolled", "Nine rods unrolled", "fig7_1_modulus", "--kind curves"),
    _plot("ridge", "Angle, curvature and push along nine rods", "fig7_1_modulus", "--kind ridge"),
    _plot("portrait", "Phase portrait and potential", "fig6", "--kind portrait"),
    _plot("capstan", "The pull of a cable over friction and weight", "capstan", "--show pull"),
    _plot("borders", "Borders of the number of bends, refined", "regimes_refined", "--show bends"),
    _plot("samples", "What matters among 256 samples", "samples_pipe"),
    _plot("pole", "A pole that buckles under its own weight", "pole_greenhill", "--panel kappa_max"),
    _of("equilibria", "All equilibria between two ends", "equilibria --plot equilibria.png"),
    _of("atlas", "Where equilibria appear", "folds --axis betaL=-60deg:90deg --axis FZ=4:12 --plot atlas.png"),
    _of("loops", "Closed rods of one turn", "loops --table1 --a 0.05 --R 0.95 --L 12 --folds 1,2,3 -o loops.png"),
)


# examples of the gallery that write no picture of their own, and one that is made already
THUMBNAILS = {"cable_on_a_drum": "cable", "dna_on_a_histone": "dna", "export_a_rod": ROOT / "docs/scenes/inside.png"}


@cache
def _code() -> str:
    """The digest of the code that draws."""
    files = sorted(path for name in ("solver", "studies", "workbench") for path in (ROOT / name).rglob("*.py"))
    return sha256(b"".join(path.read_bytes() for path in files)).hexdigest()


def draw(result: Result, folder: Path) -> Path:
    """Return the picture of a result, drawn in a folder by its commands. Raises `CalledProcessError`."""
    picture, log = folder / f"{result.name}.png", folder / f"{result.name}.txt"
    wanted = "\n".join(
        [*result.commands, _code(), *(path.read_text() for path in sorted((ROOT / "examples").glob("*.toml")))]
    )
    if not (picture.exists() and log.exists() and log.read_text() == wanted):
        for command in result.commands:
            words = [sys.executable, "-m", "workbench", *shlex.split(command), "--force"]
            done = subprocess.run(words, cwd=folder, check=False, stdout=subprocess.DEVNULL)
            if done.returncode not in (0, 1):  # 1: done, but a law does not hold
                done.check_returncode()
        log.write_text(wanted)
    return picture


def shrink(picture: Path, path: Path) -> None:
    """Write the thumbnail of a picture, without its white border: whole, or of a very high picture the upper part."""
    with Image.open(picture) as image:
        whole = image.convert("RGB")
    part = whole.crop(ImageChops.difference(whole, Image.new("RGB", whole.size, "white")).getbbox())
    wide, high = (size - 2 * EDGE for size in SIZE)
    if part.height * wide > HIGHEST * high * part.width:
        part = part.crop((0, 0, part.width, round(part.width * high / wide)))
    scale = min(wide / part.width, high / part.height)
    part = part.resize((round(scale * part.width), round(scale * part.height)), Image.Resampling.LANCZOS)
    sheet = Image.new("RGB", SIZE, "white")
    sheet.paste(part, ((SIZE[0] - part.width) // 2, (SIZE[1] - part.height) // 2))
    sheet.save(path, quality=85, method=4)  # of a .webp


def write(folder: Path, work: Path) -> None:
    """Write the page, its pictures and their thumbnails. work: a folder that keeps the pictures between builds."""
    work.mkdir(parents=True, exist_ok=True)
    if not (work / "examples").exists():
        (work / "examples").symlink_to(ROOT / "examples")
    target = folder / "_static" / PAGE
    target.mkdir(parents=True)
    for result in RESULTS:
        picture = draw(result, work)
        shrink(picture, target / f"{result.name}.webp")
        with Image.open(picture) as image:
            image.convert("RGB").save(target / f"{result.name}_large.webp", quality=82, method=4)
    thumbnails = folder / "_static" / "thumbnails"
    thumbnails.mkdir()
    for example, of in THUMBNAILS.items():
        shrink(of if isinstance(of, Path) else work / f"{of}.png", thumbnails / f"{example}.png")
    (folder / f"{PAGE}.md").write_text(text(), encoding="utf-8")


def text() -> str:
    """The page: each result with its commands, which are those that drew it."""
    figures = []
    for one in RESULTS:
        commands = "\n".join(f"workbench {command}" for command in one.commands)
        place = f"_static/{PAGE}/{one.name}"
        figures.append(
            f'<figure><a href="{place}_large.webp"><img src="{place}.webp" alt="{one.words}"></a>'
            f"<figcaption>{one.words}</figcaption><pre>{commands}</pre></figure>"
        )
    opening = f"# Results\n\n{len(RESULTS)} pictures, each with the commands that draw it in a clone of the project."
    return "\n".join([opening, "", '<div class="results">', *figures, "</div>", ""])
