"""Traced arrays put in order: the largest and where it is, sorted, the middle one."""

from __future__ import annotations

from typing import Any

import numpy as np


def _last(a: Any, axis: Any) -> Any:
    """Return the array with the axis behind all others; without an axis all its elements in one row."""
    return np.ravel(a) if axis is None else np.moveaxis(a, axis, -1)


def _placed(result: Any, a: Any, axis: Any, keepdims: bool) -> Any:
    if not keepdims:
        return result
    return np.reshape(result, (1,) * np.ndim(a)) if axis is None else np.expand_dims(result, axis)


def _first_of(beats: Any, a: Any, axis: Any, keepdims: bool) -> Any:
    """Return the index of the first element that no other one beats; a NaN is beaten by none."""
    row = _last(a, axis)
    if row.shape[-1] == 0:
        raise ValueError("attempt to get argmax or argmin of an empty sequence")
    best, index = row[..., 0], np.zeros(row.shape[:-1], int)
    for i in range(1, row.shape[-1]):
        one = row[..., i]
        better = np.logical_and(np.logical_or(beats(one, best), np.isnan(one)), np.logical_not(np.isnan(best)))
        best, index = np.where(better, one, best), np.where(better, i, index)
    return _placed(index, a, axis, keepdims)


def argmax(a: Any, axis: Any = None, out: None = None, *, keepdims: Any = False) -> Any:
    """Index of the first largest element."""
    return _first_of(np.greater, a, axis, keepdims is True)


def argmin(a: Any, axis: Any = None, out: None = None, *, keepdims: Any = False) -> Any:
    """Index of the first smallest element."""
    return _first_of(np.less, a, axis, keepdims is True)


def sort(a: Any, axis: Any = -1, kind: Any = None, order: None = None, *, stable: Any = None) -> Any:
    """Elements in increasing order, NaN last: Batcher's odd-even merging exchange, the same for all values."""
    row = _last(a, axis)
    columns = [row[..., i] for i in range(row.shape[-1])]
    for low, high in _exchanges(len(columns)):
        one, other = columns[low], columns[high]
        wrong = np.logical_or(other < one, np.logical_and(np.isnan(one), np.logical_not(np.isnan(other))))
        columns[low], columns[high] = np.where(wrong, other, one), np.where(wrong, one, other)
    result = np.stack(columns, axis=-1) if columns else row
    return result if axis is None else np.moveaxis(result, -1, axis)


def _exchanges(n: int) -> list[tuple[int, int]]:
    """Return the pairs of places that are compared, in order (Knuth, The Art of Computer Programming 3, 5.2.2 M)."""
    pairs: list[tuple[int, int]] = []
    if n < 2:
        return pairs
    top = 1 << ((n - 1).bit_length() - 1)
    p = top
    while p:
        q, r, d = top, 0, p
        while True:
            pairs += [(i, i + d) for i in range(n - d) if i & p == r]
            if q == p:
                break
            d, q, r = q - p, q >> 1, p
        p >>= 1
    return pairs


def median(a: Any, axis: Any = None, out: None = None, overwrite_input: bool = False, keepdims: bool = False) -> Any:
    """The middle element, of an even number the mean of the two in the middle; NaN if there is one."""
    row = sort(_last(a, axis))
    n = row.shape[-1]
    middle = np.mean(row[..., (n - 1) // 2 : n // 2 + 1], axis=-1)
    return _placed(np.where(np.isnan(row[..., -1]), row[..., -1], middle), a, axis, keepdims)
