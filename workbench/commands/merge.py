"""The command merge: print what came of merging stored studies."""

from collections.abc import Sequence
from pathlib import Path

from ..data import law_verdicts
from ..run.merge import merge
from . import console


def merge_files(files: Sequence[Path], out: Path, force: bool, json: bool) -> int:
    """Merge the files into `out` and print the verdicts of its laws; the exit status is that of `check`.

    Raises `InputError` where they are not one study along one axis; nothing is stored then.
    """
    done = merge(files, out, force)
    status = law_verdicts.status(done["unsolved"], done["laws"])
    if json:
        console.print_json({**done, "status": status})
        return status
    if done["laws"]:
        rows = [
            [row["claim"], law_verdicts.stated(row), law_verdicts.measured(row), law_verdicts.said(row)]
            for row in done["laws"]
        ]
        console.print_table(["claim", "law", "measured", "verdict"], rows)
        console.say(law_verdicts.tallied(done["laws"]))
    console.say(f"{out}: {done['values']} values of {done['axis']} from {len(files)} files")
    console.say(f"{done['cases']} cases, {done['unsolved']} unsolved")
    if done["caution"]:
        console.say(f"caution: {done['caution']}")
    return status
