"""What a filter would have known had it seen the whole recording: Rauch, Tung and Striebel's smoother.

For filters whose corrections go into a trajectory of their own (latitude, attitude ...) and whose error states are zero
after each: nothing is kept of a step but its covariances, its transition and the correction at its end.

Equations: H. E. Rauch, F. Tung, C. T. Striebel, Maximum likelihood estimates of linear dynamic systems, AIAA Journal 3
(1965), p. 1445, (3.28) to (3.30).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Step:
    """From one epoch to the next, for n error states.

    Attributes
    ----------
    begun
        Covariance at its beginning, with all measurements up to then, (n, n).
    transition
        Phi, (n, n).
    predicted
        Covariance at its end, before the measurements there, (n, n).
    correction
        What these added to the trajectory, (n,).
    """

    begun: np.ndarray
    transition: np.ndarray
    predicted: np.ndarray
    correction: np.ndarray


def smoothed(steps: list[Step], last: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corrections and covariances at each beginning of a step and at the end of the last.

    Parameters
    ----------
    steps
        All of a recording, in the order of time.
    last
        Covariance at the end, with all measurements, (n, n).

    Returns
    -------
    What is to be added to the trajectory after its corrections, (steps + 1, n), and what is then not known of it,
    (steps + 1, n, n).
    """
    later, covariance = np.zeros(len(last)), last
    corrections, covariances = [later], [covariance]
    for step in reversed(steps):
        gain = _divided(step.begun @ step.transition.T, step.predicted)
        later = gain @ (step.correction + later)
        covariance = step.begun + gain @ (covariance - step.predicted) @ gain.T
        covariance = 0.5 * (covariance + covariance.T)
        corrections.append(later)
        covariances.append(covariance)
    return np.array(corrections[::-1]), np.array(covariances[::-1])


def _divided(numerator: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """``numerator`` times the inverse of a covariance, whose states are first brought to a variance of one: those of
    position in rad and of biases in m/s2 are 10 orders apart. A state that is known has no share."""
    scale = np.sqrt(np.diag(covariance))
    scale = np.where(scale > 0.0, scale, 1.0)
    scaled = covariance / np.outer(scale, scale)
    return numerator / scale @ np.linalg.pinv(scaled, hermitian=True) / scale
