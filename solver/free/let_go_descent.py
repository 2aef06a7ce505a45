"""How a rod that is let go sinks to a minimum in a viscous medium, which drags on each length alike.

Steps are implicit: each ends at the minimum of  E + |x - x_before|^2 / (2 dt),  so the energy E never rises. The medium
does not resist the rotation of the sections about the rod.
"""

from dataclasses import replace

import numpy as np

from ..numerics.arrays import ALIKE, Array
from ..problem.case import Case
from ..problem.errors import InputError
from .discrete_rod import DiscreteRod
from .free_problem import BeginningCurve, Beside, problems_of
from .free_rods import FreeAnswer, distance
from .free_shape import FreeShape
from .minimum import minimise
from .program import EACH_STEP, Effort

MOST_EDGES = 200  # of the rod while it moves: finer ones look alike. x10: ten times the time
SURVEY = 24  # steps to the goal, by which the whole way is measured. x10: 3.3 times the time, and the same way
# steps of a motion, those of Uno included, beside two for each of its shapes: usual are 60 to 200. x10: ten times the
# time before a rod is refused that does not come to rest
MOST_STEPS = 400
PACE = 1.6  # how far a step may go of what it should. x10: a few steps jump over what the eye should follow
# factors of the time of a step to the next one. x10: steps are undone; none is made shorter, and rods are refused
FASTER, SLOWER = 4.0, 0.2
FIRST = 1e-6  # the time of the first step that is tried. x10: as good, but for digits
# of a step: a rod that moves less rests; places that are so near are the same. x10: it rests before it does
AT_REST, THERE = 0.02, 0.5
ELSEWHERE = "the motion of a rod that is let go, which ends elsewhere than let_go"


class Sinking:
    """A rod on its way down from a curve, as a discrete rod like that of its goal."""

    def __init__(self, beside: Beside, curve: BeginningCurve, goal: DiscreteRod, count: int = 0) -> None:
        self.most = MOST_STEPS + 2 * count
        self.effort = Effort(self.most * (goal.edges + EACH_STEP))
        self.rod = replace(beside.rod_on(curve, 1.0, goal.edges), lead=goal.lead, chords=goal.chords)
        self.sizes = beside.sizes(curve)
        y = self.rod.with_known(curve.on(self.rod))
        self.begun = FreeShape(self.rod, y, np.zeros(self.rod.bounds[0].size))

    def step(self, shape: FreeShape, time: float) -> FreeShape | None:
        """The shape after a time; None where none is found, or the energy rises.

        Raises `InputError` where no effort is left.
        """
        self.effort.left -= self.rod.edges + EACH_STEP
        if self.effort.left < 0:
            raise InputError(f"let go, this rod does not come to rest within {self.most} steps")
        dragged = replace(self.rod, places=shape.x[1:], drag=1 / time)
        ahead = minimise(dragged, shape.y, self.sizes, shape.multipliers, self.effort)
        if ahead is not None and self.rod.energy(ahead.y) > self.rod.energy(shape.y) and shape is not self.begun:
            return None
        return ahead and replace(ahead, rod=self.rod)

    def survey(self, goal: FreeShape) -> tuple[Array, Array, FreeShape]:
        """Times, (k,), and the ways gone until then and to the rest, (k + 1,), in even shares of the way to a goal;
        and the shape at rest, which is the goal where it is near."""
        aim, time, shape = distance(self.begun, goal) / SURVEY, FIRST, self.begun
        times, ways = [0.0], [0.0]
        while True:
            ahead = self.step(shape, time)
            gone = np.inf if ahead is None else distance(shape, ahead)
            if ahead is not None and gone < PACE * aim:
                times.append(times[-1] + time)
                ways.append(ways[-1] + gone)
                shape = ahead
                rest = goal if gone > AT_REST * aim else self.step(shape, np.inf)
                if rest is not None and distance(shape, rest) < THERE * aim:
                    rest = goal if distance(rest, goal) < THERE * aim else rest
                    return np.array(times), np.append(ways, ways[-1] + distance(shape, rest)), rest
            time *= np.clip(aim / max(gone, aim / FASTER), SLOWER, FASTER)

    def after(self, shape: FreeShape, time: float) -> FreeShape:
        """The shape after a time, in one step, or in halves of it where that finds none."""
        left, step = time, time
        while left > 0:
            if ahead := self.step(shape, step):
                shape, left = ahead, left - step
            else:
                step /= 2
        return shape


def descent_of(case: Case, curve: BeginningCurve, answer: FreeAnswer, count: int) -> tuple[list[FreeAnswer], Array]:
    """So many shapes of the rod of one case that sinks from a curve, each about as far from the one before, the last at
    rest; and their energies in units of A and rho, before them that of the beginning, on one mesh.

    Raises `InputError` where it does not move, or not come to rest.
    """
    goal = next((shape for shape in answer.shapes[::-1] if shape.rod.edges <= MOST_EDGES), answer.shapes[0])
    sinking = Sinking(problems_of(case)[0], curve, goal.rod, count)
    if distance(sinking.begun, goal) < ALIKE:
        raise InputError("let go, this rod stays as it is: there is no motion to show")
    times, ways, rest = sinking.survey(goal)
    ends = np.linspace(0, ways[-1], count + 1)[1:-1]
    at = np.exp(np.interp(np.log(ends), np.log(ways[1:-1]), np.log(times[1:])))
    shapes = [sinking.begun]
    for time in np.diff(at, prepend=0.0):
        shapes.append(sinking.after(shapes[-1], float(time)))
    answers = [FreeAnswer((shape,), np.nan, begun="the motion of a rod that is let go") for shape in shapes[1:]]
    answers.append(answer if rest is goal else FreeAnswer((rest,), np.nan, begun=ELSEWHERE))
    return answers, np.array([shape.rod.energy(shape.y) for shape in [*shapes, rest]])
