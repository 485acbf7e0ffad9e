"""Which calibration a recording allows: the one with the most unknowns whose errors are small where it was turned."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from navfmu.calibration.magnetometer.batch import batch
from navfmu.calibration.magnetometer.coverage import strip
from navfmu.calibration.magnetometer.locus import AXES, FAMILIES, HARD_IRON, SPHERE, Family, Locus, fit, member
from navfmu.calibration.magnetometer.two_step import two_step
from navfmu.errors import NavfmuError, nearest

LIMIT = 0.02
"""Standard deviation of a corrected field over its strength, the largest along any axis, that a calibration may leave
where the triad was turned: 10 mG of 500. The thesis's triad was left with 7 mG and 4 mG about them (Fig 3.27)."""
TILTED = 0.05
"""Standard deviation of the field along z, over its strength, from which a turn is not level: 3 degrees."""
SHOWN = 400
"""Samples at which errors are looked at, about."""


@dataclass(frozen=True)
class Method:
    """``fit(measured, strength)`` gives a locus or None; ``level`` ones take x and y and the horizontal field."""

    text: str
    family: Family
    fit: Callable[[np.ndarray, float], Locus | None]
    level: bool = False


METHODS = {
    **{family.name: Method(family.text, family, partial(fit, family)) for family in FAMILIES},
    "two-step": Method("thesis (3.69)-(3.80), a gain for each axis", AXES, two_step),
    "batch": Method("thesis (3.66)-(3.68), a gain for each axis", AXES, batch),
    "ellipse": Method("a level turn, hard iron and a gain for x and y, CMFD-2 (3.60)", AXES, partial(fit, AXES), True),
    "circle": Method("a level turn, hard iron, CMFD-2 (3.57)", SPHERE, partial(fit, SPHERE), True),
}
AUTOMATIC = "automatic"
DOWN = ("ellipsoid", "axes", "sphere", "hard-iron", "ellipse", "circle")
"""What is tried one after the other."""


@dataclass(frozen=True)
class Chosen:
    """``locus`` by ``method``; ``error`` is its largest standard deviation where the triad was turned, over the field
    strength; ``angle`` the strip of the sphere, rad, or None in the plane; ``refused`` says why not what was asked."""

    method: str
    locus: Locus
    error: float
    angle: float | None
    refused: tuple[str, ...]


def choose(measured: np.ndarray, strength: float | None, horizontal: float | None, method: str, source: str) -> Chosen:
    """The method that is asked for, or the first of ``DOWN`` after it that these fields (samples, 3), T, allow."""
    if method != AUTOMATIC and method not in METHODS:
        known = [AUTOMATIC, *METHODS, "swinging"]
        raise NavfmuError(f"--method {method}: expected {', '.join(known)}{nearest(method, known)}")
    tried = DOWN if method == AUTOMATIC else (method, *DOWN[DOWN.index(method) + 1 if method in DOWN else 2 :])
    refused: list[str] = []
    for name in tried:
        found = _judged(name, measured, strength, horizontal)
        if isinstance(found, Chosen):
            return Chosen(found.method, found.locus, found.error, found.angle, tuple(refused))
        refused.append(f"{name}: {found}")
    raise NavfmuError(f"{source}: no calibration is to be had from these fields: {'; '.join(refused)}")


def _judged(name: str, measured: np.ndarray, strength: float | None, horizontal: float | None) -> Chosen | str:
    method = METHODS[name]
    if method.level:
        tilt = float(np.std(measured[:, 2])) / (strength or float(np.mean(np.linalg.norm(measured, axis=1))))
        if tilt > TILTED:
            return (
                f"the triad was not level, z scatters by {100.0 * tilt:.2g} % of the field; expected {100 * TILTED:g}"
            )
        measured, strength = measured[:, :2], horizontal
    if strength is None and name == HARD_IRON.name:
        return "it needs the strength of the field; expected --field or --place"
    field = strength or _radius(measured)
    locus = method.fit(measured, field)
    found = locus or _smaller(method.family, measured, field)
    if found is None:
        return "the fields lie next to no surface"
    if strength is None:
        found = found.of_mean_gain()
    directions = found.corrected(measured)
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    error = float(np.max(found.errors(directions[:: 1 + len(directions) // SHOWN]))) / found.field
    angle = None if method.level else strip(directions)
    if locus is None or not error <= LIMIT:
        return f"{'' if locus else 'the iteration diverged; '}{_why(error, angle)}"
    return Chosen(name, found, error, angle, ())


def _smaller(family: Family, measured: np.ndarray, field: float) -> Locus | None:
    """What is nearest of a smaller family, as one of this: to say what errors it had where it is not to be found."""
    for other in (SPHERE, HARD_IRON):
        if (found := fit(other, measured, field)) is not None:
            return member(family, found, measured)
    return None


def _why(error: float, angle: float | None) -> str:
    """Errors go with the angle's square: what tells gain from centre along an axis is how a strip bends across."""
    found = f"errors of {_percent(error)} of the field, expected {100.0 * LIMIT:g} % at most"
    if angle is None:
        return found
    needed = angle * np.sqrt(error / LIMIT)
    told = f"about {np.degrees(needed):.0f} are needed" if needed < np.pi else "the whole sphere is needed, and longer"
    return f"{found}; the fields span a strip of {np.degrees(angle):.0f} degrees, and with their scatter {told}"


def _percent(share: float) -> str:
    return f"{100.0 * share:.2g} %" if share < 1.0 else "more than all"


def _radius(measured: np.ndarray) -> float:
    """Radius of the sphere by linear least squares, T."""
    found = fit(SPHERE, measured, float(np.sqrt(np.mean(np.sum((measured - measured.mean(axis=0)) ** 2, axis=1)))))
    if found is None:
        return float(np.mean(np.linalg.norm(measured, axis=1)))
    return found.field / found.matrix[0, 0]
