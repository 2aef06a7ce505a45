"""Equilibria with held ends: where a search begins, mirror images, ranges, the scan of a hinge's angle."""
