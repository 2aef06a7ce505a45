"""A rod with weight or friction in words: its state along the length, when that changes, and what to mind."""

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from solver.nodes.loaded_rod import rods_of
from solver.nodes.pipe_states import LEAVES, RUBS, STRAIGHT, in_words
from solver.observe.observables import NO_TORQUE
from solver.problem.declared_fields import OFF_WALL

from . import caution_words, outcome_counts, unit_habits
from .pipe_profile import PUSH, ROUNDING, ProfileRow, axial_force, number, place_in_words, profile, weight_across
from .unit_habits import intervals, plain

if TYPE_CHECKING:
    from solver import Case, Solution

SINUSOID, PRESSED = 2.0, 2.744687  # forces in sqrt(A w sin(theta)/rho), as of `studies/pipe_horizontal.toml`
LIKELY = "less energy than the sinusoid"
LIMITS = (  # what happens at each of these, and what the load is called
    ("sinusoid from", "Dawson-Paslay"),
    ("helix possible from", "pressed on the wall all along"),
    ("helix likely from", LIKELY),
    ("sinusoid lifts off above", "lift-off"),
)
EXPECTED = (  # in a long pipe, by the number of the loads above that are reached
    "a straight pipe",
    "a sinusoid, as no helix can stay",
    "a sinusoid; a helix that a larger load has left can stay, but has more energy",
    "a sinusoid while the load grows and nothing disturbs the pipe; a helix, which has less energy, after a strong "
    "disturbance or a larger load",
    "a helix, as a sinusoid would lift off in places",
)
MOST = 6  # stretches that are listed
SLIGHT = 0.1  # of the largest bend: a smaller one is a ripple beside it
WAYS = {
    "forward": "slides along itself towards s = L everywhere",
    "backward": "slides along itself towards s = 0 everywhere",
    "rotating": "turns in place everywhere",
    "axial-forward": "moves as a whole along the hole, towards s = L",
    "axial-backward": "moves as a whole along the hole, towards s = 0",
}
TENSION = "in tension all along: a compression, as by a weight on the bit, is a positive wob, or a negative FZ"
STIFFEST, DENSEST = 1.3e6, 23e3  # MPa, kg/m3: above diamond and osmium
GRAVITY = 9.81  # m/s2
STEADY = 1e-6  # deg: a lay that varies by less is one, and a bend that turns less is none


class Limit(NamedTuple):
    """A local compression [force] at which a long pipe changes its state: what happens there, and its name."""

    load: str
    name: str
    value: float


def rise(case: "Case") -> float:
    """How steeply s climbs, -1 to 1; 0 where neither end is lower."""
    steep = math.cos(float(case.cylinder.inclination or 0)) * bool(case.rod.weight)
    return steep if abs(steep) >= ROUNDING else 0.0


def lower_end(case: "Case") -> str:
    """That ``s = 0`` or ``s = L`` is the lower end, in a sentence."""
    if not (steep := rise(case)):
        return "neither end is lower"
    low, high = ("s = 0", "s = L")[:: 1 if steep > 0 else -1]
    return f"{low} is the lower end, {high} the upper one"


def all_sentences(sol: "Solution", units: dict[str, str]) -> list[str]:
    """The sentences, the rows as sentences too, and the warnings."""
    rows = profile(sol, units)
    each = [
        f"{row.name}: {plain(row.start)} {row.unit} at s = 0; {plain(row.far)} at s = L; in the middle third "
        f"{plain(row.middle)}; at most {plain(row.largest)}, {place_in_words(row.at)}"
        for row in rows
    ]
    loads = [f"{row.load} {plain(row.value)} {units['force']} ({row.name})" for row in limits(sol.case)]
    said = f"local compression in a long pipe without torque or friction: {', '.join(loads)}"
    return [*sentences(sol, units), *[said] * bool(loads), *each, *warnings(sol, units, rows)]


