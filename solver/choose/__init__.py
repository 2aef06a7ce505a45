"""Which equilibrium a rule or a seed means, as a trajectory."""
