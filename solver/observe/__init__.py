"""Observables of a solution, their quadrature and errors, and self-contact."""
