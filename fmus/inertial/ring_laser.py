"""A triad of ring-laser gyros as an FMU."""

from __future__ import annotations

import numpy as np

from models.inertial import increments, ring_laser
from models.processes.known import known
from navfmu.export import Bundle, Component, Example, Input, Output, Parameter, State, every, start

ARCSEC = float(np.pi / 648000.0)
DEG_PER_HOUR = ARCSEC


class RingLaser(Component):
    """Three ring-laser gyros: pulses, lock-in, dither.

    The phase between the beams of a ring turns by 2 pi for each pulse, of 2 arcsec as printed in AGARD CP-298, Bachman
    (K = wavelength L / 4 A; 1.99 for its 34.5 cm and 0.63 um). Scattered light pulls the phase towards a value of its
    own, so a ring that turns slower than the lock-in rate shows nothing: 300 deg/h as in RTO MP-43 (1999), Loukianov,
    Fig 5. Dither takes it through that zone 800 times in a second; what is left is a random walk of the angle,
    w_L sqrt(K / (2 pi w_D)), 0.0047 deg per root hour with the start values, where AGARD CP-298 has measured 0.0011 to
    0.0050; it grows as w comes near w_D, with sqrt(w_D^2 - w^2) for w_D, and is nothing beyond. The dither's peak rate
    w_D of 100 deg/s is some 30 g at the mirrors of a ring of 60 cm, Loukianov's figure, at 400 Hz. The motion of the
    dither itself is taken out of the pulses, as the gyros' own electronics do.

    With the dither off (a fault), each axis follows Adler's equation exactly while its rate is held over a sample:
    no pulses below the lock-in rate, and sqrt(w^2 - w_L^2) in the mean above it.

    Other errors of the gyros (null shift, scale factor, drift) are those of ``imu``.
    """

    name = "ring_laser"
    example = Example(
        steps={"rate": (0.0, 0.0, 0.02)},
        text="Increments of the third axis step to whole pulses of the true angle; the other two show single pulses of "
        "the random walk that the dither leaves.",
    )

    rate = Input(3, "rad/s", display_unit="deg/s", description="true rate with respect to inertial space, body axes")
    dither_off = Input(kind="boolean", fault=True, description="fault: the rings are not turned to and fro while true")

    pulse = Parameter(
        "rad",
        start=2.0 * ARCSEC,
        min=1e-9,
        max=1e-3,
        display_unit="arcsec",
        description="angle of a pulse, AGARD CP-298, Bachman: 2 arcsec",
    )
    lock_in = Parameter(
        3,
        "rad/s",
        start=300.0 * DEG_PER_HOUR,
        min=0.0,
        max=0.1,
        display_unit="deg/h",
        description="rate below which the beams lock, RTO MP-43 (1999), Loukianov, Fig 5: 300 deg/h",
    )
    dither_rate = Parameter(
        "rad/s",
        start=float(np.radians(100.0)),
        min=0.01,
        max=20.0,
        display_unit="deg/s",
        description="peak rate of the dither (own choice: 30 g at the mirrors, 400 Hz)",
    )
    sample_period = Parameter("s", start=0.01, min=1e-4, max=1.0, description="period of the increments")

    increment = Bundle(
        angle=Output(3, "rad", display_unit="arcsec", description="increment of the angle in whole pulses, body axes"),
        pulses=Output(3, "1", description="pulses of the increment"),
        description="increment",
    )

    phase_sine = State(3, "1", description="sine of half the phase between the beams")
    phase_cosine = State(3, "1", description="cosine of half of it")
    rest = State(3, "rad", description="angle that has not made a pulse")

    @start
    def turn_on(self, noise):
        phase = np.pi * noise(3)
        self.phase_sine, self.phase_cosine = np.sin(0.5 * phase), np.cos(0.5 * phase)

    @every("sample_period")
    def sample(self, noise):
        rate = known(self.rate, 0.0)
        turned, self.phase_sine, self.phase_cosine = ring_laser.advance(
            self.phase_sine,
            self.phase_cosine,
            rate,
            self.lock_in,
            self.pulse,
            np.where(self.dither_off, self.period, 0.0),
        )
        walk = ring_laser.random_walk(self.lock_in, self.pulse, self.dither_rate, rate)
        angle = np.where(
            self.dither_off,
            turned * self.pulse / (2.0 * np.pi),
            rate * self.period + walk * np.sqrt(self.period) * noise(3),
        )
        counted, self.rest = increments.counted(angle, self.rest, self.pulse)
        self.increment.publish(
            angle=counted, pulses=np.rint(counted / self.pulse), valid=np.all(np.isfinite(self.rate))
        )
