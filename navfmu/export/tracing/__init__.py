"""A component is run once with symbols, and what it does is recorded."""
