"""Pictures and turning scenes of a solution or a dataset, and tables, shown inline in a notebook.

`solution.plot()`, `solution.scene()`, `ds.rod.plot()` and `ds.rod.scene()` end here. What they return has the methods
by which Jupyter, VS Code and Colab show a value, and `save`. No package of a notebook is needed.
"""

import json
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import fields
from html import escape
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from solver import Case, Solution, solve
from solver.equilibria import Equilibria
from solver.equilibria_result import stability
from solver.observe.observables import observe
from solver.problem.errors import InputError, show, yes_or_no
from solver.problem.quantities import quantity, unit_of
from solver.problem.units import FORCES, LENGTHS
from studies.language.case_input import fields_of
from studies.language.study import outputs_of

from .branches.equilibria_dataset import all_units, of_solution
from .branches.equilibria_dataset import loops_as_dataset as loops_as_dataset  # `Loops.to_dataset` looks it up here
from .run import atomic
from .stored import provenance, quantity_variables
from .stored.stored_study import StoredStudy
from .words import caution_words, labels
from .words.python_words import in_python, python_words
from .words.unit_habits import distinct_texts

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from studies import Study

HEIGHT = 640  # pixels of a scene in a notebook
FINE = 4001  # stations of a diagram, two for each pixel
DPI = 110  # of a picture in a notebook
ALONG = ("beta", "dbeta", "alpha", "z", "contact")
NUMBERS = ("bends", "turns_around", "height", "kappa_max", "push_min", "push_max")  # of a solution's table
HEADINGS = ("", "stability", "energy [force length]", "bends", "beta'(0) [rad/length]", "attached share")


class Plot:
    """A diagram that a notebook shows inline.

    Attributes
    ----------
    figure
        The Matplotlib figure.

    Examples
    --------
    >>> from solver import Case, Cylinder, Rod, Start, solve
    >>> rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0)
    >>> sol = solve(Case(rod, Cylinder(R=0.75), Start(beta="30deg", dbeta=0.5, F1=5.0, F3=10.0)))
    >>> picture = sol.plot(length="cm", force="N")
    >>> len(picture.figure.axes)
    3
    """

    def __init__(self, figure: "Figure") -> None:
        self.figure = figure

    def save(self, path: str | Path) -> Path:
        """Write the diagram as .png, .pdf or .svg. Raises `InputError` for another name."""
        from .figures import canvas

        path = _path_of(path)
        canvas.save(self.figure, path)
        return path

    def _repr_png_(self) -> bytes:
        from .figures import canvas

        picture = BytesIO()
        canvas.save(self.figure, picture, dpi=DPI)
        return picture.getvalue()


class NotebookScene:
    """A rod on its cylinder that a notebook shows inline and a reader turns.

    Attributes
    ----------
    html
        The scene as the text of one offline HTML file.

    Examples
    --------
    >>> from solver import Case, Cylinder, Rod, Start, solve
    >>> rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0)
    >>> sol = solve(Case(rod, Cylinder(R=0.75), Start(beta="30deg", dbeta=0.5, F1=5.0, F3=10.0)))
    >>> sol.scene(length="cm", force="N").html.lower().startswith("<!doctype html>")
    True
    """

    def __init__(self, html: str) -> None:
        self.html = html

    def save(self, path: str | Path) -> Path:
        """Write the scene as one offline .html file. Raises `InputError` for another name."""
        path = _path_of(path)
        if path.suffix.lower() != ".html":
            raise InputError(f"a scene is saved as .html, got {path.name!r}")
        return atomic.write_text(path, self.html)

    def _repr_html_(self) -> str:
        style = f"width: 100%; height: {HEIGHT}px; border: 0"
        return f'<iframe sandbox="allow-scripts" style="{style}" srcdoc="{escape(self.html)}"></iframe>'


def _path_of(path: Any) -> Path:
    """The path that a text or a path means. Raises `InputError` for anything else."""
    try:
        return Path(path)
    except TypeError:
        raise InputError(f"path must be a text or a Path, got {path!r}") from None


