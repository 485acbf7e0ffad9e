"""The record becomes C, or NumPy."""
