"""What cannot be so: units, axes and signs that were told wrongly make samples that no sensor of an aircraft gives.

Each check takes values in the player's units and axes and yields sentences that begin with the quantity. What they
compare with is wide enough for raw sensors with their biases, and narrower than the nearest mistake: field strengths
are 25 to 65 uT on Earth, twice that with hard iron, and 1e-6, 1e-7 or 1e-4 of a number that was taken for tesla.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from navfmu.constants import STANDARD_GRAVITY
from navfmu.recorded.replay.samples import Samples, seconds
from navfmu.recorded.replay.units import UNITS, alike

FAST, SLOW, SLOWEST = 1e-5, 1.0, 30.0
"""s: the shortest usual time between samples, and the longest of inertial and magnetic sensors, and of others."""
SLOW_ONES = {"rate", "specific_force", "angle", "velocity", "field_b"}
REST = (8.5, 11.2)
"""m/s2: specific force at rest or in steady flight with biases of up to 0.13 g."""
LEVEL = np.radians(50.0)
"""From the downward axis to the mean support: an aircraft on its wheels or in flight is more level than that."""
FIELD = (15e-6, 220e-6)
FASTEST = 30.0
"""rad/s: what 99 of 100 samples are below; gyros measure up to 35."""
TURNED = 1.0
"""s over which the turn of the specific force is compared with that of the gyros."""
DEGREE = np.radians(1.0)
RATES = (("deg/s", DEGREE, 0.3), ("rad/s", 1.0 / DEGREE, 0.1))
"""Units that may be meant, by how much rates are too large then, and the least angle, rad, by which both differ: by 0.1
to 0.2 they do in flights, whose accelerations no gyro sees."""
EARTH = 6.371e6
"""Radius, m."""
STRETCH = 5.0
"""s over which what the velocity carries is compared with the change of position."""
OUTSIDE = {  # whose medians lie in these bounds, in the player's units
    "static_pressure": (2e4, 1.1e5),
    "temperature": (180.0, 325.0),
    "impact_pressure": (-500.0, 6e4),
    "calibrated_airspeed": (-10.0, 350.0),
    "true_airspeed": (-10.0, 350.0),
    "pressure_altitude": (-1000.0, 20e3),
    "altitude": (-1000.0, 30e3),
    "mach": (-0.1, 3.0),
}


LIMITS = {
    "rate": (-100.0, 100.0),
    "specific_force": (-1000.0, 1000.0),
    "field_b": (-1e-3, 1e-3),
    "velocity_n": (-2000.0, 2000.0),
    "altitude": (-2000.0, 100e3),
    "static_pressure": (1.0, 1.2e5),
    "temperature": (100.0, 400.0),
    "impact_pressure": (-2e4, 2e5),
    "calibrated_airspeed": (-100.0, 1000.0),
    "true_airspeed": (-100.0, 1000.0),
    "pressure_altitude": (-2000.0, 100e3),
    "mach": (-0.5, 5.0),
}
"""What no single number of a sensor is beyond, in the player's units: others stand for nothing, or are glitches."""
LEAP = (600.0, 10.0)
"""s, and times all the rest: an interval that is longer is no gap, but a clock that was set."""
OLDEST = 60.0
"""s from the time that a sample holds for to when it comes."""


def doubts(samples: Samples) -> Iterator[str]:
    """Yield a sentence for each thing that cannot be so."""
    yield from _times(samples)
    good = samples.only(samples.valid)
    values = {n: v[good.known[n]] if n in good.known else v for n, v in good.values.items() if good.sources[n].columns}
    values = {name: value for name, value in values.items() if len(value)}
    if "specific_force" in values:
        yield from _specific_force(good.time, values["specific_force"])
    if {"velocity", "interval"} <= set(values):
        yield from _specific_force(good.time, values["velocity"] / values["interval"][:, None], "velocity by interval")
    if "rate" in values:
        yield from _rate(good.time, values["rate"], values.get("specific_force"))
    if "field_b" in values:
        yield from _within("field_b", np.linalg.norm(values["field_b"], axis=1), "T", FIELD, "the field of the Earth")
    for name, bounds in OUTSIDE.items():
        if name in values:
            unit = next(q.unit for q in samples.wanted.quantities if q.name == name)
            yield from _within(name, values[name], unit, bounds, "what aircraft meet")
    yield from _angles(values)
    yield from _motion(good.time, values)
    yield from _air(values, good.known)
    yield from _beyond(samples)


