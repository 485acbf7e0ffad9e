"""Constant errors of an inertial unit, from stands in several attitudes and turns at known rates."""
