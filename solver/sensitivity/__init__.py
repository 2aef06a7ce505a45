"""Derivatives of a solution and of its observables with respect to the fields of its case."""
