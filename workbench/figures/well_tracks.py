"""A pipe in a hole for a report: tracks side by side with the measured depth down, and weight on bit against slack-off.

The tracks are of one pipe. The last panel is of all the pipes of a study over the load.
"""

from collections.abc import Mapping
from functools import partial
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from solver.nodes.pipe_states import in_words
from solver.problem.errors import InputError
from studies.laws.line_verdicts import FAILS

from ..stored import derived_arrays
from ..stored.stored_study import StoredStudy
from ..words import free_rod_words, labels, pipe_profile, pipe_words, unit_habits
from ..words.unit_habits import plain
from . import canvas, colours, drawn_rods, fonts, print_heights, push_scale, trends, waves
from .drawn_rods import DrawnRod
from .sheet import SCREEN, Sheet

if TYPE_CHECKING:
    from solver import Case

ARRAYS = ("alpha", "beta", "push", "kappa", "F2", "F3", "M3_along")
FORCE, PUSH, GAP, DOGLEG, STRESS, SLACK_OFF = "force", "push", "gap", "dogleg", "stress", "slack-off"  # panels
ROWS = {
    pipe_profile.FORCE: FORCE,
    pipe_profile.PUSH: PUSH,
    pipe_profile.DOGLEG: DOGLEG,
    pipe_profile.STRESSES[2]: STRESS,
}
LOADS = ("wob", "FZ0", "FZ")  # the axes with a weight on bit
TALL, WIDE = 3.4, 1.9  # inches of the tracks, and of the last panel
NARROW = 3.2  # of all rows on a narrow sheet
NEXT = 1.3  # of the largest compression: up to there a limit that is not reached is shown
MARGIN = 0.06  # of the range of a track
CLOSE = 0.7  # points of a curve beside a band
STEEP = 0.5**0.5  # of s, 45 degrees up: holes that are drilled climb less
DOT = 0.07  # inches of a dot
STRIP = 1.06, 1.14  # where the states stand beside a track, in its width
BANDS = (
    ("sinusoid", colours.STATES["sinusoidal"], 0.22),
    ("or helix", "#7f9fa6", 0.3),
    ("sinusoid lifts off", colours.PULLED, 0.3),
)
JUMP = "jumps to another shape"
AXIAL = "axial, tension positive"
YIELDS, ABOVE = "the drawn pipe yields", "above yield"
FAILING = colours.VERDICTS[FAILS]


