"""Attitude filters of other people on recorded samples, where their packages are installed: ``vqf`` and ``ahrs``.

Both take samples of one period, sensor axes that point up, and tell attitude towards magnetic north.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable

import numpy as np
from scipy.spatial.transform import Rotation

FLU = np.array([1.0, -1.0, -1.0])
FRD_OF_FLU = Rotation.from_matrix(np.diag(FLU))
NED_OF_ENU = Rotation.from_matrix([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
NED_OF_NWU = FRD_OF_FLU


def vqf(time: float, rate: np.ndarray, force: np.ndarray, field: np.ndarray, period: float) -> Rotation:
    """VQF (Laidig and Seel, *Information Fusion* 91 (2023), p. 187) with an accelerometer time constant of ``time`` s,
    without its rejection of disturbances."""
    filter_ = importlib.import_module("vqf").VQF(period, tauAcc=time, magDistRejectionEnabled=False)
    found = filter_.updateBatch(*(np.ascontiguousarray(x * FLU) for x in (rate, force, field)))["quat9D"]
    return NED_OF_ENU * Rotation.from_quat(np.roll(found, -1, axis=1)) * FRD_OF_FLU


def madgwick(gain: float, rate: np.ndarray, force: np.ndarray, field: np.ndarray, period: float) -> Rotation:
    """Madgwick's filter by the package ``ahrs``."""
    filters = importlib.import_module("ahrs.filters")
    found = filters.Madgwick(gyr=rate * FLU, acc=force * FLU, mag=1e9 * field * FLU, Dt=period, gain=gain).Q
    return NED_OF_NWU * Rotation.from_quat(np.roll(found, -1, axis=1)) * FRD_OF_FLU


FILTERS: dict[str, tuple[str, Callable[..., Rotation]]] = {
    "VQF, 30 s": ("vqf", lambda *samples: vqf(30.0, *samples)),
    "VQF, 3 s": ("vqf", lambda *samples: vqf(3.0, *samples)),
    "Madgwick, gain 0.12": ("ahrs", lambda *samples: madgwick(0.12, *samples)),
}
"""By what they are called: the package that is needed, and attitudes in n of samples in b."""
