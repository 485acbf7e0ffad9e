"""Recorded observations of satellites as an FMU."""