def figure(
    stored: StoredStudy,
    x: str | None = None,
    at: Mapping[str, float] | None = None,
    yield_stress: float | None = None,
    sheet: Sheet = SCREEN,
) -> Figure:
    """Draw one pipe in tracks, and weight on bit against slack-off where the study varies the load.

    Parameters
    ----------
    stored : StoredStudy
    x : str, optional
        The axis of the load, for the last panel; default: the first of wob, FZ0 and FZ that is an axis.
    at : mapping, optional
        The values of axes at which the pipe is drawn; an axis that is not named stays where the laws put it.
    yield_stress : float, optional
        The stress at which the pipe yields, in the unit of the file.
    sheet : Sheet
        What the figure is drawn for. Its panel is one of them.

    Raises
    ------
    InputError
        For a pipe without weight and friction or outside a cylinder, one that climbs more steeply
        than a hole, an axis that is no load, and as of `drawn_rods.choose`.
    """
    stored = stored.coarse()
    if not stored.loads_vary or stored.attrs.get("side") != "inside":
        raise InputError(
            "--kind well draws a pipe with weight or friction inside a hole, and the rods of this file are none: "
            "choose --kind ridge or curves"
        )
    place = stored.place(at)
    load = _load_axis(stored, x)
    rods = drawn_rods.choose(stored.select(place), (*ARRAYS, *[GAP] * stored.leaves))
    rod = rods.solved[0]
    case, units = rod.case.case, stored.units
    if pipe_words.rise(case) > STEEP:
        raise InputError(
            "--kind well draws a pipe from its hook, s = 0, down to its bit, and s of this one climbs from its foot: "
            "give hole = 180deg - inclination, and the loads from the other end"
        )
    rows = pipe_profile.quantities(case, SimpleNamespace(**{name: rod[name] for name in ARRAYS}), units)
    tracks = {ROWS[name]: (unit, values) for name, unit, values in rows if name in ROWS}
    tracks |= {GAP: (units["length"], rod[GAP])} if stored.leaves else {}
    panels: dict[str, Any] = {name: partial(_draw_track, rod, case, name, *track) for name, track in tracks.items()}
    panels[FORCE] = partial(_draw_force, rod, case, *tracks[FORCE])
    stress, rest = [values for name, _, values in rows if name in pipe_profile.STRESSES], None
    if stress:
        unit = tracks[STRESS][0]
        most = None if yield_stress is None else yield_stress * unit_habits.size_shown("bending_stress_max", units)
        rest = YIELDS if most is not None and stress[2].max() > most else None
        panels[STRESS] = partial(_draw_stress, rod, unit, stress, most)
    elif yield_stress is not None:
        raise InputError("a stress needs E, and the pipes of this file have EI and GJ")
    said = _sentences(rod, case, tracks, units["length"])
    if load:
        panels[SLACK_OFF] = partial(_draw_slack_off, stored, load, place, yield_stress)
    names, at_case = sheet.choose(panels), stored.equations(place)
    titled = stored.with_title(f"{stored.attrs['title']}, {at_case}") if place else stored

    def draw(count: int) -> Figure:
        drawn = names[:count]
        beside = [panels[name] for name in drawn if name != SLACK_OFF]
        lines = canvas.in_rows(beside, min(2 if sheet.narrow else 5, len(beside)), TALL)
        lines += [(WIDE, [panels[SLACK_OFF]])] if SLACK_OFF in drawn else []
        lines = [(NARROW / len(lines), row) for _, row in lines] if sheet.narrow else lines
        left = canvas.say_left_out(names[count:], "--panel")
        held = [f"The pipe at {at_case}."] if place else []
        return canvas.page(titled, sheet, lines, [*held, *said, *rods.notes, *left], 0.75, rest=rest)

    return print_heights.with_room(draw, len(names))


def _load_axis(stored: StoredStudy, x: str | None) -> str | None:
    """The axis of the load; None where the study varies none. Raises `InputError` for another axis."""
    loads = [name for name in LOADS if stored.sizes.get(name, 1) > 1]
    if x is not None and (x := stored.axis(x)) not in loads:
        raise InputError(f"--x of --kind well is an axis of the load, {', '.join(LOADS)}; got {x}")
    return x or next(iter(loads), None)


def _sentences(rod: DrawnRod, case: "Case", tracks: Mapping[str, tuple[str, Any]], length: str) -> list[str]:
    """The state of the pipe, its largest numbers and the limits of a long pipe."""
    depth = rod["s"]
    said = [f"State: {in_words(_states(rod), length)}, along s."]
    for name, (unit, values) in tracks.items():
        k = int(np.abs(values).argmax())
        value, at = float(values[k]), np.nan if pipe_profile.is_level(values) else float(depth[k])
        if name == PUSH and {"push_max", "push_max_at"} <= {*rod.case.variables}:  # between two stations too
            between = float(rod.case["push_max"]) * unit_habits.size_shown("push_max", rod.case.units)
            if between >= abs(value):
                value, at = between, float(rod.case["push_max_at"])
        most = plain(float(np.abs(_away(rod, case, values)).max()))
        inner = f"; a wave away from the ends it is at most {most} {unit}" * (name == PUSH)
        said.append(f"Largest {WORDS[name]}: {plain(value)} {unit} {pipe_profile.place_in_words(at, length)}{inner}.")
    if GAP in tracks:
        said += map(labels.sentence, free_rod_words.forces_in_words(rod.case.at(), rod.case.units))
    limits = [f"{limit.load} {plain(limit.value)} ({limit.name})" for limit in pipe_words.limits(case)]
    if limits:
        said.append(f"Compression of a long pipe without friction, {tracks[FORCE][0]}: {', '.join(limits)}.")
    return said


WORDS = {
    FORCE: "axial force",
    PUSH: "push of the wall",
    GAP: "gap to the wall",
    DOGLEG: "dogleg",
    STRESS: "stress, axial and bending together",
}


