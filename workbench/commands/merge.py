"""The command merge: join stored studies and print the verdicts of the whole."""

from pathlib import Path
from typing import Annotated

from . import console
from .options import ForceStudy, argument, option
from .present import Result, presents
from .study_result import print_verdicts


@presents()
def merge(
    files: Annotated[
        list[Path], argument("FILE...", "Two or more stored studies that differ in the values of one axis only.")
    ],
    out: Annotated[Path, option("FILE", "File of the joined study.", "--out", "-o")],
    force: ForceStudy = False,
) -> Result:
    """Join stored studies that extend each other along one axis.

    Exit status 1 if a case is unsolved, or if a law fails, is not decided or is true in part only.
    """
    from ..store import law_verdicts
    from ..store.file_merge import merge as join

    done = join(files, out, force)
    status = law_verdicts.status(done["unsolved"], done["laws"])

    def show() -> None:
        if done["laws"]:
            print_verdicts(done["laws"])
        console.say(f"{out}: {done['values']} values of {done['axis']} from {len(files)} files")
        console.say(f"{done['cases']} cases, {done['unsolved']} unsolved")
        if done["caution"]:
            console.say(f"caution: {done['caution']}")

    return Result(lambda: {**done, "status": status}, show, status)
