"""Numerical tools: array types, Chebyshev series, roots, small systems, pseudo-arclength steps."""
