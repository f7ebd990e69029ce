"""Studies of the solver: what the published scheme gives, what a pose costs. Not needed to solve anything."""
