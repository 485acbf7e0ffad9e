"""The order of an error: how fast it falls with the communication step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

LEAST, MOST = 0.05, 6.0  # orders outside are not told from an error that has none


@dataclass(frozen=True)
class Order:
    """Order p of an error that at the step h is C (h^p - h_0^p), where h_0 is the smallest step."""

    value: float
    points: int  # errors that it was found from
    deviation: float | None  # standard deviation of ``value`` by the residuals; None: two errors fit exactly

    def __str__(self) -> str:
        return f"{self.value:.2f} (exact)" if self.deviation is None else f"{self.value:.2f} ± {self.deviation:.2f}"


def fit(steps: Sequence[float], errors: Sequence[float], smallest: float) -> Order | None:
    """Least squares of the logarithms over steps (s) above the ``smallest``; all errors are positive.

    None where the errors have no order: fewer than two of them, or a best order outside ``LEAST`` to ``MOST``.
    """
    if len(errors) < 2:
        return None
    import numpy as np
    from scipy.optimize import minimize_scalar

    h, logarithm = np.array(steps), np.log(errors)

    def shape(p: float) -> np.ndarray:
        return np.log(h**p - smallest**p)

    def badness(p: float) -> float:
        return float(np.var(logarithm - shape(p)))

    p = float(minimize_scalar(badness, bounds=(LEAST, MOST), method="bounded", options={"xatol": 1e-6}).x)
    if not LEAST + 1e-3 < p < MOST - 1e-3:
        return None
    spare = len(errors) - 2
    if spare == 0:
        return Order(p, 2, None)
    slope = (shape(p + 1e-4) - shape(p - 1e-4)) / 2e-4
    scatter = badness(p) * len(errors) / spare
    return Order(p, len(errors), float(np.sqrt(scatter / np.sum((slope - slope.mean()) ** 2))))
