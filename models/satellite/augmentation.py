"""Wide area augmentation (WAAS): what its corrections leave, what it says of that, and what it protects.

RTCA DO-229, appendices A and J: corrections of orbit and clock with sigma_flt (UDRE / 3.29), of the ionosphere at grid
points with sigma_GIVE, a model of the troposphere. Their variances add up.
"""

from __future__ import annotations

import numpy as np

UDRE, GIVE = 3.0, 3.0
"""Bounds (99.9 %) that were usual in 2004, m: indices 5 and 9 of the messages."""
BOUND = 3.29
"""Sigmas of such a bound."""
SHARE = 0.3
"""Of the sigmas that are told, that errors have."""
TIMEOUT = 12.0
"""Of corrections in a precision approach, s; appendix A of DO-229."""
NEVER = 1e9
"""s."""
HEIGHT = 350e3
"""Of the ionosphere, m, and radius of the earth below it; J.2.3 of DO-229."""
RADIUS = 6378136.3
TROPOSPHERE = 0.12
"""Of the model at the zenith, m; A.4.2.4."""
HORIZONTAL, VERTICAL = 6.0, 5.33
"""Sigmas of the protection levels in a precision approach, J.2.1: 1e-7 of an approach, one and two directions."""


def obliquity(sine):
    """F_pp: path through the ionosphere over that at the zenith, by the sine of the elevation."""
    across = RADIUS / (RADIUS + HEIGHT)
    return 1.0 / np.sqrt(1.0 - across * across * (1.0 - sine * sine))


def troposphere(sine):
    """m(E): the same through the troposphere, A.4.2.4."""
    return 1.001 / np.sqrt(0.002001 + sine * sine)


def sigma(sine, udre_sigma, give_sigma):
    """Standard deviation of what corrections leave, as told, m: J.1 without the receiver's own part."""
    ionosphere, air = obliquity(sine) * give_sigma, TROPOSPHERE * troposphere(sine)
    return np.sqrt(udre_sigma * udre_sigma + ionosphere * ionosphere + air * air)


def correction(own, ionosphere, troposphere, left):
    """What is added to a pseudorange, m, that is too long by its own error and delays, so that ``left`` remains."""
    return left - (own + ionosphere + troposphere)


def protection(p):
    """Horizontal and vertical protection level, m, of the covariance of a position in n: J.2.1, J.2.2.

    The horizontal one is that of the longest axis of the ellipse.
    """
    middle, apart = 0.5 * (p[0, 0] + p[1, 1]), 0.5 * (p[0, 0] - p[1, 1])
    longest = middle + np.sqrt(apart * apart + p[0, 1] * p[0, 1])
    return HORIZONTAL * np.sqrt(np.maximum(longest, 0.0)), VERTICAL * np.sqrt(np.maximum(p[2, 2], 0.0))
