"""One equilibrium: found, verified, and told in SI units."""
