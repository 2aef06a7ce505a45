"""Branches of equilibria between two ends: sweeps over an end angle, tracking, folds."""
