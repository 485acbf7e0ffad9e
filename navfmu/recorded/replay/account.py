"""What is told of recorded samples: how regularly they come, what repeats, what is lost in ticks, where they lie."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from navfmu.recorded.replay.doubts import quiet
from navfmu.recorded.replay.samples import Samples


def gaps(samples: Samples) -> np.ndarray:
    """Return the places of samples that are followed by a gap."""
    return np.flatnonzero(np.diff(samples.time) > longest_usual(samples))


def longest_usual(samples: Samples) -> float:
    """Interval above which it is a gap, s: a sample is missing by the middle one, and 19 of 20 are much shorter."""
    interval = np.diff(samples.time)
    return max(1.9 * usual_interval(samples), 1.5 * float(np.quantile(interval, 0.95))) if len(interval) else 0.0


def usual_interval(samples: Samples) -> float:
    """Median time between samples, s; 0 of fewer than two."""
    interval = np.diff(samples.time)
    return float(np.median(interval[interval > 0.0])) if np.any(interval > 0.0) else 0.0


def lost(samples: Samples, tick: float) -> int:
    """How many samples come in one tick with a later one; ``tick`` is its period, s."""
    number = np.maximum(np.ceil(samples.time / tick - 1e-6), 1.0)
    return len(samples) - len(np.unique(number))


def sentences(samples: Samples, tick: float) -> Iterator[str]:
    """Yield what there is to say, for a player that looks for a sample every ``tick`` s."""
    for source in samples.sources.values():
        yield source.text
    usual, interval = usual_interval(samples), np.diff(samples.time)
    told = f"{len(samples)} samples from t = {samples.time[0]:.3f} s to {samples.time[-1]:.3f} s"
    if usual:
        told += (
            f", {1.0 / usual:.4g} a second: intervals of {1e3 * interval.min():.4g} to {1e3 * interval.max():.4g} ms, "
        )
        told += f"{1e3 * usual:.4g} ms in the middle"
    yield told
    if samples.before:
        yield f"{samples.before} sample(s) before t = 0 are left out"
    if samples.incomplete:
        yield f"{samples.incomplete} incomplete row(s) are samples that are not valid, with the values of the last one"
    for name, known in samples.known.items():
        if gone := int(np.count_nonzero(samples.valid & ~known)):
            yield f"{name} is missing in {gone} of {len(samples)} samples, where it is worked out of the others"
    if (invalid := int(np.count_nonzero(~samples.valid))) > samples.incomplete:
        yield f"{invalid} sample(s) are not valid"
    if len(places := gaps(samples)):
        longest = places[np.argmax(interval[places])]
        yield (
            f"{len(places)} gap(s) of more than {longest_usual(samples):.3g} s; the longest lasts "
            f"{interval[longest]:.3g} s from {samples.time[longest]:.3f} s"
        )
    if samples.repeats:
        yield f"{samples.repeats} sample(s) that repeat the one before are left out"
    repeated = samples.repeated()
    if repeated.any():
        yield (
            f"{int(repeated.sum())} sample(s) repeat the values of the one before, up to {_longest(repeated)} in a "
            "row; they are told as new ones, and --changes-only leaves them out"
        )
    if same := int(np.count_nonzero(interval == 0.0)):
        yield f"{same} sample(s) have the time of the next one; they are lost"
    if gone := lost(samples, tick):
        least = interval[interval > 0.0].min() if np.any(interval > 0.0) else 0.0
        yield (
            f"with ticks of {tick:g} s {gone} of {len(samples)} samples are lost, since a later one comes in the same "
            "tick; `sequence` jumps there, and who takes the samples counts them. With tick_period, and steps of the "
            f"master, of {_below(least)} s or less none is lost that has a time of its own"
        )
    values = {name: value[samples.valid] for name, value in samples.values.items() if samples.sources[name].columns}
    if "specific_force" in values:
        still = np.median(quiet(samples.time[samples.valid], values["specific_force"]), axis=0)
        yield (
            f"where it is quietest the specific force is {np.linalg.norm(still):.3f} m/s2, "
            f"({', '.join(f'{x:.2f}' for x in still)})"
        )
    if "field_b" in values:
        size = 1e6 * np.linalg.norm(values["field_b"], axis=1)
        yield f"the field is {np.median(size):.1f} uT in the middle, {size.min():.1f} to {size.max():.1f} uT"
    yield from samples.remarks


def _below(number: float) -> str:
    """Three digits of a number, rounded down: with a longer tick two samples would come in one."""
    unit = 10.0 ** (np.floor(np.log10(number)) - 2.0) if number > 0.0 else 1.0
    return f"{np.floor(number / unit * (1.0 + 1e-12)) * unit:.3g}"


def ranges(samples: Samples) -> Iterator[tuple[str, str, float, float, float]]:
    """Yield name of a number, unit, and its least, middle and largest value."""
    for quantity in samples.wanted.quantities:
        if quantity.name in samples.values:
            known = samples.known.get(quantity.name, np.ones(len(samples), bool)) & samples.valid
            for label, column in zip(quantity.labels, np.atleast_2d(samples.values[quantity.name].T), strict=True):
                seen = column[known]
                if len(seen):
                    yield label.partition(" ")[0], quantity.unit, seen.min(), float(np.median(seen)), seen.max()


def _longest(mask: np.ndarray) -> int:
    """Length of the longest run of True."""
    edges = np.flatnonzero(np.diff(np.r_[0, mask.astype(int), 0]))
    return int(np.max(edges[1::2] - edges[::2]))
