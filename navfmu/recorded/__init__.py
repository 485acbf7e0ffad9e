"""Recorded flights become FMUs."""
