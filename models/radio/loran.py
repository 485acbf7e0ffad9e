"""LORAN-C: a fix that is wrong by what the ground does to the wave, hardly by noise.

Thesis section 7.3: 0.25 nmi, by the Coast Guard's handbook of 1992, which is taken as 2 drms: twice the root of the sum
of both variances, a circle that holds 98 % where both are equal. A flight evaluation (Hollister, Natarajan and
Littlefield, Navigation 28, 1981) found a quarter of a mile uncorrected and 200 ft where the error of the place was
taken out.
"""

from __future__ import annotations

import numpy as np

from navfmu.constants import FOOT, NAUTICAL_MILE

ACCURACY, REPEATED = 0.25 * NAUTICAL_MILE, 200.0 * FOOT
"""2 drms of the error, and of what is not of the place, m."""
NOISE_SIGMA = REPEATED / np.sqrt(8.0)
"""Of north and of east, m: 2 drms is twice sqrt(2) of it."""
PLACE_SIGMA = np.sqrt((ACCURACY**2 - REPEATED**2) / 8.0)
"""Of the part of the place, north and east, m."""
CORRELATION_DISTANCE = 20.0 * NAUTICAL_MILE
"""Over which the ground changes, m; own choice."""
