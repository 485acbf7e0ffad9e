"""Swinging: calibration in the heading domain (CHD), thesis (3.51)-(3.55).

Level, at known headings psi, the needle psi^ = atan2(-B_y, B_x) errs by

    psi^ - psi = A + B sin psi + C cos psi + D sin 2 psi + E cos 2 psi,                              (3.52)

    B = -dB_x / H,  C = -dB_y / H,  A = (a_xy - a_yx) / 2,  D = (a_yy - a_xx) / 2,  E = -(a_xy + a_yx) / 2.

That is to first order. To second order hard iron adds (B^2 - C^2) / 2 to D and B C to E, a degree where B and C are 7;
it is taken out of soft iron.

(3.51) lacks the sign between its last two terms and has other indices in A, D and E; these follow from (3.48)-(3.50). A
mounting of the triad turned by an angle is in A, as (3.55) says. The mean of the gains is not told by headings.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from navfmu.calibration.magnetometer.locus import as_one
from navfmu.errors import NavfmuError

LIMIT = np.radians(2.5)
"""Standard deviation of the corrected heading that a swing may leave at any heading."""
ROUNDS = 10
"""In which headings are corrected: a thousandth of a degree where hard iron is half of the horizontal field."""
LETTERS = "ABCDE"


@dataclass(frozen=True)
class Swing:
    """``coefficients`` (5,) A to E, rad; ``covariance`` (5, 5); ``left`` (samples,), errors without them, rad."""

    coefficients: np.ndarray
    covariance: np.ndarray
    left: np.ndarray

    def corrected(self, needle: np.ndarray) -> np.ndarray:
        """Headings, rad, of those of the needle: (3.52) solved for psi."""
        heading = needle
        for _ in range(ROUNDS):
            heading = needle - design(heading) @ self.coefficients
        return wrap(heading)

    def hard_iron(self, horizontal: float) -> np.ndarray:
        """dB_x and dB_y, T, in a horizontal field, T."""
        return -horizontal * self.coefficients[1:3]

    @property
    def soft_iron(self) -> np.ndarray:
        """The matrix (2, 2) of a, without the mean of its diagonal."""
        a, b, c, d, e = self.coefficients
        d, e = d - 0.5 * (b**2 - c**2), e - b * c
        return np.array([[-d, a - e], [-a - e, d]])


def needle(measured: np.ndarray) -> np.ndarray:
    """Heading, rad, of level fields (samples, 2 or 3), (2.3)."""
    return np.arctan2(-measured[:, 1], measured[:, 0])


def design(heading: np.ndarray) -> np.ndarray:
    """Rows (samples, 5) of (3.53)."""
    sine, cosine = np.sin(heading), np.cos(heading)
    return np.stack([np.ones_like(sine), sine, cosine, np.sin(2.0 * heading), np.cos(2.0 * heading)], axis=1)


def swing(measured: np.ndarray, heading: np.ndarray, source: str) -> Swing:
    """The coefficients from fields (samples, 3), T, at known headings, rad."""
    rows, error = design(heading), wrap(needle(measured) - heading)
    if np.linalg.matrix_rank(rows) < rows.shape[1]:
        raise NavfmuError(
            f"{source}: these {len(np.unique(heading))} headings do not tell five coefficients; expected five and "
            "more, around the compass rose"
        )
    coefficients = np.linalg.lstsq(rows, error, rcond=None)[0]
    left = error - rows @ coefficients
    together = max(as_one(left), as_one(left[np.argsort(np.mod(heading, 2.0 * np.pi))]))  # noise, or another series
    spread = together * float(left @ left) / max(1, len(left) - 5) * np.linalg.inv(rows.T @ rows)
    rose = np.radians(np.arange(0.0, 360.0, 5.0))
    around = design(rose)
    worst = float(np.sqrt(np.max(np.sum(around @ spread * around, axis=1))))
    if not worst <= LIMIT:
        raise NavfmuError(
            f"{source}: headings would be left with errors of {np.degrees(worst):.2g} deg where the triad was not "
            f"turned to; expected {np.degrees(LIMIT):g}, and headings all around the compass rose, clockwise, in rad "
            "or the unit that is named, as in --unit heading=deg"
        )
    third = np.linalg.lstsq(rows, third_order(coefficients, heading), rcond=None)[0]
    off = float(np.max(np.abs(third_order(coefficients, rose) - around @ third)))
    if not off <= LIMIT:
        raise NavfmuError(
            f"{source}: hard iron of {100.0 * np.hypot(*coefficients[1:3]):.0f} % of the horizontal field makes errors "
            f"of more than five coefficients, {np.degrees(off):.2g} deg at some headings; expected "
            f"{np.degrees(LIMIT):g} at most, and headings all around the compass rose, or another method"
        )
    return Swing(coefficients, spread, left)


def third_order(coefficients: np.ndarray, heading: np.ndarray) -> np.ndarray:
    """What hard iron adds to errors of ``heading``, rad, and (3.52) leaves out: Im(z^3 exp(-3 i psi)) / 3, of the
    logarithm of 1 + z exp(-i psi) with z = -B + i C."""
    z = -coefficients[1] + 1j * coefficients[2]
    return np.imag(z**3 * np.exp(-3j * heading)) / 3.0


def wrap(angle: np.ndarray) -> np.ndarray:
    """Angles in [-pi, pi), rad."""
    return np.mod(angle + np.pi, 2.0 * np.pi) - np.pi
