"""Numbers that are what they are by definition: units in SI, light, L1 of GPS; and the earth that radio rays see."""

FOOT = 0.3048
"""m."""
NAUTICAL_MILE = 1852.0
"""m."""
KNOT = NAUTICAL_MILE / 3600.0
"""m/s."""
STANDARD_GRAVITY = 9.80665
"""The unit g, m/s2."""
SPEED_OF_LIGHT = 299792458.0
"""m/s; GPS counts with the same value (IS-GPS-200, 20.3.4.3)."""
L1 = 1575.42e6
"""Carrier of GPS, Hz (IS-GPS-200, 3.3.1.1)."""
WAVELENGTH = SPEED_OF_LIGHT / L1
"""Of L1, m."""
EARTH_RADIUS = 6371.0e3
"""Of a sphere, where that is enough, m."""
RADIO_EARTH_RADIUS = 4.0 / 3.0 * EARTH_RADIUS
"""Radius over which radio rays run straight in a standard atmosphere, m."""
