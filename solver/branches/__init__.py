"""Branches of equilibria: continuation, steps along a curve, folds and pitchforks on it, deflation, helices."""
