"""Angles as people write them in a study: the solver reads them."""

from solver.problem.angles import FORMS, angle

__all__ = ["FORMS", "angle"]
