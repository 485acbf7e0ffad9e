"""Recorded sensors of small aircraft through FMUs, GPS taken away: flight, cuts, what they are compared with."""
