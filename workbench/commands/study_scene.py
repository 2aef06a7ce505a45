"""The cases of a scene at as many stations as the picture needs: of a study, or of a file that stores too few.

The rods are solved at a few stations, or read, and the camera is set up; where its pixels need more stations, the rods
are solved again at as many. The result is a dataset like any other, and is drawn like any other.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from solver.free.free_rods import FREE_TOLERANCE
from solver.free.let_go_descent import ELSEWHERE
from solver.problem.errors import DEFAULT_TOLERANCE, InputError
from studies import Study, load
from studies.grammar.axes import Axis
from studies.language.study import OUTPUTS

from ..run import in_memory
from ..scene.scene_kinds import CASE, NOTE, RELEASED, SceneKind, case_values
from ..stored import enough_stations, file_kinds, quantity_variables, reading, schema
from ..stored.case_of_file import is_study
from ..stored.enough_stations import Solve, is_whole
from ..stored.solved_again import point_forces_of
from ..stored.stored_cases import is_wide
from ..stored.stored_study import StoredStudy

FIRST = 21  # stations that are tried first
MOST_CASES = 10_000
TRIED, STEP, JUMP, LEAST = 49, 0.12, 1.0, 72  # of a film: first values, motion a frame in rho, at most; frames
RELEASED_ARRAYS = ("beta", "dbeta", "alpha", "z", "contact")  # of both rods of a release
WAY = {"long_name": "way to rest", "symbol": "way to rest", "units": "%"}
ENERGY = "energy_above_rest", {"long_name": "energy above that at rest", "symbol": "energy"}
MOTION = "a descent of the energy, as in a viscous medium"
OTHER_REST = "it comes to rest in another minimum of the energy than workbench solve --let-go"


def open_rods(file: Path, whole: bool = False) -> tuple[Study | None, StoredStudy]:
    """The study of a name or a TOML file, and its rods as of `two_stations`; or None, and a stored dataset.

    whole: the rods of a study are solved at its own stations. Raises `InputError` for a file that is no study and
    holds no equilibria.
    """
    if is_study(file):
        return two_stations(file, whole)
    kind = reading.kind_of_file(file)
    if kind is not file_kinds.STUDY and not kind.scene:
        raise file_kinds.other_kind(file, kind, "scene draws studies, equilibria and branches")
    return None, reading.read_stored(file, study=kind is file_kinds.STUDY)


def solver_of(stored: StoredStudy, kind: SceneKind, at: dict[str, float], shown: Sequence[str]) -> Solve | None:
    """What solves the cases that a scene shows, of a dataset of `open_rods`; None where no study gives them.

    shown: the axes of which all cases are shown.
    """
    where, kept = stored.place(at), {stored.axis(name) for name in shown}
    held = {name: where[name] for name in stored.axes if name not in kept}
    return enough_stations.solver_of(stored, held, kind.reads)


def release_of(stored: StoredStudy, at: Mapping[str, float], count: int | None = None) -> Solve:
    """What solves one case of a study twice, held on the cylinder and let go, at a number of stations.

    The two stand along the dimension `scene_kinds.RELEASED`, with the point forces. count: so many shapes of the motion
    between stand there instead, from the rod that is held on to the rod at rest, with the energy above that at rest.
    Raises `InputError` for a case that may leave the cylinder by itself, and one that no study gives.
    """
    if not is_whole(stored) or (stored.leaves and not stored.study.let_go):
        raise InputError("the kind let-go takes the study of a rod that the cylinder holds on, which is then let go")
    lean = _study_at(stored.study, stored, stored.place(at), []).model_copy(update={"laws": [], "observables": []})
    case = case_values(stored, stored.place(at))
    plain = {"let_go": False, "method": "auto", "tol": DEFAULT_TOLERANCE, "outputs": [*RELEASED_ARRAYS]}
    let_go = {"let_go": True, "method": "auto", "tol": FREE_TOLERANCE, "outputs": [*RELEASED_ARRAYS, "radius"]}

    def solve(stations: int) -> StoredStudy:
        held, free = (in_memory.run(lean.model_copy(update=how).at_stations(stations)) for how in (plain, let_go))
        for ds in (held, free):
            if not ds["solved"].all():
                raise InputError(f"nothing to draw: {ds['outcome'].values.ravel()[0]}")
        held = held.assign(radius=held["rho"].broadcast_like(held["z"]))
        names = [name for name in free.variables if name in held.variables]
        held, free = (ds[names].squeeze([str(dim) for dim in ds["outcome"].dims]) for ds in (held, free))
        shapes, said = [free], {CASE: case}
        if count is None:
            forces = xr.Dataset(point_forces_of(StoredStudy(free).at(), ())).expand_dims({RELEASED: 1})
            more = forces.pad({RELEASED: (1, 0)})
        else:
            sol, energy = StoredStudy(held).at().descent(count - 1, FREE_TOLERANCE)
            along = {name: getattr(sol, name) for name in (*RELEASED_ARRAYS, "radius")}
            shapes = [free.assign({name: ("u", row[k]) for name, row in along.items()}) for k in range(count - 1)]
            shapes[-1] = shapes[-1].assign(outcome=((), str(sol.outcome[-1])))
            said |= {NOTE: MOTION + f"; {OTHER_REST}" * (sol.begun[-1] == ELSEWHERE)}
            unit = {"units": f"{free.attrs['force_unit']} {free.attrs['length_unit']}"}
            more = xr.Dataset({ENERGY[0]: ((RELEASED,), energy, ENERGY[1] | unit)})
        places = np.linspace(0, 100, len(shapes) + 1)
        pair = xr.concat([held, *shapes], xr.Variable((RELEASED,), places, WAY), coords="minimal", compat="override")
        kept = {name: value for name, value in free.attrs.items() if count is None or name != "study"}
        return StoredStudy(pair.merge(more.assign_coords({RELEASED: pair[RELEASED]})).assign_attrs(kept | said))

    return solve


def two_stations(file: Path, whole: bool = False) -> tuple[Study, StoredStudy]:
    """The study, and its dataset at two stations a case, from which the cases that are drawn are chosen; or the whole.

    Raises `InputError`, also for more cases than are solved for one picture.
    """
    study = load(file).coarse()
    if study.variation.size > MOST_CASES:
        raise InputError(
            f"{study.name} has {study.variation.size} cases, and at most {MOST_CASES} are solved for a picture: store "
            "it with workbench run, and draw the file"
        )
    stored = in_memory.run(study if whole else _with_outputs(study, ()).at_stations(2))
    return study, StoredStudy(stored.assign_attrs(laws=schema.laws_text(study)))  # they fix where an axis is held


def _study_at(study: Study, stored: StoredStudy, where: Mapping[str, int], free: Collection[str]) -> Study:
    """The study with one value on each axis but the free ones: that of the dataset at an index."""
    axes = dict(study.axes)
    for name in axes.keys() - {*free}:
        dim = quantity_variables.dimension(name)
        axes[name] = Axis.model_validate({"values": [float(stored[dim].values[where[dim]])]})
    return study.model_copy(update={"axes": axes})


def field_between(stored: StoredStudy, axis: str) -> str | None:
    """The field of an axis where a study gives the cases at any value of it, also between the stored ones."""
    if not is_whole(stored):
        return None
    study = stored.study
    field = quantity_variables.field_of(study, axis)
    return field if field in study.axes and not (study.variation.from_base or study.variation.sampled) else None


def film_cases(
    stored: StoredStudy,
    axis: str,
    at: dict[str, float],
    kind: SceneKind,
    observable: str,
    most: int,
    count: int | None = None,
    run: Callable[[Study], xr.Dataset] = in_memory.run,
    run_first: Callable[[Study], xr.Dataset] = in_memory.run,
) -> StoredStudy | None:
    """The cases of a film along an axis, at most so many: as many as let no rod move far from one to the next.

    count: so many cases, at an even pace of the rod. Rods off the wall may take seconds each, so between two stored
    ones their pace is taken as even. run: solves the cases, and run_first those from which the pace of others is found.
    None for a dataset without a `field_between`. Raises `InputError` of the solver.
    """
    field = field_between(stored, axis)
    if field is None:
        return None
    study = stored.study
    lean = _with_outputs(study, kind.reads | {"dbeta"}).model_copy(update={"observables": [observable]})
    lean = _study_at(lean, stored, stored.place(at), [field])

    def through(values: Any) -> Study:
        axes = {**lean.axes, field: Axis.model_validate({"values": list(values)})}
        return lean.model_copy(update={"axes": axes})

    low, high = float(stored[axis].values[0]), float(stored[axis].values[-1])
    values = (np.geomspace if is_wide(low, high) else np.linspace)(low, high, TRIED)
    first = None
    if lean.leaves:
        line = stored.select({name: i for name, i in stored.place(at).items() if name != axis}).ds
        if {"alpha", "z", "radius"} <= {*line.variables} and bool(line["solved"].all()):
            first, values = line.sortby(axis), np.sort(line[axis].values)
    first = run_first(through(values)) if first is None else first
    steps = np.clip(np.nan_to_num(StoredStudy(first).moves(axis)), 0.02 * STEP, JUMP)
    way = np.append(0.0, np.cumsum(steps))
    count = count or int(np.clip(np.ceil(way[-1] / STEP), LEAST, most))
    moved = through(np.interp(np.linspace(0, way[-1], count), way + 1e-9 * np.arange(values.size), values))
    cases = run(moved)
    spacing = "geometric" if stored.is_logarithmic(axis) else "linear"  # the scale of the axis, not of the motion
    return StoredStudy(cases.assign_coords({axis: cases[axis].assign_attrs(spacing=spacing)}))


def _with_outputs(study: Study, outputs: Any) -> Study:
    """The study with these outputs alone, and those that the curve of a rod needs besides.

    With weight or friction that is its contact force, and where it may leave the cylinder its radius too.
    """
    also = [*["contact"] * (study.varies or study.leaves), *["radius"] * study.leaves]
    needed = {*outputs, *also} if outputs else outputs
    return study.model_copy(
        update={"outputs": [name for name in OUTPUTS if name in needed], "observables": [], "laws": []}
    )
