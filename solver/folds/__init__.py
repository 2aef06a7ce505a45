"""Fold and pitchfork curves over two parameters."""
