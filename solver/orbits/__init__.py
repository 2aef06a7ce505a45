"""Constant loads: the periodic orbits of beta, every path between two ends, closed rods, forces and arrays."""
