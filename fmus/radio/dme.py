"""The FMU ``dme``: airborne DME receiver and the transponders it ranges to."""

from __future__ import annotations

import numpy as np

from fmus import examples
from fmus.radio import stations
from models.processes import gauss_markov
from models.radio import dme
from navfmu.export import Bundle, Component, Example, Input, Output, Parameter, State, every, require, start

PLACES = stations.PLACES


class Dme(stations.StationTable, Component):
    """DME receiver with up to five ground transponders: slant ranges by schedule, with coverage and errors.

    Ranges (thesis section 2.5.5 and 3.9, p. 69). The reading of each station is

        R_m = R + dR_b + dR_w                                                            (3.38)

    R: straight distance on the WGS-84 ellipsoid. dR_b: first-order Gauss-Markov bias of 0.17 nmi with the correlation
    time tau_r = 0.5 nmi / V, V the ground speed; one for each station, advanced on its own clock (`bias_period`), so
    that it does not depend on when ranges are measured; it starts from its stationary distribution. dR_w: white noise
    of 0.004 nmi, fresh for each reading. (Table 6.1 of the thesis prints 5 miles / V; the text and (3.38) have 0.5
    nmi)

    Schedule (Fig 2.10, section 7.2.2), by `mode`:

    - 1 intermittent: one receiver; every `interval` it has measured one station, the stations take turns. To do so it
      is tuned to the station for `lock_in` + `ranging_time` before, and the station must answer all that time.
    - 2 two-receiver: two receivers, two stations at the same time every `interval` (with more than two stations, pairs
      take turns).
    - 3 scanning: every station every `ranging_period`, once it has been locked in.

    A range is reported at the end of its ranging second and its time of validity is that moment. At each time a
    measurement is due the bundle is published, with `measured` saying which stations gave one; `valid` is false when
    none did. A station answers while it is nearer than `station_range`, above the radio horizon (4/3 earth, smooth, no
    terrain) and not switched off (`station_off`).

    Not modelled: garbling and the saturation of transponders by other aircraft (the schedule exists to avoid it),
    DME-P.
    """

    example = Example(
        text="Level flight to the west at 90 kn with one receiver. It measures the two stations in turn, one every "
        "15 s, and the bundle holds the last range of each, so between measurements the ranges (steps) stay behind the "
        "truth (dashed). The error of each measurement is the bias, 315 m (1 sigma), forgotten within 20 s.",
        duration=300.0,
        step=0.5,
        inputs=examples.dme_inputs,
        shows=("ranging.sequence", "ranging.valid"),
        panels=examples.dme_panels,
    )

    latitude = Input("rad", display_unit="deg", description="true geodetic latitude")
    longitude = Input("rad", display_unit="deg", description="true longitude")
    altitude = Input("m", display_unit="ft", description="true height above the ellipsoid, positive up")
    velocity_n = Input(
        3,
        "m/s",
        display_unit="kn",
        description="true velocity over ground: north, east, down; sets the correlation time",
    )
    station_off = Input(
        PLACES, kind="boolean", fault=True, description="fault: this transponder is off the air and does not answer"
    )

    mode = Parameter(
        kind="integer",
        start=1,
        min=1,
        max=3,
        description="receiver: 1 intermittent (one receiver), 2 two-receiver, 3 scanning (thesis section 7.2.2)",
    )
    station_range = Parameter(
        PLACES,
        "m",
        start=stations.UNLIMITED * dme.NAUTICAL_MILE,
        min=0.0,
        display_unit="nmi",
        description="service range of each transponder; it does not answer beyond",
    )
    antenna_height = Parameter(
        "m", start=10.0, min=0.0, max=500.0, description="height of the transponders' antennas, for the radio horizon"
    )
    interval = Parameter(
        "s",
        start=15.0,
        min=1.0,
        max=3600.0,
        description="time between measurements in modes 1 and 2; 15 s by the transponders' capacity (thesis Fig 2.10)",
    )
    lock_in = Parameter(
        "s", start=dme.LOCK_IN, min=0.0, max=60.0, description="tracking before a range can be taken (thesis Fig 2.10)"
    )
    ranging_time = Parameter(
        "s", start=dme.RANGING, min=0.0, max=60.0, description="duration of ranging after lock-in (thesis Fig 2.10)"
    )
    ranging_period = Parameter(
        "s",
        start=1.0,
        min=0.01,
        max=60.0,
        description="time step of the receiver; period of mode 3 (thesis section 7.3)",
    )
    bias_sigma = Parameter(
        "m",
        start=dme.BIAS_SIGMA,
        min=0.0,
        display_unit="nmi",
        description="standard deviation of the time-varying bias: 0.17 nmi (thesis (3.38), p. 72)",
    )
    correlation_distance = Parameter(
        "m",
        start=dme.CORRELATION_DISTANCE,
        min=1.0,
        display_unit="nmi",
        description="distance over which the bias is correlated: 0.5 nmi (thesis (3.38), p. 72)",
    )
    lowest_speed = Parameter(
        "m/s", start=5.0, min=0.1, description="least ground speed used in the correlation time 0.5 nmi / V"
    )
    noise_sigma = Parameter(
        "m",
        start=dme.NOISE_SIGMA,
        min=0.0,
        display_unit="nmi",
        description="standard deviation of the wide-band noise: 0.004 nmi (thesis Fig 3.13, (3.38))",
    )
    bias_period = Parameter("s", start=0.5, min=0.001, max=10.0, description="time step of the biases, own clock")

    ranging = Bundle(
        slant_range=Output(PLACES, "m", display_unit="nmi", description="measured distance, where `measured`"),
        measured=Output(PLACES, kind="boolean", description="whether this range was measured at the time of validity"),
        description="DME ranges",
    )
    bias = State(PLACES, "m", description="time-varying bias dR_b of each station (3.38)")
    tracking = State(PLACES, "s", description="how long each station has been asked and has answered without a break")

    @require("interval {interval} s is shorter than lock_in {lock_in} s plus ranging_time {ranging_time} s")
    def interval_is_long_enough(self):
        return np.logical_or(self.mode == 3, self.interval >= self.lock_in + self.ranging_time)

    @start
    def draw_biases(self, noise):
        self.bias = gauss_markov.stationary(self.bias_sigma, noise(PLACES))

    @every("bias_period")
    def advance_biases(self, noise):
        tau = dme.correlation_time(self.velocity_n, self.lowest_speed, self.correlation_distance)
        phi = gauss_markov.decay(self.period, tau)
        driving = gauss_markov.drive(self.bias_sigma, phi)
        self.bias = gauss_markov.advance(self.bias, phi, driving, noise(PLACES))

    @every("ranging_period")
    def receive(self, noise):
        dwell = self.lock_in + self.ranging_time
        asked, due = dme.asked(self.time, self.period, self.mode, self.interval, dwell, self.station_count)
        true_range = dme.slant_range(
            self.latitude,
            self.longitude,
            self.altitude,
            self.station_latitude,
            self.station_longitude,
            self.station_altitude,
        )
        reach = np.minimum(dme.horizon(self.altitude, self.station_altitude, self.antenna_height), self.station_range)
        answered = asked & (true_range <= reach) & np.logical_not(self.station_off)
        self.tracking = dme.tracking_time(self.tracking, answered, self.period)
        measured = due & (self.tracking >= dwell - 1.0e-6)
        reading = dme.measure(true_range, self.bias, self.noise_sigma, noise(PLACES))
        self.ranging.publish(
            slant_range=np.where(measured, reading, self.ranging.slant_range),
            measured=measured,
            valid=np.any(measured),
            when=np.any(due),
        )