def _times(samples: Samples) -> Iterator[str]:
    """Find times that do not tell samples apart, or are in another unit."""
    interval = np.diff(samples.time)
    if not len(interval):
        return
    if (same := int(np.count_nonzero(interval == 0.0))) > len(interval) // 2:
        yield (
            f"time of {same} of {len(samples)} samples is that of the next one, so they are lost; another column may "
            "tell them apart: --column time=..."
        )
        return
    at, longest = int(np.argmax(interval)), float(np.max(interval))
    if longest > max(LEAP[0], LEAP[1] * (rest := float(np.sum(np.delete(interval, at))))):
        yield (
            f"time leaps by {seconds(longest)} s after t = {seconds(samples.time[at])} s, and all the others take "
            f"{seconds(rest)} s: a clock was set"
        )
        return
    yield from _validity(samples)
    usual, slowest = float(np.median(interval[interval > 0.0])), SLOW if SLOW_ONES & set(samples.values) else SLOWEST
    if not FAST <= usual <= slowest:
        fit = [n for n in alike("s") if n != "s" and 2e-3 <= usual * UNITS[n].factor <= slowest]
        hint = f". Are the times in {' or '.join(fit)}? --unit time={fit[0]} says so" if fit else ""
        yield f"time between samples is {usual:.4g} s; expected {FAST:g} to {slowest:g} s{hint}"


def _validity(samples: Samples) -> Iterator[str]:
    """Find times of validity in another order than the samples, or of long ago."""
    told = samples.time_of_validity[samples.valid]
    if len(told) and (oldest := float(np.max(samples.time[samples.valid] - told))) > OLDEST:
        yield f"time_of_validity is up to {seconds(oldest)} s before a sample comes; expected at most {OLDEST:g} s"
    elif np.any(back := np.diff(told) < 0.0):
        at = seconds(told[int(np.argmax(back))])
        yield f"time_of_validity goes back {int(np.count_nonzero(back))} times, first after {at} s"


def _beyond(samples: Samples) -> Iterator[str]:
    """Find single numbers that no sensor reads, such as -9999 for nothing."""
    for name, (low, high) in LIMITS.items():
        if name in samples.values and samples.sources[name].columns:
            value = samples.values[name]
            seen = samples.valid & samples.known.get(name, np.ones(len(samples), bool))
            out = seen & ((value < low) | (value > high)).reshape(len(samples), -1).any(axis=1)
            if 0 < (count := int(np.count_nonzero(out))) <= len(samples) // 2:
                at = int(np.argmax(out))
                size = ", ".join(f"{x:.4g}" for x in np.atleast_1d(value[at]))
                unit = next(q.unit for q in samples.wanted.quantities if q.name == name)
                unit = "" if unit == "1" else f" {unit}"
                yield (
                    f"{name} is {size}{unit} at t = {seconds(samples.time[at])} s, and in {count} sample(s) below "
                    f"{low:g} or above {high:g}{unit}; does it stand for nothing? Empty cells do, with --incomplete "
                    "invalid"
                )


def _within(name: str, size: np.ndarray, unit: str, bounds: tuple[float, float], what: str) -> Iterator[str]:
    middle, (low, high) = float(np.median(size)), bounds
    if low <= middle <= high:
        return
    told = "" if unit == "1" else f" {unit}"
    hint = _unit_hint(name, middle, unit, bounds)
    if name == "temperature" and not hint:
        hint = "; that of the sensor itself? --value temperature='15 degC' gives another one"
    yield f"{name} is {middle:.4g}{told} in the middle of the file; {what} is {low:.4g} to {high:.4g}{told}{hint}"


