"""Files of orbits and observations."""
