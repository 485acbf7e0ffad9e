"""Constant errors of an inertial unit from its stands: which of them are told, and how well."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import stats

from navfmu.calibration.allan.sensor import ACCELEROMETER, SENSORS
from navfmu.calibration.imu.fit import FREE, Fit, fit
from navfmu.calibration.imu.stands import ANGLES, TABLE_RATE, Stands
from navfmu.calibration.imu.terms import MISALIGNMENT, Term, chosen, readings, specific_force, split
from navfmu.errors import NavfmuError

TOLD = 1.0 / 3.0
"""An element is told if its sigma is less than this share of what it is in a unit that nobody has calibrated."""
LIKELY = 5.0
"""Times that size, from which on an error is one of the recording."""
CONFIDENCE = 0.95
_START = np.array([1e-4, 1e-2])
"""Sigma of a mean rate and specific force with which to begin."""


@dataclass(frozen=True)
class Element:
    """One number of a term, SI: its ``value``, one ``sigma``, the ends of its interval of CONFIDENCE, whether it is
    ``told``."""

    term: Term
    axis: str
    value: float
    sigma: float
    low: float
    high: float
    told: bool

    @property
    def name(self) -> str:
        """As gyro_scale_factor x."""
        return f"{self.term.name} {self.axis}"


@dataclass(frozen=True)
class Determination:
    """The errors of the unit on some stands, from a fit of ``terms``."""

    stands: Stands
    terms: tuple[Term, ...]
    fit: Fit

    @cached_property
    def elements(self) -> list[Element]:
        """All elements of all terms, in the order of the covariance."""
        sigmas, found = np.sqrt(np.diag(self.fit.covariance)), []
        for term in self.terms:
            left = min(self.fit.left[SENSORS.index(sensor)] for sensor in term.sensors)
            reach = float(stats.t.ppf(0.5 + CONFIDENCE / 2.0, max(left, FREE)))
            for axis in term.elements:
                value, sigma = float(self.fit.values[len(found)]), float(sigmas[len(found)])
                told = sigma < TOLD * term.size
                found.append(Element(term, axis, value, sigma, value - reach * sigma, value + reach * sigma, told))
        return found

    @cached_property
    def residuals(self) -> tuple[np.ndarray, np.ndarray]:
        """What the errors do not explain: of the rates (stands, 3), of the specific forces (stands, 3), or (stands, 1)
        of their sizes."""
        count = 3 * len(self.stands.rate)
        return self.fit.residuals[:count].reshape(-1, 3), self.fit.residuals[count:].reshape(len(self.stands.rate), -1)


def determine(stands: Stands, without: Iterable[str] = (), sigma: np.ndarray | None = None) -> Determination:
    """Find the errors of a unit, but those that are ``without`` by name.

    ``sigma`` (2,) is that of a mean rate, rad/s, and of a mean specific force, m/s2; without it the residuals tell it.
    Where no attitude was told, the specific force is what the readings make of it with the errors, its size is that of
    gravity, and the rate of the Earth, 15 deg/h, is among what the errors do not explain. How the unit is turned in its
    case is not told then, and the scale factors of the accelerometers hold half of its square.
    """
    told = stands.true_force is not None
    terms = tuple(term for term in chosen(without) if told or term is not MISALIGNMENT)
    sizes = np.concatenate([np.full(len(term.elements), term.size) for term in terms])
    count = len(stands.rate)

    def against_the_table(values):
        rate, force = readings(split(values, terms), stands.true_rate, stands.true_force)
        return np.concatenate([np.ravel(rate - stands.rate), np.ravel(force - stands.specific_force)])

    def against_gravity(values):
        errors = split(values, terms)
        force = specific_force(errors, stands.specific_force)
        rate, _ = readings(errors, np.zeros((count, 3)), force)
        return np.concatenate([np.ravel(rate - stands.rate), np.sqrt(np.sum(force**2, axis=1)) - stands.gravity])

    kinds = np.repeat([0, 1], [3 * count, (3 if told else 1) * count])
    found = fit(against_the_table if told else against_gravity, kinds, sizes, _START, sigma)
    if sigma is None and np.any(found.left < FREE):
        short = ACCELEROMETER.quantity if found.left[1] < FREE else SENSORS[0].quantity
        raise NavfmuError(
            f"{stands.source}: {count} {'stand leaves' if count == 1 else 'stands leave'} nothing to tell errors of "
            f"the {short} from chance; expected more stands, in other attitudes, or fewer errors, by --without"
        )
    determination = Determination(stands, terms, found)
    _check_likely(determination)
    return determination


def _check_likely(found: Determination) -> None:
    worst = max(found.elements, key=lambda element: abs(element.value) / element.term.size)
    unit, factor = worst.term.shown
    if abs(worst.value) > LIKELY * worst.term.size:
        raise NavfmuError(
            f"{found.stands.source}: {worst.name} would be {factor * worst.value:.3g} {unit}; expected "
            f"{factor * LIKELY * worst.term.size:.3g} at most: axes, signs or units of the file are others, or those "
            f"of {', '.join(ANGLES)} or {TABLE_RATE}"
        )


def lacking(found: Determination) -> list[str]:
    """A sentence for each term of which something is not told: what it is, and what would tell it."""
    said = []
    if found.stands.true_force is None:
        said.append(f"{MISALIGNMENT.name}: not told by these stands; needs {MISALIGNMENT.needs}")
    for term in found.terms:
        axes = [element.axis for element in found.elements if element.term is term and not element.told]
        if axes:
            which = "" if len(axes) == len(term.elements) else f" {', '.join(axes)}"
            said.append(f"{term.name}{which}: not told by these stands; needs {term.needs}")
    return said
