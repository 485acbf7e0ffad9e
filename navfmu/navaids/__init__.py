"""Stations of navaid files: read, seen from a place or along a track, and given to an FMU as parameters."""
