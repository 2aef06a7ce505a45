"""Seconds from a stored dataset to a picture of 1600 x 1200 pixels, of each kind of scene of one case.

python -m benchmarks.scenes prints a table: seconds of the clock and of the processors, after all imports and one
picture; each is the least of three. The column *s* is composing + saving.

What bounds a picture: two renderings of 3056 x 1478 samples by Mesa on the processor, the first in two parts, take
0.20 s of 0.52 s; their pixels and depths are read and averaged in 0.08 s, words and bars drawn by Matplotlib in 0.05 s,
the PNG packed in 0.05 s, surfaces and shadows made in 0.05 s.
"""

import tempfile
from pathlib import Path
from time import perf_counter, process_time

from studies import load
from workbench.run import in_memory, writing
from workbench.scene import opengl
from workbench.stored import reading
from workbench.stored.stored_study import StoredStudy

KINDS = ("plain", "contact", "curvature", "twist")
TIMES = 3


def main() -> None:
    """Draw and print."""
    able, advice = opengl.probe()
    if not able:
        raise SystemExit(advice)
    from workbench.scene import layout, page
    from workbench.scene.composition import Settings

    settings = Settings(size=(1600, 1200))
    print("| kind | reading | composing | saving | s | processor s |\n|" + "---|" * 6)
    with tempfile.TemporaryDirectory() as folder:
        file, picture = Path(folder) / "fig6.h5", Path(folder) / "fig6.png"
        writing.write(in_memory.run(load("fig6")), file)
        layout.render(StoredStudy(reading.read(file)), picture, settings=settings)
        for kind in KINDS:
            found = []
            for _ in range(TIMES):
                start, busy = perf_counter(), process_time()
                ds = reading.read(file)
                read = perf_counter()
                taken = layout.compose(StoredStudy(ds), kind=kind, settings=settings)
                composed = perf_counter()
                page.save(taken, picture)
                end = perf_counter()
                found.append((end - read, read - start, composed - read, end - composed, process_time() - busy))
            drawn, opening, composing, saving, busy = (min(times) for times in zip(*found, strict=True))
            print(f"| {kind} | {opening:.3f} | {composing:.3f} | {saving:.3f} | {drawn:.3f} | {busy:.3f} |")


if __name__ == "__main__":
    main()
