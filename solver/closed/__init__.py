"""Closed rods: their orbits, their stability, and where they intersect themselves."""
