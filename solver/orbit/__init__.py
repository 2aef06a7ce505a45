"""The periodic orbit of beta: critical points, arcs, pieces, panels, action, condition number."""
