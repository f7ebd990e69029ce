"""Where outline and object meet: geometry, gaps, and friction's law on them."""
