"""Expressions over the signals of a system: what requirements ask and what triggers of faults wait for."""
