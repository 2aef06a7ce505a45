"""Numerical tools: array types, Chebyshev series, bracketed roots."""
