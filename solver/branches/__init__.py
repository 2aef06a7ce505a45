"""From one equilibrium to others: a path as a root, continuation, deflation, helices, curves of special points."""
