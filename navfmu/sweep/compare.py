"""Compares the runs of a sweep: each signal with the same algorithm at the smallest step, where both are valid."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from navfmu.errors import NavfmuError
from navfmu.fmi.names import bundle
from navfmu.sweep.result import ALGORITHMS, Row

if TYPE_CHECKING:
    import pandas

Frames = Mapping[tuple[str, float], "pandas.DataFrame"]
"""Recordings by algorithm and step; they share their points in time, as far as FMUs let them come."""


def comparable(frames: Frames) -> tuple[list[str], tuple[str, ...]]:
    """The Real signals; those that are valid somewhere, and those that are valid in no run."""
    columns = next(iter(frames.values()))
    names = [n for n in columns if columns[n].dtype.kind == "f" and not n.endswith(".time_of_validity")]
    if not names:
        raise NavfmuError("none of the chosen signals is Real: there is nothing to compare")
    alive = [name for name in names if any(valid(frame, name).any() for frame in frames.values())]
    if not alive:
        raise NavfmuError("none of the chosen signals is valid in any run: there is nothing to compare")
    return alive, tuple(name for name in names if name not in alive)


def not_real(frames: Frames) -> tuple[str, ...]:
    """Signals that say something of their own and have no error: not the flags and numbers of bundles."""
    columns = next(iter(frames.values()))
    about = (".valid", ".sequence", ".lost")
    return tuple(name for name in columns if columns[name].dtype.kind != "f" and not name.endswith(about))


def compare(frames: Frames, names: Sequence[str], smallest: float) -> tuple[list[Row], dict[str, float]]:
    """Rows of the signals in all runs, and how far the algorithms are apart at the smallest step."""
    reference, other = (frames[algorithm, smallest] for algorithm in ALGORITHMS)
    units = reference.attrs["units"]
    spans = {name: span(reference, name) for name in names}
    rows = []
    for (algorithm, step), frame in frames.items():
        for name in names:
            rms, largest, problem = difference(frame, frames[algorithm, smallest], name)
            rows.append(Row(algorithm, step, name, units.get(name) or "", rms, largest, spans[name], problem))
    return rows, {name: difference(other, reference, name)[0] for name in names}


def difference(frame: pandas.DataFrame, reference: pandas.DataFrame, name: str) -> tuple[float, float, str]:
    """Root mean square and greatest size of a signal's difference where both are valid, or NaN and the reason.

    Angles differ the short way round.
    """
    import numpy as np

    if problem := ended(frame, reference):
        return np.nan, np.nan, problem
    both = valid(frame, name) & valid(reference, name)
    a, b = (each[name].to_numpy()[both] for each in (frame, reference))
    if not len(a):
        return np.nan, np.nan, "is valid at no common point"
    finite = np.isfinite(a) & np.isfinite(b)
    if not finite.all():
        return np.nan, np.nan, f"is not finite at {np.count_nonzero(~finite)} of {len(a)} points"
    error = a - b
    if reference.attrs["units"].get(name) == "rad":
        error = np.remainder(error + np.pi, 2.0 * np.pi) - np.pi
    with np.errstate(over="ignore"):
        rms = float(np.sqrt(np.mean(error**2)))
    if not np.isfinite(rms):
        return np.nan, np.nan, "differs by more than a number can hold"
    return rms, float(np.max(np.abs(error))), ""


def ended(frame: pandas.DataFrame, reference: pandas.DataFrame) -> str:
    """Why two runs cannot be compared of which an FMU has ended one too early, or ""."""
    last, smallest = (float(each.index[-1]) for each in (frame, reference))
    if last != smallest:
        return f"is recorded up to {last:g} s, and up to {smallest:g} s at the smallest step"
    return "" if len(frame) > 1 else f"is recorded at t = {last:g} s only"


def span(frame: pandas.DataFrame, name: str) -> float:
    """Greatest minus least value where valid; NaN when one of them is not finite, 0 without any."""
    import numpy as np

    values = frame[name].to_numpy()[valid(frame, name)]
    if not len(values):
        return 0.0
    return float(np.ptp(values)) if np.isfinite(values).all() else np.nan


def valid(frame: pandas.DataFrame, name: str) -> Any:
    """Which points of a signal mean something: before its first measurement a bundle shows start values."""
    import numpy as np

    flag = validity(name)
    return frame[flag].to_numpy(bool) if flag in frame.columns else np.ones(len(frame), bool)


def validity(signal: str) -> str:
    """The ``valid`` of the bundle that a signal belongs to, if it belongs to one."""
    return f"{bundle(signal)}.valid"
