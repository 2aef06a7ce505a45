"""Curves and surfaces of a stored rod: centreline, tube mesh, refinement, self-contact test."""