def _away(rod: DrawnRod, case: "Case", values: Any) -> Any:
    """The values of a quantity (n,) that are a wave away from both ends, as in `pipe_profile.profile`."""
    s, ends = rod["s"], pipe_profile.axial_force(SimpleNamespace(**{name: rod[name] for name in ARRAYS}))[[0, -1]]
    wave = pipe_profile.wave_length(case, float(np.abs(ends).max()))
    return values[(s >= wave) & (s <= s[-1] - wave)]


def _states(rod: DrawnRod) -> tuple[Any, ...]:
    return tuple(derived_arrays.states_of(rod.case, *(rod[name] for name in ("s", "beta", "alpha", "push"))))


def _down(ax: Axes, rod: DrawnRod, unit: str, title: str, values: Any) -> None:
    """The scales of a track."""
    low, high = min(0.0, *(float(np.min(v)) for v in values)), max(0.0, *(float(np.max(v)) for v in values))
    spare = MARGIN * ((high - low) or 1.0)
    ax.set_xlim(low - spare, high + spare)  # a quantity that is 0 stands off the scale of the depth
    ax.set_ylim(float(rod["s"].max()), 0)
    ax.set_xlabel(f"[{labels.unit(unit)}]")
    ax.set_title(fonts.wrap(title, ax), loc="left")
    place = ax.get_subplotspec()
    if place is None or place.is_first_col():
        ax.set_ylabel(f"measured depth [{labels.unit(rod.case.units['length'])}]")
    else:
        ax.tick_params(labelleft=False)


def _curve(ax: Axes, rod: DrawnRod, values: Any, most: float = np.inf, **look: Any) -> list[str]:
    """Draw a quantity along the depth, red beyond `most`; returns what is to be said of it."""
    depth, said = rod["s"], list[str]()
    parts = list(waves.stretches(depth, values, fonts.inches(ax)[1] / float(depth[-1])))
    if any(part.band for part in parts):  # waves that are hardly wider than those of a band are no block of ink
        look["linewidth"] = CLOSE
    for part in parts:
        at, low, high = part.band or (depth[part.of], values[part.of], values[part.of])
        ax.plot(low, at, **look | ({"linewidth": waves.EDGE} if part.band else {}))
        if part.band:
            said = [waves.SAID]
            ax.plot(high, at, **look | {"linewidth": waves.EDGE})
            ax.fill_betweenx(at, low, high, color=look["color"], linewidth=0, alpha=waves.PALE)
        if (high > most).any():
            ax.fill_betweenx(at, most, high, where=high > most, color=FAILING, linewidth=0, zorder=3,
                             interpolate=True, label=ABOVE)  # fmt: skip
    return said


def _draw_track(rod: DrawnRod, case: "Case", name: str, unit: str, values: Any, ax: Axes) -> list[str]:
    """The push of the wall, the gap to it, or the dogleg."""
    colour = colours.PUSHED if name == PUSH else colours.DATA
    said = _curve(ax, rod, values, color=colour, linewidth=1.3, gid=WORDS[name])
    ax.axvline(0, color=colours.SOFT, linewidth=0.8, zorder=1)  # below the curve, which may be 0
    if name == PUSH and push_scale.pulls(rod["push"]).any():
        ax.fill_betweenx(rod["s"], 0, np.minimum(values, 0), color=colours.PULLED, linewidth=0, label="would lift off")
    # the push of a clamp would flatten all else
    _down(ax, rod, unit, WORDS[name], [_away(rod, case, values) if name == PUSH else values])
    return said


def _draw_force(rod: DrawnRod, case: "Case", unit: str, values: Any, ax: Axes) -> list[str]:
    """The axial force, the states of the pipe, and the limits at which a long one changes its state."""
    limits = [limit for limit in pipe_words.limits(case) if limit.name != pipe_words.LIKELY]
    most = -float(values.min())
    upper = next((limit.value for limit in limits if limit.value > most), most)
    said = _curve(ax, rod, values, color=colours.DATA, linewidth=1.3, gid=WORDS[FORCE])
    ax.axvline(0, color=colours.SOFT, linewidth=0.8, zorder=1)
    _down(ax, rod, unit, WORDS[FORCE], [values, np.array([-max(most, upper if upper <= NEXT * most else 0.0)])])
    _draw_states(ax, rod)
    _draw_limits(ax, limits, labels.unit(unit))
    return said


