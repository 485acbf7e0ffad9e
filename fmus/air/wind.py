"""The wind along the flight as an FMU."""

from __future__ import annotations

import numpy as np

from models.air import turbulence, wind
from models.processes import gauss_markov
from models.processes.known import known
from navfmu.export import Component, Example, Input, Output, Parameter, State, every, require, start

LAYERS = 8
"""Rows of the table of winds by altitude."""


class Wind(Component):
    """Wind along the flight: a mean and the Berman-Powell random part; profile, shear, gusts and turbulence if wished.

    Thesis section 3.8, p. 66. On each axis the random part is a first-order Gauss-Markov process, (3.36)-(3.37),

        d(dV)/dt_r = -dV / tau + w,   sigma = 5 m/s,  tau = 400 s

    over the travelling time t_r of (3.35), t_r^2 = t_N^2 + t_E^2 + t_D^2 + dt^2 with t_N = dp_N / V_N and so on for
    the axes on which the aircraft moves. Where velocity_n is connected this is what it flies: sqrt(2) times the time
    along one axis, sqrt(3) level across both, 2 in a climb; where it is not, travelling_time_ratio says it, 1 as the
    thesis's own analyses take it. The process starts in its stationary distribution and is advanced exactly,
    dV <- phi dV + sigma sqrt(1 - phi^2) n with phi = exp(-ratio T / tau), every sample_period T, and held in between.
    The model was fitted between 2000 and 10000 ft.

    To this are added, all of them absent as the start values are:

        profile     below gradient_height above the ground the mean is mean_n (h / gradient_height)^profile_exponent
        layers      a table of winds by altitude, linear in between; two rows of one altitude are a step
        shear       while the input shear is set shear_n sets in over shear_time, and goes as it came
        gust        when the input gust is set a front is met; from there on, by the distance flown through the air,
                    gust_n (k(s / H) - k((s - H - c) / H)), k(x) = (1 - cos(pi x)) / 2, H = gust_gradient and
                    c = gust_plateau: the gust of CS-25.341 for c = 0, that of MIL-F-8785C for an endless one, the
                    step of a wake for a short H
        turbulence  of the Dryden form, MIL-F-8785C, along, across and down of the ground track, sampled exactly and
                    stationary from the first sample: above 2000 ft with turbulence_sigma and turbulence_length, below
                    1000 ft as wind_at_20_feet makes it, in between both

    An aircraft that is carried by gusts and weathercocks has them in the FMU aircraft; those are of the same form, and
    add up with the turbulence here.

    The wind is the velocity of the air over the ground: an air mass that moves north has a positive first component
    (in the aviation sense a wind *from* the south).
    """

    name = "wind"
    example = Example(
        {"turbulence_sigma": (1.0, 1.0, 1.0)},
        steps={"shear": True},
        duration=1800.0,
        text="Half an hour of wind, which wanders by 5 m/s (10 kn, 1 sigma) on each axis and forgets within some "
        "400 s, with turbulence of 1 m/s; at 360 s a shear sets in, and the wind to the north falls by 10 m/s (19 kn). "
        "Another `seed` gives another wind.",
    )

    altitude = Input(
        "m", start=1500.0, display_unit="ft", description="true height above the ellipsoid, for profile, layers, gusts"
    )
    velocity_n = Input(
        3,
        "m/s",
        display_unit="kn",
        description="true velocity over ground, north, east, down: travelling time, and the axes of the turbulence; "
        "0 leaves both as they are",
    )
    true_airspeed = Input(
        "m/s",
        start=46.3,
        min=0.0,
        display_unit="kn",
        description="speed at which gust and turbulence are met; thesis section 5.5.2: 90 kn",
    )
    shear = Input(kind="boolean", fault=True, description="fault F26: the wind changes by shear_n while this is set")
    gust = Input(kind="boolean", fault=True, description="fault F26: the front of a gust is met when this is set")

    mean_n = Parameter(
        3, "m/s", start=0.0, min=-100.0, max=100.0, display_unit="kn", description="mean wind, north, east, down"
    )
    sigma = Parameter(
        3,
        "m/s",
        start=(5.0, 5.0, 0.0),
        min=0.0,
        max=50.0,
        display_unit="kn",
        description="standard deviation of the random part, thesis (3.36), (3.37): 5 m/s north and east",
    )
    correlation_time = Parameter(
        "s", start=400.0, min=1.0, description="correlation time, thesis (3.36), (3.37): 400 s"
    )
    travelling_time_ratio = Parameter(
        "1",
        start=1.0,
        min=1.0,
        max=2.0,
        description="travelling time of thesis (3.35) per time: 1 (as the thesis's analyses take it) to 2 (in a "
        "climb); a factor on what velocity_n makes of it, where that is connected",
    )
    ground_altitude = Parameter(
        "m",
        start=0.0,
        min=-500.0,
        max=9000.0,
        display_unit="ft",
        description="height of the ground above the ellipsoid, for profile and turbulence",
    )
    profile_exponent = Parameter(
        "1",
        start=0.0,
        min=0.0,
        max=1.0,
        description="power of the mean wind's profile: 0 none, 1/6.5 over open country (ASCE 7, table 6-2, exposure C)",
    )
    gradient_height = Parameter(
        "m",
        start=274.0,
        min=1.0,
        max=5000.0,
        display_unit="ft",
        description="height above the ground from which on the mean wind is mean_n, 900 ft over open country",
    )
    layer_count = Parameter(
        kind="integer", start=0, min=0, max=LAYERS, description="how many rows the table of layers has"
    )
    layer_altitude = Parameter(
        LAYERS,
        "m",
        start=0.0,
        min=-500.0,
        max=30000.0,
        display_unit="ft",
        description="heights above the ellipsoid, which do not fall",
    )
    layer_wind_n = Parameter(
        (LAYERS, 3),
        "m/s",
        start=0.0,
        min=-150.0,
        max=150.0,
        display_unit="kn",
        description="winds at these heights, north, east, down; added to the mean",
    )
    shear_n = Parameter(
        3,
        "m/s",
        start=(-10.0, 0.0, 0.0),
        min=-100.0,
        max=100.0,
        display_unit="kn",
        description="change of the wind by the shear, north, east, down",
    )
    shear_time = Parameter("s", start=0.0, min=0.0, max=1e5, description="how long the change takes; 0: a step")
    gust_n = Parameter(
        3,
        "m/s",
        start=(0.0, 0.0, -10.0),
        min=-100.0,
        max=100.0,
        display_unit="kn",
        description="peak of the gust, north, east, down",
    )
    gust_gradient = Parameter(
        "m",
        start=107.0,
        min=0.1,
        max=1e4,
        display_unit="ft",
        description="distance from front to peak, H of CS-25.341: 9 to 107 m (30 to 350 ft)",
    )
    gust_plateau = Parameter("m", start=0.0, min=0.0, max=1e7, description="distance for which the gust is at its peak")
    turbulence_sigma = Parameter(
        3,
        "m/s",
        start=0.0,
        min=0.0,
        max=30.0,
        display_unit="kn",
        description="intensity above 2000 ft along, across and down, MIL-F-8785C: light 2.1, moderate 3, severe 7 m/s",
    )
    turbulence_length = Parameter(
        "m",
        start=turbulence.GUST_LENGTH,
        min=1.0,
        max=1e5,
        display_unit="ft",
        description="scale above 2000 ft, MIL-F-8785C: 1750 ft",
    )
    wind_at_20_feet = Parameter(
        "m/s",
        start=0.0,
        min=0.0,
        max=50.0,
        display_unit="kn",
        description="wind that makes the turbulence below 1000 ft, MIL-F-8785C: light 15, moderate 30, severe 45 kn",
    )
    sample_period = Parameter("s", start=0.1, min=1e-3, max=10.0, description="period at which the wind is advanced")

    wind_n = Output(3, "m/s", display_unit="kn", description="velocity of the air over the ground, north, east, down")

    variation = State(3, "m/s", description="random part")
    turbulence_levels = State((2, 3), "1", description="lags of the turbulence, models.air.turbulence")
    shear_level = State("1", description="how much of the shear is there")
    gust_met = State(kind="boolean", description="gust at the last sample")
    gust_distance = State("m", start=1e9, description="flown since the front of the last gust")

    @require("layer_altitude falls from one row to the next; expected heights that do not")
    def layers_are_in_order(self):
        used = np.arange(1, LAYERS) < self.layer_count
        return np.all((self.layer_altitude[1:] >= self.layer_altitude[:-1]) | ~used)

    @start
    def draw(self, noise):
        self.variation = gauss_markov.stationary(self.sigma, noise(3))
        self.turbulence_levels = turbulence.stationary(noise(6).reshape(2, 3))
        self._meet_gust(0.0)
        self.shear_level = np.where(self.shear, 1.0, 0.0)
        self._publish(self._turbulence()[0])

    @every("sample_period")
    def advance(self, noise):
        ratio = self.travelling_time_ratio * known(wind.travelling(self.velocity_n), 1.0)
        decay = gauss_markov.decay(ratio * self.period, self.correlation_time)
        self.variation = gauss_markov.advance(self.variation, decay, gauss_markov.drive(self.sigma, decay), noise(3))
        flown = known(self.true_airspeed * self.period, 0.0)
        sigma, length = self._turbulence()
        self.turbulence_levels = turbulence.advance(
            self.turbulence_levels, known(flown / length, 0.0), _normals(noise(5))
        )
        self._meet_gust(flown)
        self.shear_level = wind.ramped(self.shear_level, np.where(self.shear, 1.0, 0.0), self.period, self.shear_time)
        self._publish(sigma)

    def _turbulence(self):
        """Intensities and lengths of the turbulence here."""
        return turbulence.by_height(
            self.altitude - self.ground_altitude, self.wind_at_20_feet, self.turbulence_sigma, self.turbulence_length
        )

    def _meet_gust(self, flown):
        """The front of a gust lies where the input is set; an end of the input does not end the gust."""
        self.gust_distance = np.where(self.gust & ~self.gust_met, 0.0, self.gust_distance + flown)
        self.gust_met = self.gust

    def _publish(self, sigma):
        mean = self.mean_n * wind.near_ground(
            self.altitude - self.ground_altitude, self.gradient_height, self.profile_exponent
        )
        layer = wind.layered(self.altitude, self.layer_altitude, self.layer_wind_n, self.layer_count)
        event = self.shear_n * self.shear_level + self.gust_n * wind.gust(
            self.gust_distance, self.gust_gradient, self.gust_plateau
        )
        along, across, down = turbulence.gust(self.turbulence_levels, sigma)
        cosine, sine = wind.track(self.velocity_n)
        eddies = np.array([along * cosine - across * sine, along * sine + across * cosine, down])
        self.wind_n = mean + self.variation + (layer + event + eddies)


def _normals(n):
    """Five normal numbers for the two lags of three axes; along there is one lag."""
    return np.array([[n[0], n[1], n[2]], [0.0, n[3], n[4]]])
