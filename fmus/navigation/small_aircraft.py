"""What ``navigator`` is told of an unmanned aircraft of some kg near the ground."""

from __future__ import annotations

from navfmu.export import ParameterSet

SMALL_AIRCRAFT = ParameterSet(
    "An unmanned aircraft of some kg at 15 to 25 m/s near the ground. Gusts: light turbulence of MIL-F-8785C at 75 m, "
    "1.13 m/s along the nose for 240 m. GPS: 2.5 m in half of the fixes (data sheet of u-blox 8), 2.1 m on each axis; "
    "velocity 0.3 m/s, what PX4 takes for its receivers, which lag in turns. Airspeed: zero and scale of a pressure "
    "sensor stay for a flight of an hour (own choice). Wind as everywhere.",
    {
        "fix_sigma": 2.1,
        "velocity_sigma": 0.3,
        "gust_sigma": 1.13,
        "gust_length": 240.0,
        "airspeed_time": 3600.0,
    },
)

SETS = {"small_aircraft": SMALL_AIRCRAFT}
