"""The master: runs a plan of connected FMUs, compiled or in Python (the reference that must agree to the bit)."""
