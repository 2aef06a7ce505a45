"""The problem: case, quantities, reduction to one equation for beta, limits of the numbers."""
