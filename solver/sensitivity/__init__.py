"""Derivatives of a solution and of its observables with respect to the fields of its case."""

from .solution_derivatives import Sensitivity, sensitivity

__all__ = ["Sensitivity", "sensitivity"]
