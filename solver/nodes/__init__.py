"""Equilibria as states at nodes: loads that vary along the rod, friction and hinges, by multiple shooting."""
