"""A filter with the states (5.11): altitude, wind, heading and airspeed behind position."""

from __future__ import annotations

import numpy as np

from fmus.navigation.thesis import Thesis
from models.navigation import reckoning
from models.processes.known import known
from navfmu.export import Parameter

AT_ONCE = 1.0e-6
"""Correlation time of an error that has nothing to do with that of before, s."""
SLOW = 1.0
"""Speed and error of a speed below which neither says how an error grows, m/s."""
MEANING = "position north and east, altitude (m), wind north and east (m/s), heading (rad), airspeed (m/s)"


class SevenStates(Thesis):
    """How errors of altitude, wind, heading and airspeed go on, and what they do."""

    height_sigma = Parameter(
        "m",
        start=23.0,
        min=0.0,
        description="standard deviation of the altimeter's error about that of the first fix (thesis Table 5.1)",
    )
    height_time = Parameter("s", start=400.0, min=1.0, description="correlation time of this (thesis Table 5.1)")
    heading_noise = Parameter(
        "1",
        start=np.radians(0.8),
        min=0.0,
        description="wide-band noise of heading, rad in one second's mean (thesis Table 5.1: 0.8 deg; (3.86): at 1 Hz)",
    )

    def over_ground(self, errors):
        """Velocity, m/s."""
        return reckoning.velocity(errors, self.airspeed, self.nose, self.wind_mean)

    def velocity_rows(self, errors):
        """Its derivatives by altitude, wind, heading and airspeed."""
        return reckoning.velocity_rows(errors, self.airspeed, self.nose, self.wind_mean)

    def fix_rows(self, rows):
        """What a fix tells of the states."""
        return reckoning.fix_rows(len(self.errors) + 2, rows)

    def height(self):
        """Altitude, m."""
        return self.altitude + self.errors[reckoning.HEIGHT]

    def wind_error(self):
        """What is to be added to the forecast of the wind, m/s."""
        return self.errors[reckoning.WIND]

    def first_sigmas(self):
        """The altitude is that of the fix (Table 7.1, P33); the others are what nothing has measured."""
        return np.concatenate([self.altitude_sigma[None], self.modelled[1:]])

    def learn_altitude(self, good, first):
        """The altimeter is set by the first fix; the filter has what it is wrong by afterwards."""
        super().learn_altitude(first, first)

    def shaken(self, upper, step):
        """With the wide-band noise of heading."""
        return reckoning.wide_band(upper, self.airspeed, self.nose, self.heading_noise**2, step)

    def error_model(self, speed, seen):
        """Sigma and correlation time of each error. Without heading or airspeed (``seen``) the aircraft may turn
        anywhere, and what was learned of them is of no use when they are there again."""
        blind = self.top_speed()
        told_heading, told_airspeed = (
            np.maximum(known(sigma, 0.0), 0.0) for sigma in (self.attitude.heading_sigma, self.air.true_airspeed_sigma)
        )
        heading = np.where(seen, told_heading, blind / np.maximum(self.airspeed, SLOW))
        airspeed = np.where(seen, told_airspeed, blind)
        own = np.where(self.had_seen, np.stack([self.heading_time, self.airspeed_time]), AT_ONCE)
        sigmas = np.concatenate([self.height_sigma[None], self.wind_sigma * np.ones(2), heading[None], airspeed[None]])
        times = np.concatenate(
            [self.height_time[None], self.wind_time * np.ones(2), np.where(seen, own, self.blind_time)]
        )
        return sigmas, times

    def rescaled(self, sigmas, seen):
        """What is wrong with the airspeed goes with its sigma; it is the same error at another speed."""
        at = reckoning.AIRSPEED
        grown = np.maximum(sigmas[at], SLOW) / np.maximum(self.modelled[at], SLOW)
        one = np.eye(len(self.errors))[at]
        return 1.0 + one * np.where(seen & self.had_seen, grown - 1.0, 0.0)
