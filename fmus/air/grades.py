"""Air data systems by name: parameters of ``air_data`` for each, with its source.

The start values of ``air_data`` are the errors of ``fmus.grades.AIR_DATA``: thesis (3.30)-(3.34) and a transducer.
"""

from __future__ import annotations

from fmus.grades import AIR_DATA
from models.air import pneumatics
from navfmu.constants import FOOT
from navfmu.export import ParameterSet

THESIS = {**AIR_DATA, "pitot_coefficient_sigma": 0.0, "pressure_offset_sigma": 0.0, "temperature_error_sigma": 0.0}
TUBE = (5.0, 4.7e-3)
"""Length and bore, m: a quarter-inch tube of 0.8 mm wall, from the tail to the panel of a light aircraft."""
INSTRUMENT = 1e-4
"""Volume of one, m3. Three are at the static line, one at the pitot line."""

AIR: dict[str, ParameterSet] = {
    "thesis": ParameterSet(
        "Thesis (3.30)-(3.34), pp. 63-66, as printed: airspeed 2.6 m/s, altitude 23 m, both 400 s; nothing else is "
        "wrong.",
        THESIS,
    ),
    "light_aircraft": ParameterSet(
        "The thesis's errors with a transducer, lines of 5 m and 4.7 mm (time constants by the law of Hagen and "
        "Poiseuille), and half of the position error that 14 CFR 23.1325(e) (2011) allowed, 30 ft at 100 kn.",
        {
            **AIR_DATA,
            "static_coefficient": 0.0335,
            "static_lag_time": pneumatics.fill_time(*TUBE, 3.0 * INSTRUMENT),
            "total_lag_time": pneumatics.fill_time(*TUBE, INSTRUMENT),
        },
    ),
    "cp298": ParameterSet(
        "Altimeter of AGARD CP-298, paper 15, p. 15-11: 10 m over 100 km, noise of 2.7^2 + (0.0035 h)^2 m2. Airspeed "
        "as in the thesis.",
        {
            **THESIS,
            "altitude_error_sigma": 0.0,
            "altitude_field_sigma": 10.0,
            "altitude_field_distance": 100e3,
            "altitude_noise_sigma": 2.7,
            "altitude_noise_slope": 0.0035,
        },
    ),
    "transport": ParameterSet(
        "The largest altimetry error that 14 CFR 91, appendix G, section 2(e) allows between FL 290 and FL 410: 80 ft "
        "as the mean, here the position error at FL 370 and Mach 0.78, and 200 ft as the mean and three sigma. "
        "Airspeed as in the thesis, with a transducer. A probe of the total temperature that takes a second.",
        {
            **AIR_DATA,
            "altitude_error_sigma": (200.0 - 80.0) / 3.0 * FOOT,
            "static_coefficient": 0.0077,
            "recovery_factor": 1.0,
            "temperature_lag_time": 1.0,
        },
    ),
}
"""By name; a set leaves at its start value what it does not name."""
