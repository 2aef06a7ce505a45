"""Observables: numbers of a whole rod, and how they are computed."""
