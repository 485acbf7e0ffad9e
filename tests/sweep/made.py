"""Sweeps made of given numbers."""

from __future__ import annotations

from navfmu.sweep.result import ALGORITHMS, Row, Sweep

STEPS = (0.1, 0.2, 0.4)
CLEAN = [0.0, 0.02, 0.06]
NAN = float("nan")


def made(gauss_seidel=CLEAN, jacobi=CLEAN, steps=STEPS, span=10.0, unit="m", apart=0.0, **fields) -> Sweep:
    """Errors of the signal a.y by step; a text in place of a number is a problem."""
    rows = [
        Row(algorithm, step, "a.y", unit, NAN, NAN, span, error)
        if isinstance(error, str)
        else Row(algorithm, step, "a.y", unit, error, error, span)
        for algorithm, errors in zip(ALGORITHMS, (gauss_seidel, jacobi), strict=True)
        for step, error in zip(steps, errors, strict=True)
    ]
    given = {"lost": {}, "tolerance": 0.01, "provenance": {}} | fields
    return Sweep("made", tuple(steps), 1.0, 0.4, tuple(rows), {"a.y": apart}, **given)


def counted(*numbers: int) -> dict:
    """Samples lost by step, the same for both algorithms."""
    return {"b.fix.lost": {(a, step): n for a in ALGORITHMS for step, n in zip(STEPS, numbers, strict=True)}}
