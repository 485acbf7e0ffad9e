"""Analyses of a navigator in its system: what it claims, how wrong it is, and what makes it so."""
