"""Ends that are held in place (search, mirror images, ranges), and which equilibrium a rule or a seed means."""