def _draw_limits(ax: Axes, limits: list[pipe_words.Limit], unit: str) -> None:
    """Bands of the compressions at which a long pipe changes its state."""
    end = -ax.get_xlim()[0]
    for k, (limit, (name, colour, alpha)) in enumerate(zip(limits, BANDS, strict=False)):
        far = min([other.value for other in limits[k + 1 : k + 2]] + [end])
        if limit.value < end:
            ax.axvspan(
                -far,
                -limit.value,
                color=colour,
                alpha=alpha,
                linewidth=0,
                zorder=0,
                label=f"{name} > {plain(limit.value)} {unit}",
            )


def _draw_states(ax: Axes, rod: DrawnRod) -> None:
    """A strip of the states beside the track, outside its axes: it has the depth, and no force."""
    where = ax.get_yaxis_transform()
    for part in _states(rod):
        ax.fill_betweenx(
            (part.begin, part.end),
            *STRIP,
            color=colours.STATES[part.word],
            linewidth=0,
            transform=where,
            clip_on=False,
            label=part.word,
        )
    ax.annotate(
        "state",
        (sum(STRIP) / 2, 0),
        (0, -4),
        xycoords="axes fraction",
        textcoords="offset points",
        ha="center",
        va="top",
        size=fonts.small(),
        color=colours.SOFT,
    )


def _draw_stress(rod: DrawnRod, unit: str, stresses: Any, most: float | None, ax: Axes) -> list[str]:
    """The axial stress, and that of the outermost fibre with the bending; what is above the yield stress is red."""
    axial, _, whole = stresses
    title, shown = "stress", [whole]
    if most is not None:
        share = 100 * float(whole.max()) / most
        words = f"{plain(share, 2 if share < 100 else 3)} % of yield"
        title = fonts.fit_label(lambda full: f"stress: {words}" if full else words, fonts.inches(ax)[0], 1)
        shown = [whole, np.array([most])]
        ax.axvline(
            most,
            color=colours.INK,
            linewidth=1,
            linestyle=(0, (4, 3)),
            label=f"yields at {plain(most)} {labels.unit(unit)}",
        )
    said = _curve(ax, rod, axial, color=colours.DATA, linewidth=1.3, linestyle=(0, (1, 1)), gid=AXIAL, label=AXIAL)
    said += _curve(ax, rod, whole, most or np.inf, color=colours.DATA, linewidth=1.3, gid=WORDS[STRESS],
                   label="axial and bending, its size")  # fmt: skip
    ax.axvline(0, color=colours.SOFT, linewidth=0.8, zorder=1)
    _down(ax, rod, unit, title, [axial, *shown])
    return said


def _largest_stresses(case: "Case", ends: Any, bending: Any) -> Any:
    """The largest stress of each pipe, (n,): at most that of its largest bend under its largest compression.

    case: what all have in common. ends: their axial forces at both ends, (2, n). bending: their largest stresses of
    bending, (n,).
    """
    area = np.pi * (case.rod.a**2 - (case.rod.inner_radius or 0.0) ** 2)
    return np.maximum(ends.max(axis=0) / area, np.maximum(-ends.min(axis=0), 0.0) / area + bending)


def _yield_words(bit: Any, excess: Any, broken: Any, force: str) -> str:
    """From which weight on bit a pipe yields, in words: between two solved ones that neighbour each other.

    bit, excess: the weight on bit, and by how much the stress is above yield, along the axis of the load, (n,) each;
    NaN where a pipe is not solved. broken: the places from which another shape begins.
    """
    known = np.flatnonzero(np.isfinite(bit) & np.isfinite(excess))
    rising = known[np.argsort(bit[known], kind="stable")]
    first = int(np.flatnonzero(excess[rising] > 0)[0])
    last = rising[first]
    if not first:
        return f"with each weight on bit that is solved, from {plain(float(bit[last]))} {force} on"
    before = rising[first - 1]
    ends = f"{plain(float(bit[before]))} and {plain(float(bit[last]))} {force}"
    low, high = sorted((before, last))
    if any(low < place <= high for place in broken) or high - low > 1:
        return f"from a weight on bit on between {ends}"
    share = excess[before] / (excess[before] - excess[last])
    at = float(bit[before] + share * (bit[last] - bit[before]))
    return f"from a weight on bit of about {plain(at, 3)} {force} on, interpolated between {ends}"


