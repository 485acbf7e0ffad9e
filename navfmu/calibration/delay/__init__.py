"""How late the stamps of a GPS receiver are, by the inertial unit of the same recording."""
