"""How finely a rod must be drawn: rings and sides from a pixel error, against a uniform mesh that is as good.

    python -m benchmarks.detail

Prints a table (stations, rings, sides, triangles, milliseconds, error in pixels). The error
is measured on the triangles: points on them, and how far each is from the true surface, which is evaluated anew. A
second table is of whole scenes, from the stored file to the picture, each in a process of its own.
"""

import json
import resource
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path
from time import perf_counter, process_time

import numpy as np
import xarray as xr

from studies.language.loader import loads
from workbench.geometry.centreline import Array, Centreline
from workbench.geometry.tube_tolerance import Rings, rings
from workbench.run import in_memory, writing
from workbench.scene import opengl, surfaces
from workbench.scene.body import Body, read
from workbench.scene.scene_kinds import KINDS
from workbench.stored import reading
from workbench.stored.stored_study import StoredStudy

WIDE = 1450  # pixels of the picture that the rod's length fills
ERRORS = (2.0, 0.5)
HEAD = 'title = "{}"\nreading = "force-first/tension/paper"\nstations = {}\nobservables = ["bends"]\n'
UNITS = 'outputs = ["beta", "alpha", "z"]\n[units]\nlength = "cm"\nforce = "N"\n[base]\n'
# name -> stations and the fields of Table 1 that are changed
RODS = {
    "Table 1": (201, ""),
    "stiff": (201, "E = 4e4\n"),
    "ten times as long": (2001, "L = 200.0\n"),
    "a hundred times": (20001, "L = 2000.0\n"),
    "two thousand times": (100001, "L = 40000.0\n"),
}


