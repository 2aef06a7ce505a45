"""Equilibria of rods whose loads vary along them (weight, sliding friction): multiple shooting."""