def _draw_slack_off(
    stored: StoredStudy, load: str, place: Mapping[str, int], yield_stress: float | None, ax: Axes
) -> list[str]:
    """Weight on bit against slack-off, along the axis of the load: a ring is the drawn pipe, red those that yield."""
    line = stored.select({name: i for name, i in place.items() if name != load})
    case = line.case
    order = np.argsort(line[load].values, kind="stable")
    names = ["FZ0", "arriving_max", *["bending_stress_max"] * (case.rod.E is not None)]
    FZ0, arriving, *bending = drawn_rods.numbers(line, *names)
    FZ = np.broadcast_to(line["FZ"].values, FZ0.shape)
    weight = np.asarray(case.rod.weight or 0.0) * case.rod.L * -np.cos(case.cylinder.inclination or 0.0)
    slack, bit = np.broadcast_to(weight - FZ0, FZ0.shape), -FZ
    broken = np.flatnonzero(np.diff(line["branch"].values[order])) + 1 if "branch" in line else ()
    trends.draw_line(ax, slack[order], bit[order], False, broken, color=colours.DATA, linewidth=1.3)
    solved = np.isfinite(slack[order]) & np.isfinite(bit[order])
    jumps = [k for k in map(int, broken) if solved[k - 1 : k + 1].all()]
    for k in jumps:
        ax.plot(slack[order][k - 1 : k + 1], bit[order][k - 1 : k + 1], color=colours.DATA, linewidth=0.8,
                linestyle=(0, (1, 2)), label=JUMP)  # fmt: skip
    k = place[load]
    ax.plot(slack[k], bit[k], "o", fillstyle="none", markersize=8, color=colours.INK, label="the drawn pipe",
            clip_on=False)  # fmt: skip
    known = np.isfinite(slack) & np.isfinite(bit)
    ends = np.array([min(0.0, bit[known].min()), bit[known].max()])
    apart = np.diff(np.sort(slack[known])).mean() / np.ptp([*slack[known], *ends]) if slack[known].size > 1 else 1.0
    if slack.size <= trends.MOST_DOTS and apart * fonts.inches(ax)[0] > DOT:
        ax.scatter(slack, bit, color=colours.DATA, s=15, zorder=4, edgecolors="white", linewidths=0.7)
    ax.plot(ends, ends, color=colours.SOFT, linewidth=0.8, linestyle=(0, (4, 3)), label="without friction")
    force = labels.unit(stored.units["force"])
    most = float(np.nanmin(arriving)) if np.isfinite(arriving).any() else np.inf
    said = [
        "Slack-off: the weight of the pipe along the hole less the force at the hook, s = 0; weight on bit: the push "
        "at s = L."
    ]
    if jumps:
        said.append("Where the curve jumps, the pipe leaves its shape for another one, as a sinusoid for a helix.")
    with_stress = ""
    if bending:
        stresses = _largest_stresses(case, np.stack([FZ0, FZ]), bending[0])
        shown = unit_habits.value_with_unit(names[-1], float(stresses[known][bit[known].argmax()]), stored.units)
        if bit[k] < bit[known].max():  # of the drawn pipe the stress itself is said
            with_stress = f"; with {plain(float(bit[known].max()))} {force} the stress is at most {shown}"
        if yield_stress is not None and (above := known & (stresses > yield_stress)).any():
            ax.scatter(slack[above], bit[above], color=FAILING, s=15, zorder=5, label=ABOVE)
            said.append(f"The pipe yields {_yield_words(bit[order], stresses[order] - yield_stress, broken, force)}.")
    if np.isfinite(most):
        arrives = pipe_words.most_that_arrives(stored.select(place).case, most, stored.units)
        said.append(f"However hard the pipe is pushed, {arrives}{with_stress}.")
        if most <= 2 * ends[1]:
            ax.axhline(
                most,
                color=colours.INK,
                linewidth=1,
                linestyle=(0, (1, 1.5)),
                label=f"locks up at {plain(most)} {force}",
            )
    if not known.all():
        said.append(f"{int((~known).sum())} of {known.size} weights on bit are not solved.")
    ax.set_xlabel(f"slack-off at the hook [{force}]")
    ax.set_ylabel(f"weight on bit [{force}]")
    ax.set_title("weight on bit against slack-off", loc="left")
    return said
