"""Comparisons of the methods: accuracy against cost, and robustness at extreme parameters."""
