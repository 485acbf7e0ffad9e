"""Constant errors of an inertial unit: their names as parameters of an FMU, and what each makes of the truth.

With s the rate or the specific force in b, C_m = I - [misalignment x] and N = [1 0 0; a_yx 1 0; a_zx a_zy 1],

    accelerometers   f_m = (1 + s_f) a + s_a |a| + k a^2 + b,                        a = N C_m f
    gyros            w_m = (1 + s_f) (w + G c) + s_a |w + G c| + n f_i f_s + b,      w = N C_m w_b,  c = N C_m f

These are the errors of AGARD CP-298 (1981), paper 10 (Joos and Krogmann), (4.1) and (5.1): mass unbalance m and
quadrature q are elements of G, anisoelasticity n goes with the product of the specific forces along the input axis i
and the spin axis s. The spin axis is z for the gyros x and y, as there, and x for the gyro z. There each gyro and
accelerometer has misalignments of its own; here the case is turned as a whole, and each triad leans.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from navfmu.calibration.allan.sensor import ACCELEROMETER, GYRO, HOUR, SENSORS, Sensor
from navfmu.constants import STANDARD_GRAVITY
from navfmu.errors import NavfmuError, nearest

_DEG = float(np.degrees(1.0))
_G = STANDARD_GRAVITY
UP, SLANT = "stands with each axis up, down and level", "stands with two axes at 45 degrees, in several attitudes"
TURNS = "turns to both sides about each axis at a known rate (table_rate)"


@dataclass(frozen=True, eq=False)  # they are keys
class Term:
    """An error of three elements, or nine. ``sensors`` are those that show it; ``size`` is one sigma of it in a unit
    that nobody has calibrated, SI, ``shown`` its unit in a table and how many of that are one in SI; ``needs`` is what
    tells it. ``modelled`` are those that an inertial unit of the project has.
    """

    name: str
    sensors: tuple[Sensor, ...]
    elements: tuple[str, ...]
    size: float
    shown: tuple[str, float]
    needs: str
    modelled: bool = True


_AXES = ("x", "y", "z")
_LEANING = ("yx", "zx", "zy")
MISALIGNMENT = Term(
    "misalignment", SENSORS, _AXES, 0.05, ("deg", _DEG), "the attitudes of a table (roll, pitch, heading)"
)
LEANING, SCALE, ASYMMETRY, SHIFT = (
    {
        sensor: Term(f"{sensor.prefix}_{name}", (sensor,), elements, sizes[sensor], shown[sensor], needs[sensor])
        for sensor in SENSORS
    }
    for name, elements, sizes, shown, needs in (
        (
            "nonorthogonality",
            _LEANING,
            {GYRO: 0.05, ACCELEROMETER: 0.05},
            {GYRO: ("deg", _DEG), ACCELEROMETER: ("deg", _DEG)},
            {GYRO: TURNS, ACCELEROMETER: SLANT},
        ),
        (
            "scale_factor",
            _AXES,
            {GYRO: 0.05, ACCELEROMETER: 0.05},
            {GYRO: ("ppm", 1e6), ACCELEROMETER: ("ppm", 1e6)},
            {GYRO: TURNS, ACCELEROMETER: UP},
        ),
        (
            "scale_factor_asymmetry",
            _AXES,
            {GYRO: 0.005, ACCELEROMETER: 0.005},
            {GYRO: ("ppm", 1e6), ACCELEROMETER: ("ppm", 1e6)},
            {GYRO: TURNS, ACCELEROMETER: SLANT},
        ),
        (
            "null_shift",
            _AXES,
            {GYRO: 20.0 / _DEG, ACCELEROMETER: 0.05 * _G},
            {GYRO: ("deg/h", HOUR * _DEG), ACCELEROMETER: ("mg", 1e3 / _G)},
            {GYRO: "rest", ACCELEROMETER: UP},
        ),
    )
)
SQUARE = Term("accelerometer_square", (ACCELEROMETER,), _AXES, 1e-3 / _G, ("ug/g2", 1e6 * _G), SLANT, modelled=False)
SENSITIVITY = Term(
    "gyro_g_sensitivity", (GYRO,), tuple(a + b for a in _AXES for b in _AXES), 0.1 / _DEG / _G,
    ("deg/h/g", HOUR * _DEG * _G), UP,
)  # fmt: skip
ANISOELASTICITY = Term(
    "gyro_anisoelasticity",
    (GYRO,),
    _AXES,
    0.01 / _DEG / _G**2,
    ("deg/h/g2", HOUR * _DEG * _G**2),
    SLANT,
    modelled=False,
)
TERMS = (
    MISALIGNMENT,
    *(kind[ACCELEROMETER] for kind in (LEANING, SCALE, ASYMMETRY, SHIFT)),
    SQUARE,
    *(kind[GYRO] for kind in (LEANING, SCALE, ASYMMETRY, SHIFT)),
    SENSITIVITY,
    ANISOELASTICITY,
)


def chosen(without: Iterable[str]) -> tuple[Term, ...]:
    """All terms but those of some names."""
    left_out, names = list(without), [term.name for term in TERMS]
    for name in left_out:
        if name not in names:
            raise NavfmuError(
                f"--without {name}: there is no such error; expected {', '.join(names)}{nearest(name, names)}"
            )
    return tuple(term for term in TERMS if term.name not in left_out)


def split(vector: np.ndarray, terms: Iterable[Term]) -> dict[Term, np.ndarray]:
    """The elements of each term in a vector of all; those of terms that are not among them are 0."""
    values, at = {term: np.zeros(len(term.elements)) for term in TERMS}, 0
    for term in terms:
        values[term] = vector[at : at + len(term.elements)]
        at += len(term.elements)
    return values


def readings(errors: Mapping[Term, np.ndarray], rate: np.ndarray, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What gyros and accelerometers show (stands, 3) of a rate and a specific force in b (stands, 3)."""
    felt, gyros = force @ _axes(errors, ACCELEROMETER).T, _axes(errors, GYRO).T
    turning = rate @ gyros + force @ gyros @ np.reshape(errors[SENSITIVITY], (3, 3)).T
    products = np.stack([force[:, 0] * force[:, 2], force[:, 1] * force[:, 2], force[:, 2] * force[:, 0]], axis=1)
    return (
        _scaled(errors, GYRO, turning) + errors[ANISOELASTICITY] * products,
        _scaled(errors, ACCELEROMETER, felt) + errors[SQUARE] * felt**2,
    )


