"""Observables of a solution, their integration along the rod and their errors, and self-contact."""