def sentences(sol: "Solution", units: dict[str, str]) -> list[str]:
    """The sentences on one case, where it is not solved the loads alone; none of a rod without weight and friction."""
    if not sol.case.varies:
        return []
    length, force = units["length"], units["force"]
    if not sol.solved:
        return [*_torque_if_straight(sol.case, units), *_buckling_load(sol, force)]
    said = [f"state: {in_words(sol.states, length)}"]
    if not sol.case.leaves:
        said = [f"{said[0]}{_doubt(sol)}; {_stability(sol)}", *_ripples(sol)]
    elif all(low == high for low, high in sol.contacts):  # its outcome says that it is stable
        said = []  # the azimuth of a bow between points of the wall is no wave
    said += [way] if (way := way_of(str(sol.begun or ""))) else []
    if sol.case.cylinder.side == "inside" and min(axial_force(sol)) > 0:
        said.append(TENSION)
    said += [*_friction(sol, units), *_buckling_load(sol, force), *_expectation(sol, force)]
    return [*said, *[lower_end(sol.case)] * bool(sol.case.rod.weight)]


def lay_sentence(sol: "Solution", force: str) -> str:
    """Whether a rod that is wound under weight or friction is a helix, and its tension at both ends, in a sentence."""
    range_ = _turn(sol)
    at_ends = f"tension F3 {plain(float(sol.F3[-1]))} {force} at s = L, {plain(float(sol.F3[0]))} {force} at s = 0"
    if range_ < STEADY:
        return f"shown: the helix of this lay; {at_ends}"
    return f"shown: a rod under the loads of this helix at s = L, whose lay varies by {range_:.3g} deg; {at_ends}"


def _turn(sol: "Solution") -> float:
    """By how much beta varies along the rod [deg]."""
    return math.degrees(float(np.ptp(sol.beta)))


def way_of(begun: str) -> str:
    """What a rod does on its way from the straight one but buckle under its loads; begun: as a `Solution` has it."""
    words = next((begun[begun.index(words) :] for words in (LEAVES, RUBS) if words in begun), "")
    return words and f"on the way to these loads the rod {words}"


def count_left(begun: str) -> int:
    """How many branches of equilibria the way from the straight rod leaves; begun: as in `way_of`."""
    return begun.count(LEAVES)


def _doubt(sol: "Solution") -> str:
    """That a real rod does not have the shape, or has another one in places; "" where nothing or the ends alone do."""
    text = str(caution_words.of_cases(sol))
    if not caution_words.is_barred(text):
        return ""
    in_part = all(part.startswith((caution_words.IN_PART, caution_words.UNKNOWN)) for part in caution_words.parts(text))
    return f", which {'in places ' * in_part}no real rod could hold: see the caution"


def _stability(sol: "Solution") -> str:
    """Whether the shape is stable, in words."""
    if sol.case.cylinder.friction:
        return "whether it is stable is not known, as friction has no energy"
    index = float(sol.held_index)
    if not math.isfinite(index):
        return "of a start problem with weight no Morse index is computed"
    return f"{outcome_counts.stability(int(index))}{' (index 0)' * (index == 0)}"


def _friction(sol: "Solution", units: dict[str, str]) -> list[str]:
    """The friction in all, the torque of a rod that turns, and how far one is pushed; nothing without any."""
    wall, force = sol.case.cylinder, units["force"]
    if not wall.friction:
        return []
    scale = float(wall.friction) * float(sol.case.rod.L)
    pushed, pulled = (scale * number(sol, name) for name in ("push_mean", "pull_mean"))
    text = f"friction {plain(pushed)} {force} in all, of a rod that {WAYS[str(wall.sliding)]}"
    if pulled > 5e-4 * pushed:  # the model's friction turns round with the push
        text += f"; where the wall would pull, the model takes {plain(pulled)} {force} off again"
    return [text, *_reach(sol, units)]


def _reach(sol: "Solution", units: dict[str, str]) -> list[str]:
    """The torque of a rod that turns in place, or over which length a push arrives, in a sentence."""
    length, force = units["length"], units["force"]
    if sol.case.cylinder.turns_in_place:
        torque = number(sol, "surface_torque")
        if math.isnan(torque):
            return [f"which torque turns it is unknown: {NO_TORQUE}"]
        return [f"torque {plain(torque)} {force} {length} at the surface end, s = 0, turns it"]
    reach, most = (number(sol, name) for name in ("reach", "arriving_max"))
    if math.isnan(reach) and math.isnan(most):
        return []
    carried = "it does not lock up, as its weight carries it"
    locks = carried if math.isnan(reach) else f"it locks up at {plain(reach)} {length}"
    name = "s = L" if sol.case.cylinder.sense[0] > 0 else "s = 0"
    at_most = f"; {most_that_arrives(sol.case, most, units)}" * (most > 0)
    return [f"reach: with this load at {name} {locks}{at_most}"]


