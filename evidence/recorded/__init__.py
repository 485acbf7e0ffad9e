"""Recorded flights as the truth: their stations, how they are flown, and how the navigator did on them."""
