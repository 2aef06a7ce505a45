"""Numerical tools: Chebyshev series, bracketed roots."""