def off(body: Body, drawn: Rings) -> float:
    """The largest distance of the drawn triangles from the true surface [length], at the middles of their sides."""
    n, line = drawn.s.size, body.line
    (made,) = surfaces.tube_parts(body, drawn)
    walls = made.triangles[: 2 * (n - 1) * drawn.sides].reshape(n - 1, -1, 3)
    lift = np.array([0, 0, line.at(drawn.s[:1])[2][0]])
    worst = 0.0
    for part in np.array_split(np.arange(n - 1), -(-n * drawn.sides // 50_000)):  # of the memory that this takes
        corners = made.points[walls[part]] + lift
        middles = (corners + np.roll(corners, -1, axis=2)) / 2
        found = _away(line, drawn.s[part[0] : part[-1] + 2], middles.reshape(part.size, -1, 3))
        worst = max(worst, float(found.max()))
    return worst


def _away(line: Centreline, s: Array, points: Array) -> Array:
    """Distance of the points (n - 1, k, 3) of each stretch from the true surface near it, (n - 1, k)."""
    h = np.diff(s)[:, None]
    best, reach = np.full(points.shape[:2], np.nan), 1.5
    at = np.broadcast_to(s[:-1, None] + 0.5 * h, points.shape[:2])
    for _ in range(3):  # ever nearer to the nearest section
        trial = np.clip(at[..., None] + reach * h[..., None] * np.linspace(-0.5, 0.5, 9), line.s[0], line.s[-1])
        place, along, _, _ = (v.reshape(*trial.shape, 3) for v in line.frame(trial.ravel()))
        gap = points[..., None, :] - place
        axial = np.einsum("...i,...i->...", gap, along)
        radial = np.sqrt(np.maximum(np.einsum("...i,...i->...", gap, gap) - axial**2, 0))
        distance = np.hypot(radial - line.a, axial)
        best = distance.min(axis=-1)
        at = np.take_along_axis(trial, distance.argmin(axis=-1)[..., None], axis=-1)[..., 0]
        reach /= 4
    return best


def uniform(body: Body, allowed: float) -> tuple[int, int]:
    """The fewest evenly spaced rings, with sides that lose half of it, whose surface is off by no more [length]."""
    line = body.line
    sides = max(int(np.ceil(np.pi / np.arccos(max(1 - allowed / 2 / line.a, 0)))), 6)

    def misses(count: int) -> bool:
        return off(body, Rings(np.linspace(line.s[0], line.s[-1], count), sides, 0.0)) > allowed

    few, many = 2, 4
    while misses(many) and many < 200_000:
        few, many = many, 2 * many
    while many - few > max(few // 25, 1):
        middle = (few + many) // 2
        if misses(middle):
            few = middle
        else:
            many = middle
    return many, sides


def dataset_of(name: str) -> xr.Dataset:
    stations, text = RODS[name]
    return in_memory.run(loads(HEAD.format(name, stations) + UNITS + text, default_name="rod"))


def measure(name: str, pixel_error: float) -> list[object]:
    ds, stations = dataset_of(name), RODS[name][0]
    body = read(StoredStudy(ds), {}, KINDS["plain"])
    line = body.line
    per_unit = WIDE / max(float(np.ptp(body.z)), 2 * body.reach)
    allowed = pixel_error / per_unit
    line.frame(line.s)  # the curve itself is not what is timed
    start = perf_counter()
    found = rings(line, body.span, allowed)
    seconds = perf_counter() - start
    start = perf_counter()
    (mesh,) = surfaces.tube_parts(body, found)
    meshing = perf_counter() - start
    made = off(body, found)
    even = "-"
    if stations <= 2001 and float(line.a) * per_unit > 0.5:
        count, sides = uniform(body, max(made, allowed * 0.5))
        even = f"{2 * count * sides}"
    return [name, int(ds["bends"]), stations, pixel_error, found.s.size, found.sides, len(mesh.triangles),
            f"{1e3 * seconds:.0f} + {1e3 * meshing:.0f}", f"{made * per_unit:.2f}", even]  # fmt: skip


def whole(name: str, file: Path, pixel_error: float) -> list[object]:
    """A scene of kind plain of all of a rod, drawn by another process."""
    command = [sys.executable, __file__, "--scene", str(file), str(pixel_error)]
    told = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()[-1])
    seconds = " + ".join(f"{told[key]:.1f}" for key in ("reading", "drawing"))
    return [name, pixel_error, told["surfaces"], told["triangles"], seconds, f"{told['memory']:.0f}"]


def scene(file: Path, pixel_error: float) -> None:
    """What `whole` asks of a process of its own: draws, and prints what it took as JSON."""
    opengl.probe()
    from workbench.scene import composition, layout

    triangles: list[int] = []
    made = surfaces.tube_parts

    def count_parts(body: Body, drawn: Rings) -> list[surfaces.Part]:
        found = made(body, drawn)
        triangles.append(sum(len(part.triangles) for part in found))
        return found

    surfaces.tube_parts = count_parts
    start = process_time()
    ds = reading.read(file)
    read(StoredStudy(ds), {}, KINDS["plain"])
    taken = process_time() - start
    layout.render(StoredStudy(ds), file.with_suffix(".png"), kind="plain", settings=composition.Settings(pixel_error))
    seconds = process_time() - start - 2 * taken  # the scene reads once more
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    told = {"surfaces": len(triangles), "triangles": sum(triangles), "memory": memory}
    print(json.dumps({**told, "reading": taken, "drawing": seconds}))


def rows(heads: list[str], found: Iterable[list[object]]) -> None:
    print("| " + " | ".join(heads) + " |\n|" + "---|" * len(heads))
    for row in found:
        print("| " + " | ".join(str(v) for v in row) + " |", flush=True)
    print()


def main() -> None:
    if sys.argv[1:2] == ["--scene"]:
        return scene(Path(sys.argv[2]), float(sys.argv[3]))
    heads = ["rod", "bends", "stations", "pixels allowed", "rings", "sides", "triangles", "ms", "pixels off", "uniform"]
    rows(heads, (measure(name, pixel_error) for name in RODS for pixel_error in ERRORS))
    with tempfile.TemporaryDirectory() as folder:
        files = {name: Path(folder) / f"{i}.h5" for i, name in enumerate(RODS) if name != "stiff"}
        for name, file in files.items():
            writing.write(dataset_of(name), file)
        heads = ["rod", "pixels allowed", "surfaces", "triangles", "processor s", "MB"]
        rows(heads, (whole(name, file, pixel_error) for name, file in files.items() for pixel_error in ERRORS))


if __name__ == "__main__":
    main()