def _torque_if_straight(case: "Case", units: dict[str, str]) -> list[str]:
    """The torque that friction takes of a straight rod that turns in place and leans, in a sentence; none of others."""
    if not case.cylinder.turns_in_place or not (across := weight_across(case)):
        return []
    f = float(case.cylinder.friction or 0)
    torque = f * float(case.rod.a) * across * float(case.rod.L) / math.hypot(1, f)
    return [f"of a straight rod friction would take a torque of {plain(torque)} {units['force']} {units['length']}"]


def most_that_arrives(case: "Case", most: float, units: dict[str, str]) -> str:
    """How large a push may be at the end towards which a rod slides, in a sentence; most: of `arriving_max`."""
    return f"over {plain(float(case.rod.L))} {units['length']} at most {plain(most)} {units['force']} arrives"


def _ripples(sol: "Solution") -> list[str]:
    """That some bends are much smaller than others, as the number of bends counts all of them.

    What turns less than `STEADY` is not said: nobody sees it.
    """
    sizes = [size for _, angle in sol.bends_at if (size := math.degrees(angle)) >= STEADY]
    if not sizes or all(state.word == STRAIGHT for state in sol.states) or min(sizes) > SLIGHT * max(sizes):
        return []
    ripples = sum(size <= SLIGHT * max(sizes) for size in sizes)
    return [
        f"bends: the largest of the {len(sizes)} changes the angle by {max(sizes):.3g} deg; {ripples} of them "
        f"{'is a ripple' if ripples == 1 else 'are ripples'} of less than a tenth of that"
    ]


def warnings(sol: "Solution", units: dict[str, str], rows: list[ProfileRow]) -> list[str]:
    """What to mind about the shape and the rows of a rod with weight or friction: what a real rod does otherwise."""
    if not rows:
        return _wrong_units(sol, units) if sol.case.varies else []
    push = next(row for row in rows if row.name == PUSH)
    said = [*_wrong_units(sol, units), *_lift_offs(sol, units["length"]), *_clamps(sol, push)]
    text = str(caution_words.of_cases(sol, units=units))
    parts = caution_words.parts(text)
    others = caution_words.said(", ".join(part for part in parts if not part.startswith(caution_words.PULLED)))
    return said + [f"caution: {others.removesuffix('.')}"] * bool(others)


def _wrong_units(sol: "Solution", units: dict[str, str]) -> list[str]:
    """That no material is so stiff or so heavy: a number was meant in another unit."""
    rod = sol.case.rod
    stiffness = float(rod.E or 0) * unit_habits.size("MPa", (-2, 1), units)
    section = math.pi * float(rod.a) ** 2  # it may leave the range of floats
    in_newtons = unit_habits.size("N/m^3", (-3, 1), units)
    density = float(rod.weight or 0) * in_newtons / (GRAVITY * section) if section else 0.0
    said = []
    if stiffness > STIFFEST:
        said.append(
            f"caution: E is {stiffness:.3g} MPa, and no material has more than {STIFFEST:.3g}: is its unit right?"
        )
    if density > DENSEST:
        most = f"no material has more than {DENSEST:.3g}"
        said.append(f"caution: the weight is that of a rod of {density:.3g} kg/m3, and {most}: is its unit right?")
    return said


def _lift_offs(sol: "Solution", length: str) -> list[str]:
    """Where a rod would lift off the wall, in a sentence; none where it does nowhere."""
    stretches, text = sol.lift_offs, str(caution_words.of_cases(sol))
    if not stretches or caution_words.PULLED not in text:
        return []
    share = 100 * sum(end - begin for begin, end in stretches) / float(sol.case.rod.L)
    where = intervals([(plain(begin), plain(end)) for begin, end in stretches[:MOST]], length)
    more = f", and on {len(stretches) - MOST} more stretches" if len(stretches) > MOST else ""
    so = "a real rod takes another shape there" if caution_words.IN_PART in text else "a real rod leaves the wall there"
    so = "no real rod has this shape" if caution_words.ALL_ALONG in text else so
    return [f"caution: the push is below 0 on {share:.2g} % of the length, {where}{more}: {so}"]


