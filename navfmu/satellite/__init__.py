"""Files of satellite navigation: orbits and clocks (RINEX, YUMA, SEM) and what a receiver observed (RINEX)."""
