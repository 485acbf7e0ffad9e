"""Faults for other masters: FMUs that are inserted in the connections of a system, where the faults act."""
