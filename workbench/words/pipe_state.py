"""A rod with weight or friction in sentences: its state along the length, when that changes, the forces at its ends."""

import math
from typing import TYPE_CHECKING, Any

from solver.shooting.state import in_words

from . import cautions

if TYPE_CHECKING:
    from solver import Solution

SINUSOID, PRESSED = 2.0, 2.744687  # forces in sqrt(A w sin(theta)/rho), as of `studies/pipe_horizontal.toml`
MOST = 6  # stretches that are listed
NEWS = "leaves its branch", "buckles where friction", "stays straight"  # as `solver.shooting.answers` says it
WAYS = {
    "forward": "slides forward along itself everywhere",
    "backward": "slides backward along itself everywhere",
    "rotating": "turns in place everywhere",
    "axial-forward": "moves forward as a whole",
    "axial-backward": "moves backward as a whole",
}
REACHES = {"m": 30.0, "ft": 100.0}  # lengths on which drillers state a dogleg


def sentences(sol: "Solution", units: dict[str, str]) -> list[str]:
    """The sentences on one case, where it is not solved the loads alone; none of a rod without weight and friction."""
    if not sol.case.varies:
        return []
    length, force = units["length"], units["force"]
    if not sol.solved:
        return [*_buckling(sol, force), *_long_pipe(sol, force)]
    barred = cautions.is_barred(str(cautions.of_cases(sol, unit=length)))
    said = [f"state: {in_words(sol.states, length)}{', which no real rod could hold: see the caution' * barred}"]
    said += _lift_offs(sol, length)
    begun = str(sol.begun or "")
    news = next((begun[begun.index(words) :] for words in NEWS if words in begun), "")
    said += [f"on the way to these loads the rod {news}"] * bool(news)
    said += _buckling(sol, force)
    said += _long_pipe(sol, force)
    said.append(_ends(sol, force, length))
    reach = REACHES.get(length, 1.0)
    most = math.degrees(_observe(sol, "kappa_max")) * reach
    said.append(f"largest dogleg {most:.4g} deg in {reach:g} {length}")
    if sol.case.rod.E is not None:
        said[-1] += f", bending stress {_stress(sol, length, force)}"
    said.append(_index(sol) + ", if the cylinder could pull" * (barred and not sol.case.cylinder.friction))
    return said


def _lift_offs(sol: "Solution", length: str) -> list[str]:
    """Where the wall would have to pull, in a sentence; none where it does nowhere."""
    found = [f"{begin:.4g} to {end:.4g} {length}" for begin, end in sol.lift_offs]
    if not found:
        return []
    more = f", and {len(found) - MOST} more stretches" if len(found) > MOST else ""
    return [f"the wall presses, but for where it would have to pull: {', '.join(found[:MOST])}{more}"]


def _observe(sol: "Solution", name: str) -> float:
    from solver import observe

    return float(observe(sol, [name])[name])


def _stress(sol: "Solution", length: str, force: str) -> str:
    """The largest bending stress, in MPa where lengths are in metres."""
    most = _observe(sol, "bending_stress_max")
    sizes = {"N": 1e-6, "kN": 1e-3, "MN": 1.0}
    return f"{most * sizes[force]:.4g} MPa" if length == "m" and force in sizes else f"{most:.4g} {force}/{length}^2"


def _buckling(sol: "Solution", force: str) -> list[str]:
    """The load at which the straight rod buckles under its whole weight; none where it is no equilibrium."""
    from solver.shooting.buckling import buckling_tension
    from solver.shooting.numbers import rods_of

    if sol.case.kind != "ends" or sol.case.cylinder.side == "outside":
        return []
    rod = rods_of(sol.case)[1][0]
    if not rod.straight:
        return []
    phi, unit = buckling_tension(rod), float(sol.case.rod.bending_stiffness) / float(sol.case.rho) ** 2
    who = f"the straight rod{' without friction' * rod.rubbed}"
    if phi is None:
        return [f"{who} is unstable even in tension, by its torque"]
    near, far = ((phi - part) * unit for part in (rod.along * rod.span, 0.0))
    start = f" ({near:.6g} at s = 0)" if abs(far - near) > 1e-9 * abs(far) else ""
    return [f"{who} buckles where FZ at s = L is below {far:.6g} {force}{start}"]


def _long_pipe(sol: "Solution", force: str) -> list[str]:
    """The compressions at which a long pipe of this weight changes its state; none without weight across the axis."""
    from solver.shooting.local_waves import EQUAL, LIFTED

    rod, wall = sol.case.rod, sol.case.cylinder
    across = float(rod.weight or 0) * math.sin(float(wall.inclination or 0))
    if across <= 1e-12 * float(rod.weight or 1) or wall.side == "outside":
        return []
    unit = math.sqrt(float(rod.bending_stiffness) * across / float(sol.case.rho))
    one, two, three, four = (f"{x * unit:.4g}" for x in (SINUSOID, PRESSED, 2 + EQUAL, 2 + LIFTED))
    return [
        f"local compression in a long pipe without torque or friction: straight below {one} {force}; from {two} a "
        f"helix can stay, from {three} it has less energy than the sinusoid; above {four} the sinusoid lifts off the "
        "wall: expect a helix"
    ]


def _ends(sol: "Solution", force: str, length: str) -> str:
    near, far = (_observe(sol, name) for name in ("FZ0", "FZ"))
    near, far = (value if abs(value) > 1e-12 * max(abs(near), abs(far)) else 0.0 for value in (near, far))
    wall = sol.case.cylinder
    text = f"axial force {near:.6g} {force} at s = 0 and {far:.6g} {force} at s = L"
    text += f"; push {float(sol.push[0]):.4g} and {float(sol.push[-1]):.4g} {force}/{length}"
    if wall.friction:
        text += (
            f"; friction {' and '.join(f'{float(wall.friction * sol.push[i]):.4g}' for i in (0, -1))} {force}/{length}"
        )
        pushed, pulled = (
            float(wall.friction) * _observe(sol, name) * float(sol.case.rod.L) for name in ("push_mean", "pull_mean")
        )
        text += f", {pushed:.4g} {force} in all, of a rod that {WAYS[str(wall.sliding)]}"
        if pulled > 5e-4 * pushed:  # the model's friction turns round with the push
            text += f"; where the wall would pull, the model takes {pulled:.4g} {force} off again"
    return text


def _index(sol: "Solution") -> str:
    """Whether the shape is stable, in words."""
    if sol.case.cylinder.friction:
        return "with friction there is no energy, hence no Morse index: whether the shape is stable is not known"
    index: Any = sol.held_index
    if not math.isfinite(index):
        return "of a start problem with weight no Morse index is computed"
    return "stable (index 0)" if index == 0 else f"unstable in {index:.0f} way{'s' * (index != 1)}"