class StudyRun:
    """A study that was run in memory.

    Attributes
    ----------
    ds
        The dataset of its cases.
    verdicts
        The verdict on each law: `claim`, `law`, `verdict`, `measured`, `where`; `verdicts["(1)"]` is that of a claim.
    """

    def __init__(self, study: "Study") -> None:
        from .run import in_memory

        self.ds = in_memory.run(study)
        self._stored = StoredStudy(self.ds)
        self.verdicts = self._stored.verdicts

    def plot(self, **at: Any) -> Plot:
        """The figure of the study, or of its case at these values of axes. Raises `InputError`."""
        return plot(self._stored, at)

    def scene(self, **at: Any) -> NotebookScene:
        """The rods, with a slider for each axis that has no value here. Raises `InputError`."""
        return scene(self._stored, at)

    def _repr_html_(self) -> str:
        from studies.laws import law_words

        title = f"{self.ds.attrs['title']}: {law_words.count_of(int(self.ds['solved'].size), 'case')}"
        return _table(title, [(row.law, law_words.sentence(row)) for row in self.verdicts])


def plot(stored: StoredStudy, at: Mapping[str, Any] | None = None) -> Plot:
    """The figure of a stored study, or of its case at some values of its axes. Raises `InputError`."""
    from .figures import figure_kinds

    if not at:
        with python_words():
            return Plot(figure_kinds.figure(stored, figure_kinds.kind_without_map(stored)))
    where = {name: stored.place(at)[name] for name in map(stored.axis, at)}
    part = stored.select(where).with_title(f"{stored.attrs['title']}, {stored.equations(where, 6)}")
    with python_words():
        kind = figure_kinds.kind_without_map(part)
        laws: dict[str, Any] = {"verdicts": []} if kind == "lines" else {}  # which are of all cases
        return Plot(figure_kinds.figure(part, kind, **laws))


def scene(stored: StoredStudy, at: Mapping[str, Any] | None = None) -> NotebookScene:
    """The rods of a stored study, with a slider for each axis that `at` does not fix. Raises `InputError`."""
    from .web.turntable import turntable_page

    with python_words():
        return NotebookScene(turntable_page.html(stored, at))


def plot_solution(sol: Solution, units: Mapping[str, str] | None = None) -> Plot:
    """The figure of a solution: of one case with peaks to the pixel, of several their unrolled views."""
    return plot(StoredStudy(as_dataset(_fine(sol) if not sol.case.shape else sol, units)))


def scene_solution(sol: Solution, units: Mapping[str, str] | None = None) -> NotebookScene:
    """The rods of a solution on their cylinder."""
    return scene(StoredStudy(as_dataset(sol, units)))


def export_solution(
    sol: Solution, path: str | Path, tolerance: float | None, replace: bool, units: Mapping[str, str]
) -> Path:
    """Write the rod of a solution, or with a number in the name those along its axis, as `export` does.

    What is left out of a family, and what a real rod could not do, is warned of.
    """
    from studies.laws.law_words import count_of

    from .export.file_format import ExportOptions
    from .export.stored_rod import check_holds_all, export

    path = _path_of(path)
    try:
        tolerance = None if tolerance is None else float(tolerance + 0.0)  # a text has no sum
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"tolerance must be a number, got {show(tolerance)}") from None
    with python_words():
        stored = StoredStudy(as_dataset(sol, units))
        check_holds_all(stored, path)
        done = export(stored, path, ExportOptions(tolerance=tolerance), yes_or_no("replace", replace))
    unsolved = done.facts.get("unsolved", 0)
    left = [f"{count_of(unsolved, 'rod')} left out: not solved"] if unsolved else []
    for sentence in [*left, *done.warnings]:
        warnings.warn(f"{path.name}: {in_python(sentence)}", stacklevel=4)
    return done.path


