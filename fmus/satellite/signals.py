"""What passes between a receiver's measurements and the solution of its position: one bundle for all satellites."""

from __future__ import annotations

import numpy as np

from navfmu.export import Bundle, Input, Output

PLACES = 24
"""Places for satellites; a satellite keeps its place while it is measured."""


def signals(kind: type[Input] | type[Output]) -> Bundle:
    """Return the bundle ``signals``, of outputs of what measures or of inputs of what solves."""
    return Bundle(
        week=kind(kind="integer", description="GPS week of the time tag, counted from 1980-01-06"),
        seconds=kind("s", description="time tag, GPS seconds of the week by the receiver's clock"),
        tracked=kind(PLACES, kind="boolean", description="whether there is a measurement of this satellite"),
        number=kind(PLACES, kind="integer", description="PRN, 0 where no satellite is"),
        pseudorange=kind(PLACES, "m", description="measured at L1, as it is, with all clocks and delays"),
        range_rate=kind(PLACES, "m/s", description="-Doppler times wavelength, positive where the range grows"),
        signal_to_noise=kind(PLACES, "1", description="C/N0, dB-Hz"),
        satellite_e=kind(PLACES, 3, "m", description="satellite at transmission, e of then"),
        satellite_velocity_e=kind(PLACES, 3, "m/s", description="velocity of it, e of then"),
        satellite_clock=kind(
            PLACES, "s", description="satellite clock at transmission, with relativity, less group delay"
        ),
        satellite_clock_rate=kind(PLACES, "1", description="rate of it"),
        accuracy=kind(PLACES, "m", start=np.full(PLACES, 2.4), description="user range accuracy sent by the satellite"),
        correction=kind(PLACES, "m", description="differential correction, added to the pseudorange where `corrected`"),
        correction_sigma=kind(PLACES, "m", description="standard deviation that it leaves, as told; 0: not told"),
        corrected=kind(PLACES, kind="boolean", description="whether there is a differential correction"),
        description="measurements of satellites",
    )
