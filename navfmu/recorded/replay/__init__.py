"""Recorded sensors become FMUs: rows of a file are the samples that a player publishes."""