def as_dataset(sol: Solution, units: Mapping[str, str] | None = None) -> xr.Dataset:
    """A solution as a dataset that figures, scenes and exports read.

    Parameters
    ----------
    sol
        The solution. An axis of its grid along which one field of the case varies has that field's name and values, and
        any other axis is numbered: case1, case2, ...
    units
        "length" and "force" of the case, for labels; default: these words.

    Returns
    -------
    xr.Dataset
        The arrays of `ALONG` over (*axes, u), u = s/L, the numbers of the case, outcome and caution. With weight or
        friction, and off the wall, these do not give the others: then all numbers along the rod.

    Raises
    ------
    InputError
        For another unit than these two.
    """
    used = all_units(units)
    case, axes = sol.case, _axes(sol)
    u = np.asarray(sol.s, dtype=float).reshape(-1, sol.t.shape[-1])[0]
    every = [name for name in outputs_of(case.leaves) if name not in quantity_variables.INNER]
    names = every if case.varies or case.leaves else ALONG
    ds = of_solution(sol, tuple(axes), (u - u[0]) / (u[-1] - u[0]), names, used)
    loads = {name: getattr(sol, name) for name in quantity_variables.LOADS}
    for name, number in {**quantity_variables.numbers_of_case(case), **loads}.items():
        if name not in axes:
            value = np.broadcast_to(np.asarray(number, dtype=float), case.shape)
            same = value.size > 0 and float(np.ptp(value)) == 0
            pair: tuple[Any, Any] = ((), float(value.flat[0])) if same else (tuple(axes), value)
            ds[name] = *pair, quantity_variables.labels(name, used)
    known = used if used["length"] in LENGTHS and used["force"] in FORCES else None
    ds["caution"] = tuple(axes), np.asarray(caution_words.of_cases(sol, units=known)).astype(str)
    ds = ds.assign_coords({name: xr.Variable((name,), values, _labels(name, used)) for name, values in axes.items()})
    return ds.assign_attrs(_attributes(sol, used) | {"caution": caution_words.said(ds["caution"].values)})


def _axes(sol: Solution) -> dict[str, Any]:
    """Each axis of the grid: name and values."""
    case, axes = sol.case, dict[str, Any]()
    for k, size in enumerate(case.shape):
        along = [name for name, value in _fields(sol).items() if _varies_along(value, case.shape) == [k]]
        if len(along) == 1:
            value = np.broadcast_to(np.asarray(_fields(sol)[along[0]], dtype=float), case.shape)
            axes[quantity_variables.dimension(along[0])] = np.moveaxis(value, k, 0).reshape(size, -1)[:, 0]
        else:
            axes[f"case{k + 1}"] = np.arange(1, size + 1)
    return axes


def _fields(sol: Solution) -> dict[str, Any]:
    values = fields_of(sol.case).items()
    return {name: value for name, value in values if value is not None and not isinstance(value, str)}


def _varies_along(value: Any, shape: tuple[int, ...]) -> list[int]:
    """The axes of the grid along which a field has more than one value."""
    whole = np.broadcast_to(np.asarray(value, dtype=float), shape)
    return [k for k in range(len(shape)) if whole.size and (np.ptp(whole, axis=k) > 0).any()]


def _labels(name: str, units: Mapping[str, str]) -> dict[str, str]:
    if name.startswith("case"):
        return {"long_name": "number of the case", "symbol": "case", "units": "1"}
    return quantity_variables.labels(name, dict(units))


def _attributes(sol: Solution, units: Mapping[str, str]) -> dict[str, Any]:
    case = sol.case
    return {
        "title": "An elastic rod on a cylinder" if not case.shape else f"{case.size} elastic rods on cylinders",
        "study_name": "solution",
        "study": "",
        "reading": "",
        **quantity_variables.attributes_of_case(case, units),
        "laws": json.dumps([]),
        "versions": json.dumps(provenance.versions()),
        "method": sol.method,
        "tolerance": sol.tol,
    }