def _unit_hint(name: str, value: float, unit: str, bounds: tuple[float, float]) -> str:
    """Say which units would do, if there are."""
    low, high = bounds
    fit = [
        n
        for n in (alike(unit) if unit != "1" else [])
        if n != unit and low <= value * UNITS[n].factor + UNITS[n].offset <= high
    ]
    return f". Are the numbers in {' or '.join(fit)}? --unit {name}='{fit[0]}' says so" if fit else ""


def quiet(time: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Return means (k, 3) of a vector over the quietest tenth of all stretches of a second, at least one."""
    usual = max(float(np.median(np.diff(time))), 1e-4) if len(time) > 1 else 1.0
    step = min(max(round(1.0 / usual), 2), len(time))
    count = len(time) // step
    parts = vector[: count * step].reshape(count, -1, vector.shape[1])
    spread = parts.std(axis=1).sum(axis=1)
    return parts.mean(axis=1)[spread <= np.quantile(spread, 0.1)]


def _specific_force(time: np.ndarray, force: np.ndarray, name: str = "specific_force") -> Iterator[str]:
    still = quiet(time, force)
    size = float(np.median(np.linalg.norm(still, axis=1)))
    if not REST[0] <= size <= REST[1]:
        yield (
            f"{name} is {size:.4g} m/s2 where it is quiet; at rest it is {STANDARD_GRAVITY:.4g}"
            + _unit_hint(name, size, "m/s2", REST)
        )
        return
    mean = np.median(still, axis=0)
    if np.arccos(np.clip(-mean[2] / np.linalg.norm(mean), -1.0, 1.0)) > LEVEL:
        at = int(np.argmax(np.abs(mean)))
        sign, axis = "+" if mean[at] > 0.0 else "-", "xyz"[at]
        down = f"-{axis}" if sign == "+" else axis
        remedy = "--axes x,-y,-z turns them" if at == 2 else f"the third of --axes is {down}"
        yield (
            f"{name} points along {sign}{axis} where it is quiet; at rest the support points up, along -z of "
            f"axes that point forward, right and down: {remedy}"
        )


def _rate(time: np.ndarray, rate: np.ndarray, force: np.ndarray | None) -> Iterator[str]:
    fast = float(np.quantile(np.linalg.norm(rate, axis=1), 0.99))
    if fast > FASTEST:
        yield f"rate is above {fast:.4g} rad/s in one sample of a hundred; no aircraft turns so fast" + _unit_hint(
            "rate", fast, "rad/s", (0.0, FASTEST)
        )
    elif force is not None and len(time) > 10:
        as_told = turn_error(time, rate, force)
        for unit, factor, least in RATES:
            if as_told > least and turn_error(time, rate * factor, force) < 0.25 * as_told:
                yield (
                    f"rate turns the specific force in a second to where it is {np.degrees(as_told):.0f} degrees from "
                    f"that of the accelerometers. Are the numbers in {unit}? --unit rate='{unit}' says so"
                )


def turn_error(time: np.ndarray, rate: np.ndarray, force: np.ndarray) -> float:
    """Median angle, rad, between the specific force (mean over a fifth of a second) and that of a second before, turned
    by the gyros; where stretches without samples are longer than a fifth of a second, nothing is compared."""
    steps, step = 5, 0.2 * TURNED
    cells, cell = np.unique(np.floor((time - time[0]) / step), return_inverse=True)
    if len(cells) <= steps:
        return 0.0
    count = np.bincount(cell)
    means = np.stack([np.bincount(cell, column) / count for column in (*rate.T, *force.T)], axis=1)
    omega, support = means[:, :3], means[:, 3:]
    support = support / np.maximum(np.linalg.norm(support, axis=1, keepdims=True), 1e-9)
    here = support[:-steps]
    for i in range(steps):
        now, then = slice(i, i - steps), slice(i + 1, (i + 1 - steps) or None)
        here = _turned(here, -step * 0.5 * (omega[now] + omega[then]))
    angle = np.arccos(np.clip(np.sum(here * support[steps:], axis=1), -1.0, 1.0))
    whole = cells[steps:] - cells[:-steps] == steps
    return float(np.median(angle[whole])) if whole.any() else 0.0


def _turned(vector: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Rodrigues: vectors (n, 3) turned about axes by angles, both in (n, 3) rad."""
    size = np.linalg.norm(angle, axis=1, keepdims=True)
    axis = angle / np.maximum(size, 1e-12)
    along = np.sum(axis * vector, axis=1, keepdims=True)
    return vector * np.cos(size) + np.cross(axis, vector) * np.sin(size) + axis * along * (1.0 - np.cos(size))


def _angles(values: dict[str, np.ndarray]) -> Iterator[str]:
    for name, bound in (("latitude", 0.5 * np.pi), ("longitude", 2.0 * np.pi), ("roll", 2.0 * np.pi), ("pitch", 1.6)):
        if name in values and (largest := float(np.max(np.abs(values[name])))) > bound:
            unit = "deg" if largest * DEGREE <= 1.01 * bound else "1e-7 deg"
            hint = f". Are the numbers in {unit}? --unit {name}='{unit}' says so"
            fits = largest * DEGREE * (1.0 if unit == "deg" else 1e-7) <= 1.01 * bound
            yield f"{name} is as large as {largest:.4g} rad; expected at most {bound:.3g}" + (hint if fits else "")
            return
    if {"latitude", "longitude"} <= set(values):
        none = (values["latitude"] == 0.0) & (values["longitude"] == 0.0)
        if none.any():
            count = "all" if none.all() else f"{int(none.sum())} of {len(none)}"
            yield f"latitude and longitude are 0 in {count} rows: the receiver had no fix"
            return


def _motion(time: np.ndarray, values: dict[str, np.ndarray]) -> Iterator[str]:
    """Compare what the velocity carries in some seconds with the change of position: units, order, signs."""
    if not {"latitude", "longitude", "altitude", "velocity_n"} <= set(values):
        return
    latitude, longitude, velocity = values["latitude"], np.unwrap(values["longitude"]), values["velocity_n"]
    place = EARTH * np.stack([latitude, np.cos(np.mean(latitude)) * longitude, -values["altitude"] / EARTH], axis=1)
    mean = 0.5 * (velocity[1:] + velocity[:-1]) * np.diff(time)[:, None]
    ends = np.unique(np.searchsorted(time, np.arange(time[0], time[-1], STRETCH)))
    flown, carried = (np.diff(x[ends], axis=0) for x in (place, np.append([[0.0] * 3], np.cumsum(mean, axis=0), 0)))
    level = _rms(flown[:, :2])
    if len(flown) < 6 or level < 3.0 * STRETCH:  # too slow to tell it from errors of positions
        return
    apart = _rms(flown[:, :2] - carried[:, :2]) / level
    if apart > 0.5:
        yield (
            f"velocity_n carries the receiver elsewhere than its positions go: in {STRETCH:g} s they differ by "
            f"{100.0 * apart:.0f} % of the way{_motion_hint(flown, carried, level)}"
        )
    elif _rms(flown[:, 2]) > 0.5 * STRETCH and _rms(flown[:, 2] + carried[:, 2]) < 0.6 * _rms(
        flown[:, 2] - carried[:, 2]
    ):
        yield (
            "velocity_n points up where the altitude rises, and its third part is down: "
            "--axes velocity_n=x,y,-z for north, east, up; velocity_n=y,x,-z for east, north, up"
        )
    elif min(_rms(flown[:, 2]), _rms(carried[:, 2])) > 0.5 * STRETCH:
        scale = _rms(flown[:, 2]) / _rms(carried[:, 2])
        if np.corrcoef(flown[:, 2], carried[:, 2])[0, 1] > 0.8 and not 0.5 < scale < 2.0:
            yield f"altitude changes by {scale:.3g} times what velocity_n carries" + _factor_hint(
                "altitude", scale, "m", 1.4
            )


def _motion_hint(flown: np.ndarray, carried: np.ndarray, level: float) -> str:
    """Say which order, signs or unit would bring the velocity together with the positions, if any does."""
    speeds = [(name, UNITS[name].factor) for name in ("m/s", *(n for n in alike("m/s") if n != "m/s"))]
    for unit, factor in speeds:
        for places in itertools.permutations(range(3), 2):
            for signs in itertools.product((1.0, -1.0), repeat=2):
                if _rms(flown[:, :2] - factor * carried[:, places] * signs) / level < 0.3:
                    third = ({0, 1, 2} - set(places)).pop()
                    axes = [("" if s > 0 else "-") + "xyz"[i] for i, s in zip(places, signs, strict=True)]
                    told = [f"--axes velocity_n={','.join(axes)},{'xyz'[third]} (or -{'xyz'[third]})"]
                    told = told if axes != ["x", "y"] else []
                    told += [f"--unit velocity_n={unit}"] if unit != "m/s" else []
                    return f"; with {' and '.join(told)} they would agree"
    return ""


def _rms(x: np.ndarray) -> float:
    return float(np.sqrt(np.sum(x * x) / max(len(x), 1)))


def _factor_hint(name: str, factor: float, unit: str, about: float = 1.1) -> str:
    fit = [n for n in alike(unit) if n != unit and 1.0 / about < factor * UNITS[n].factor < about]
    return f". Are the numbers in {fit[0]}? --unit {name}='{fit[0]}' says so" if fit else ""


def _air(values: dict[str, np.ndarray], known: dict[str, np.ndarray]) -> Iterator[str]:
    """Compare what says the same: altitude and static pressure, airspeed and impact pressure."""

    def both(one: str, other: str) -> bool:
        return one in values and other in values and len(values[one]) == len(values[other])

    if both("static_pressure", "pressure_altitude"):
        standard = 44330.77 * (1.0 - (np.maximum(values["static_pressure"], 1.0) / 101325.0) ** 0.190263)
        apart = float(np.median(values["pressure_altitude"] - standard))
        if abs(apart) > 0.1 * abs(np.median(standard)) + 400.0:
            scale = float(np.median(values["pressure_altitude"] / np.where(standard == 0.0, 1.0, standard)))
            yield (
                f"pressure_altitude is {abs(apart):.0f} m {'above' if apart > 0.0 else 'below'} the standard altitude "
                "of static_pressure" + _factor_hint("pressure_altitude", scale, "m")
            )
    if "impact_pressure" in values:
        low, high = np.quantile(values["impact_pressure"], [0.02, 0.98])
        if -low > max(100.0, 2.0 * high):
            bounds = f"down to {low:.4g} Pa and up to {high:.4g} Pa"
            yield f"impact_pressure goes {bounds}, as if total and static were exchanged"
    if both("impact_pressure", "calibrated_airspeed"):
        speed = np.sqrt(2.0 * np.maximum(values["impact_pressure"], 0.0) / 1.225)
        fast = (speed > 8.0) & (values["calibrated_airspeed"] > 8.0)
        if np.count_nonzero(fast) > 10:
            scale = float(np.median(values["calibrated_airspeed"][fast] / speed[fast]))
            if not 0.7 < scale < 1.4:
                yield (
                    f"calibrated_airspeed is {scale:.3g} times that of impact_pressure"
                    + _factor_hint("calibrated_airspeed", scale, "m/s")
                )
