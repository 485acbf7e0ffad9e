"""Tests of the pytest plugin: each runs pytest in a folder of its own, whose name has a space."""
