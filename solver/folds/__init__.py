"""Fold and pitchfork curves over two parameters, and the regions between them."""