def specific_force(errors: Mapping[Term, np.ndarray], shown: np.ndarray) -> np.ndarray:
    """The specific force in b (stands, 3) of which accelerometers with these errors show ``shown`` (stands, 3).

    What is shown less what would be, added eight times: errors of a tenth leave 1e-8.
    """
    force, still = shown, np.zeros(np.shape(shown))
    for _ in range(8):
        force = force + shown - readings(errors, still, force)[1]
    return force


def _axes(errors: Mapping[Term, np.ndarray], sensor: Sensor) -> np.ndarray:
    """N C_m of a triad."""
    (a, b, c), (x, y, z) = errors[LEANING[sensor]], errors[MISALIGNMENT]
    one, none = 1.0 + 0.0 * a, 0.0 * a
    leaning = np.stack([np.stack([one, none, none]), np.stack([a, one, none]), np.stack([b, c, one])])
    mounting = np.stack([np.stack([one, z, -y]), np.stack([-z, one, x]), np.stack([y, -x, one])])
    return leaning @ mounting


def _scaled(errors: Mapping[Term, np.ndarray], sensor: Sensor, true: np.ndarray) -> np.ndarray:
    return (1.0 + errors[SCALE[sensor]]) * true + errors[ASYMMETRY[sensor]] * np.abs(true) + errors[SHIFT[sensor]]
