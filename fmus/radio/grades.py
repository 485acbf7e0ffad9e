"""Receivers and networks of which figures are published, as values of the parameters of ``dme``."""

from __future__ import annotations

import numpy as np

from navfmu.constants import NAUTICAL_MILE
from navfmu.export import ParameterSet

DME: dict[str, ParameterSet] = {
    "five_station_scan": ParameterSet(
        "A receiver that takes five stations in turn, 2 s each: Brokof and Hurrass, Integrated Navigation on Multiple "
        "DME, in AGARD CP-298. Errors of 0.06 nmi at random, 150 m of a station, 200 m of the receiver; stations above "
        "18 deg are left out. How the 2 s are divided is own choice.",
        {
            "mode": 1,
            "interval": 2.0,
            "lock_in": 1.0,
            "ranging_time": 1.0,
            "bias_sigma": 0.0,
            "noise_sigma": 0.06 * NAUTICAL_MILE,
            "receiver_offset": 200.0,
            "station_offset_sigma": 150.0,
            "highest_elevation": float(np.radians(18.0)),
        },
    ),
    "dme_p": ParameterSet(
        "Precision DME, ICAO Annex 10, volume I, table B, standard 1: within 7 nmi errors of 30 m at the threshold to "
        "85 m at 5 nmi (95 %); further off as any other.",
        {"precise": (True,) * 5},
    ),
    "annex_10": ParameterSet(
        "ICAO Annex 10, volume I, 3.5.3.1.3.3: no more than 370 m of the system and 315 m of the receiver, which hold "
        "on a 95 per cent basis (3.5.3.1.3.1) and are taken as two standard deviations.",
        {"bias_sigma": 370.0 / 2.0, "receiver_share": float((315.0 / 370.0) ** 2)},
    ),
}