def _clamps(sol: "Solution", push: ProfileRow) -> list[str]:
    """That the push at a clamped end is not that of the rod; nothing of a straight rod, of a helix and of hinges."""
    ends = ("s = 0", "beta0"), ("s = L", "betaL")
    places = [place for place, angle in ends if getattr(sol.case.given, angle, None) is not None]
    if sol.case.leaves or not places or all(state.word == STRAIGHT for state in sol.states) or _turn(sol) < STEADY:
        return []
    said = f"the push at {' and '.join(places)} is that next to a clamp"
    return [f"{said}; a wave away from the ends it is at most {plain(push.inside)} {push.unit}"]


def _load(tension: float, force: str) -> str:
    """A load below which, as a tension, something happens."""
    words = "a compression above" if tension <= 0 else "a tension below"
    return f"{words} {plain(abs(tension))} {force}"


def _buckling_load(sol: "Solution", force: str) -> list[str]:
    """The load at which the straight rod buckles under its whole weight, or, of one that turns in place and so leans,
    the leaning rod; none where neither is an equilibrium.
    """
    from solver.free.starting_curves import bilateral_cases
    from solver.nodes.buckling import rod_without_lean, tension_of_buckling
    from solver.nodes.loaded_solutions import why_unsolved

    case = sol.case
    if case.kind != "ends" or case.cylinder.side == "outside" or (case.leaves and not _rests(case)):
        return []
    rod = rods_of(bilateral_cases(case)[0] if case.leaves else case)[0]
    if why_unsolved(rod):
        return []
    who = f"the straight rod{' without friction' * rod.has_friction}"
    if rod.rotates and not rod.straight:
        rod, who = rod_without_lean(rod), "the rod that leans by its friction"
    if not rod.straight:
        return []
    phi, unit = tension_of_buckling(rod), float(case.rod.bending_stiffness) / float(case.rho) ** 2
    if phi is None:
        return [f"{who} is unstable even in tension, by its torque"]
    near, far = ((phi - part) * unit for part in (rod.along * rod.span, 0.0))
    start = f" ({_load(near, force)} at s = 0)" if abs(far - near) > 1e-9 * abs(far) else ""
    return [f"{who} buckles with {_load(far, force)} at s = L{start}"]


def _rests(case: "Case") -> bool:
    """Whether the straight rod of one that may leave the wall rests on it, so that it buckles along it."""
    if any(getattr(case.given, name) for name in OFF_WALL[2:]) or not np.all(np.equal(case.end_radii, case.rho)):
        return False
    return weight_across(case) * math.cos(float(case.given.alpha)) > 0


def limits(case: "Case") -> list[Limit]:
    """The compressions at which a long pipe of this weight changes its state; none without weight across the axis."""
    from solver.nodes.local_waves import EQUAL, LIFTED

    if not (size := _size_of_limits(case)):
        return []
    multiples = SINUSOID, PRESSED, 2 + EQUAL, 2 + LIFTED
    return [Limit(*words, x * size) for words, x in zip(LIMITS, multiples, strict=True)]


def _size_of_limits(case: "Case") -> float:
    """The unit of the compressions at which a long pipe changes its state, 0 where it does not."""
    if not case.varies or case.cylinder.side == "outside":
        return 0.0
    return math.sqrt(float(case.rod.bending_stiffness) * weight_across(case) / float(case.rho))


def _expectation(sol: "Solution", force: str) -> list[str]:
    """What is expected of a long pipe at the largest compression; of a bent shape without torque and friction."""
    reached = [limit.value for limit in limits(sol.case)]
    given = sol.case.given
    torque = any(float(getattr(given, load, None) or 0) for load in ("MZ", "M3"))
    straight = all(state.word == STRAIGHT for state in sol.states)
    if not reached or sol.case.cylinder.friction or torque or straight:
        return []
    most = -float(min(axial_force(sol)))
    expected = EXPECTED[sum(most >= value for value in reached)]
    return [f"expected of a long pipe at {plain(most)} {force}, the largest compression here: {expected}"]
