"""Which calibration a recording allows: the one with the most unknowns whose errors are small where it was turned."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from navfmu.calibration.magnetometer.batch import batch
from navfmu.calibration.magnetometer.coverage import strip
from navfmu.calibration.magnetometer.locus import (
    AXES,
    ELLIPSOID,
    FAMILIES,
    HARD_IRON,
    SPHERE,
    Family,
    Locus,
    fit,
    member,
    with_untold,
)
from navfmu.calibration.magnetometer.recording import EARTH
from navfmu.calibration.magnetometer.twin import as_good
from navfmu.calibration.magnetometer.two_step import two_step
from navfmu.calibration.magnetometer.wild import tame
from navfmu.errors import NavfmuError, nearest

LIMIT = 0.02
"""Standard deviation of a corrected field over its strength, the largest along any axis, that a calibration may leave
where the triad was turned: 10 mG of 500. The thesis's triad was left with 7 mG and 4 mG about them (Fig 3.27)."""
TILTED = 0.05
"""Standard deviation of the field along z, over its strength, from which a turn is not level: 3 degrees."""
LARGEST = 10.0
"""Gains, and hard iron over Earth's field, at most: 4 and 7.5 are in the thesis (Table 3.3)."""
LEFT = 0.1
"""Distance of the samples from their surface, rms over its size, at most: in flights it is up to 7 %."""
SHOWN = 400
"""Samples at which errors are looked at, about."""


@dataclass(frozen=True)
class Method:
    """``fit(measured, strength)`` gives a locus or None; ``level`` ones take x and y and the horizontal field.
    ``failed`` is what None means."""

    text: str
    family: Family
    fit: Callable[[np.ndarray, float], Locus | None]
    level: bool = False
    failed: str = "the iteration diverged"