def _fine(sol: Solution) -> Solution:
    """A solution at as many stations as a diagram has pixels; as it is where it cannot be solved again."""
    if sol.t.shape[-1] >= FINE or not sol.solved:
        return sol
    try:
        ends = sol.problem.kind == "ends"
        finer = solve(sol.case, tol=sol.tol, method=sol.method, stations=FINE, seed=sol if ends else None)
    except InputError:
        return sol
    return finer if finer.solved else sol


def table_of_solution(sol: Solution) -> str:
    """Outcome, accuracy and a few observables."""
    each = np.asarray(sol.solved)
    rows = [("solved", f"{int(each.sum())} of {each.size}")] if each.size > 1 else [("outcome", str(sol.outcome))]
    rows += [("method", sol.method), ("estimated error", f"{np.max(sol.error):.1e}")]
    rows += [("condition number", f"{np.max(sol.condition):.3g}")]
    if each.any():
        values = observe(sol, list(NUMBERS))
        for name in NUMBERS:
            words = quantity(name).long_name.partition(" (")[0].partition(",")[0]
            rows.append((words, _span(name, np.asarray(values[name], dtype=float)[each])))
        rows += [("caution", caution)] if (caution := caution_words.said(caution_words.of_cases(sol))) else []
    shape = f" of {each.size} cases" if each.size > 1 else ""
    return _table(f"Solution{shape}, {sol.t.shape[-1]} stations", rows)


def table_of_case(case: Case) -> str:
    """The fields of its parts."""
    rows = []
    for part in (case.rod, case.cylinder, case.given):
        name = type(part).__name__
        for field in fields(part):
            value = getattr(part, field.name)
            if value is not None and not (field.name == "stiffness" and case.rod.EI is not None):
                rows.append((f"{name}.{field.name}", _field(value)))
    grid = f" of shape {case.shape}" if case.shape else ""
    return _table(f"{'Ends' if case.kind == 'ends' else 'Start'} problem{grid}", rows)


def table_of_equilibria(found: Equilibria) -> str:
    """A row for each equilibrium."""
    held = "held " if found and found[0].solution.held else ""
    heads = [f"{held}{name}" if name.startswith("energy") else name for name in HEADINGS]
    rows = []
    slopes = distinct_texts((member.dbeta0 for member in found), lambda slope, digits: f"{slope:.{digits}g}", 6)
    for i, (member, slope) in enumerate(zip(found, slopes, strict=True), 1):
        numbers = f"{member.energy:.6g}", str(member.bends), slope, f"{member.attached:.0%}"
        rows.append((str(i), *map(labels.minus_signs, (stability(member.index), *numbers))))
    remark = found.remark or "the list passes the test of completeness"
    return _table(f"{len(found)} {'equilibrium' if len(found) == 1 else 'equilibria'}: {remark}", rows, heads)


def _table(caption: str, rows: Sequence[Sequence[str]], heads: Sequence[str] = ()) -> str:
    """An HTML table, a heading first in each row; without `heads` of numbers and sentences, set flush left."""
    left = "" if heads else ' style="text-align: left"'  # Jupyter's own style sets cells flush right
    head = f"<tr>{''.join(f'<th>{escape(name)}</th>' for name in heads)}</tr>" if heads else ""
    lines = "".join(
        f"<tr><th>{escape(first)}</th>{''.join(f'<td{left}>{escape(cell)}</td>' for cell in cells)}</tr>"
        for first, *cells in rows
    )
    return f"<table><caption>{escape(caption)}</caption>{head}{lines if heads else labels.typeset(lines)}</table>"


def _field(value: Any) -> str:
    """A number, a word, or the span of an array."""
    if isinstance(value, str):
        return value
    low, high = (f"{float(end):.6g}" for end in (np.min(value), np.max(value)))
    return low if np.ndim(value) == 0 else f"{np.size(value)} values from {low} to {high}"


def _span(name: str, values: Any) -> str:
    """A value, or the smallest and the largest, with the unit in words."""
    low, high = (labels.number(float(value)) for value in (values.min(), values.max()))
    unit = labels.unit(unit_of(name, all_units(None)))
    return f"{low if low == high else f'{low} to {high}'}{f' [{unit}]' if unit else ''}"
