"""The kinds of files: what each holds, how it is told from others, and which commands read it."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from solver.problem.errors import InputError

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class FileKind:
    """A kind of file.

    what: in words. figure: its kind in `workbench.figures.figure_kinds`, "" for none. scene: whether `scene` draws
    it. needs: dimensions and variables that no other kind has.
    """

    what: str
    figure: str = ""
    scene: bool = False
    needs: tuple[str, ...] = ()


STUDY = FileKind("the results of a study", "study", True)
LOOPS = FileKind("a list of closed rods", "loops", True, ("equilibrium", "turns_around", "about"))
EQUILIBRIA = FileKind("a list of equilibria", "equilibria", True, ("equilibrium", "index"))
BRANCHES = FileKind("all equilibria over an axis", "branches", True, ("curve_point", "curve_branch"))
KINDS = (
    LOOPS,
    EQUILIBRIA,
    BRANCHES,
    FileKind("a fold map", "folds", False, ("region_at",)),
    FileKind("a branch of equilibria", "", False, ("point", "special", "dbeta0")),
    FileKind("a trade of methods", "trade", False, ("ladder", "rung")),
    FileKind("extremes by method", "extremes", False, ("extreme", "method")),
    FileKind("the laws under each reading of Table 1", "", False, ("reading", "claim_verdict")),
)


def kind_of(ds: "xr.Dataset") -> FileKind:
    """The kind of a dataset; that of a study where nothing says otherwise."""
    held = {*map(str, ds.dims), *map(str, ds.variables)}
    return next((kind for kind in KINDS if held.issuperset(kind.needs)), STUDY)


def other_kind(path: object, kind: FileKind, reads: str) -> InputError:
    """The error of a file of a kind that a command does not read; reads: what it reads, or why it does not."""
    return InputError(f"{path} is {kind.what}, which {_readers(kind)}; {reads}")


def _readers(kind: FileKind) -> str:
    """``summary, plot and scene read``."""
    names = ["summary", *(["plot"] if kind.figure else []), *(["scene"] if kind.scene else [])]
    return f"{' and '.join(part for part in (', '.join(names[:-1]), names[-1]) if part)} read{'s' * (len(names) == 1)}"