METHODS = {
    **{family.name: Method(family.text, family, partial(fit, family)) for family in FAMILIES},
    "two-step": Method("thesis (3.69)-(3.80), a gain for each axis", AXES, two_step, failed="it finds no ellipsoid"),
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
    strength, and ``untold`` what gains and soft iron of a percent, which it leaves out, add; ``angle`` the strip of the
    sphere, rad, or None in the plane; ``refused`` says why not what was asked."""

    method: str
    locus: Locus
    error: float
    untold: float
    angle: float | None
    refused: tuple[str, ...]
    wild: int = 0
    """Samples that are left out."""


def choose(measured: np.ndarray, strength: float | None, horizontal: float | None, method: str, source: str) -> Chosen:
    """The method that is asked for, or the first of ``DOWN`` after it that these fields (samples, 3), T, allow."""
    if method != AUTOMATIC and method not in METHODS:
        known = [AUTOMATIC, *METHODS, "swinging"]
        raise NavfmuError(f"--method {method}: expected {', '.join(known)}{nearest(method, known)}")
    tried = DOWN if method == AUTOMATIC else (method, *DOWN[DOWN.index(method) + 1 if method in DOWN else 2 :])
    refused: list[str] = []
    near = tame(measured, strength or _radius(measured))
    for name in tried:
        found = _judged(name, measured[near], strength, horizontal)
        if isinstance(found, Chosen):
            return replace(found, refused=tuple(refused), wild=int(np.sum(~near)))
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
    simple = _simple(method.family, measured, field) or locus
    if simple is None:
        return "the fields lie next to no surface"
    error, angle = _error(simple, measured), None if method.level else strip(_directions(simple, measured))
    if locus is None:
        return method.failed if error <= LIMIT else f"{method.failed}; {_why(error, angle)}"
    if (found := _error(locus, measured)) <= LIMIT:
        if not method.level and (two := as_good(locus, measured)) is not None and two[1] > 2.0 * LIMIT:
            return _of_two(locus, *two)
        if (other := _shape(locus, measured)) > LIMIT:
            return f"gains or soft iron that it leaves out leave {_percent(other)} of the field, rms"
        locus = locus if strength else locus.of_mean_gain()
        untold = _error(with_untold(locus, measured), measured)
        return _wild(locus) or Chosen(name, locus, found, untold, angle, ())
    return _why(error if error > LIMIT else found, angle)


def _simple(family: Family, measured: np.ndarray, field: float) -> Locus | None:
    """The nearest sphere as a surface of a family: it has what errors of the family can be had from these turns, and
    the angle that they span, also where the nearest of the family is none."""
    for other in (HARD_IRON,) if family is HARD_IRON else (SPHERE, HARD_IRON):
        if (found := fit(other, measured, field)) is not None:
            return member(family, found, measured)
    return None


def _directions(locus: Locus, measured: np.ndarray) -> np.ndarray:
    corrected = locus.corrected(measured)
    return corrected / np.linalg.norm(corrected, axis=1)[:, None]


def _error(locus: Locus, measured: np.ndarray) -> float:
    """Largest standard deviation of a corrected field where the triad was turned, over its strength."""
    directions = _directions(locus, measured[:: 1 + len(measured) // SHOWN])
    return float(np.max(locus.errors(directions))) / locus.field


def _of_two(locus: Locus, other: Locus, apart: float) -> str:
    centres = " and ".join("(" + ", ".join(f"{1e6 * x:.3g}" for x in one.centre) + ")" for one in (locus, other))
    return (
        f"the fields lie near a plane, and as near one surface as another, by which corrected fields are "
        f"{_percent(apart)} apart: their centres are {centres} uT; expected turns that leave the plane"
    )


def _shape(locus: Locus, measured: np.ndarray) -> float:
    """What is left by a surface and not by the nearest ellipsoid, rms over the field strength."""
    nearest_of_all = fit(ELLIPSOID, measured, locus.field)
    if nearest_of_all is None:
        return 0.0
    return float(np.sqrt(max(locus.sigma**2 - nearest_of_all.sigma**2, 0.0))) / locus.field


def _why(error: float, angle: float | None) -> str:
    """Errors go with the angle's square: what tells gain from centre along an axis is how a strip bends across."""
    found = f"errors of {_percent(error)} of the field, expected {100.0 * LIMIT:g} % at most"
    if angle is None:
        return found
    needed = angle * np.sqrt(error / LIMIT)
    told = f"about {np.degrees(needed):.0f} are needed" if needed < np.pi else "the whole sphere is needed, and longer"
    return f"{found}; the fields span a strip of {np.degrees(angle):.0f} degrees, and with their scatter {told}"


def _wild(locus: Locus) -> str | None:
    """A sentence on what no triad has: fields in a plane lie in the flank of a huge ellipsoid as well as in a disc."""
    gains = 1.0 / np.linalg.eigvalsh(locus.matrix)
    iron, most = float(np.linalg.norm(locus.matrix @ locus.centre)), LARGEST * EARTH
    if not (1.0 / LARGEST <= gains.min() and gains.max() <= LARGEST):
        return f"gains would be {gains.min():.3g} to {gains.max():.3g}; expected {1.0 / LARGEST:g} to {LARGEST:g}"
    left = locus.sigma / (locus.field * float(gains.max()))
    if not left <= LEFT:
        return f"{_percent(left)} of the field are left, rms; expected {100.0 * LEFT:g} % at most"
    for what, size in (("Earth's field", locus.field), ("the hard iron", iron)):
        if not size <= most:
            return f"{what} would be {1e6 * size:.3g} uT; expected {1e6 * most:.3g} at most"
    return None


def _percent(share: float) -> str:
    return f"{100.0 * share:.3g} %" if share < 1.0 else "more than all"


def _radius(measured: np.ndarray) -> float:
    """Radius of the sphere by linear least squares, T."""
    found = fit(SPHERE, measured, float(np.sqrt(np.mean(np.sum((measured - measured.mean(axis=0)) ** 2, axis=1)))))
    if found is None:
        return float(np.mean(np.linalg.norm(measured, axis=1)))
    return found.field / found.matrix[0, 0]
