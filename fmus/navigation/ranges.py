"""Ranges to DME stations, as the filters of the thesis take them."""

from __future__ import annotations

import numpy as np

from fmus.navigation.thesis import Thesis
from models.filters import kalman
from models.navigation import navigator
from models.radio import dme
from navfmu.export import on_new


class Ranges(Thesis):
    """Sequential updates by slant ranges, one station after the other, (6.32)-(6.42).

    A navigator says ``range_rows(north, east, up)``, what ranges tell of the states, ``range_biases()`` (m), and
    ``range_variance(since)`` (m2), of a range that comes ``since`` s after the last one of its station.

    *Recovery.* A range is refused by the gate. What is refused twice in a row widens position by what its variance
    lacks of the innovation's square, as far as it is news, unless more stations, whose lines cross well, agree with the
    position: so a filter that is wrong comes back, and one wild range does nothing.
    """

    @on_new("ranging")
    def take_ranges(self):
        moment = self.ranging.time_of_validity
        latitude, longitude = navigator.advance(
            self.latitude, self.longitude, self.height(), self.velocity, moment - self.time
        )
        sight = dme.line_of_sight(
            latitude, longitude, self.height(), self.station_latitude, self.station_longitude, self.station_altitude
        )
        north, east, distance = navigator.direction_cosines(latitude, longitude, sight)
        up = navigator.vertical_cosine(latitude, longitude, sight)
        wanted = self.wants_ranges()
        measured = self.ranges_there() & wanted
        expected = distance + self.range_biases()

        heard = np.maximum(self.range_time, self.refused_time)
        news = navigator.news(moment - heard, self.bias_time())
        curvature = navigator.curvature(self.upper, north, east, distance)
        lasting = navigator.lasting(curvature, np.maximum(moment - self.range_time, 1.0e-3), self.wind_time)
        correction, upper, taken, innovations, spreads = kalman.updates(
            np.zeros(kalman.order(self.upper)),
            self.upper,
            self.range_rows(north, east, up),
            self.range_variance(np.maximum(moment - heard, 1.0e-3)) + curvature + lasting,
            np.where(measured, self.ranging.slant_range - expected, 0.0),
            measured,
            self.innovation_gate,
        )
        self.correct(correction)
        self.judge(measured, taken, innovations, spreads)

        refused = measured & np.logical_not(taken)
        again = refused & (self.refused_time > np.maximum(self.range_time, self.fix_time))
        self.rejected = self.rejected + np.sum(np.where(refused, 1.0, 0.0))
        self.used = self.used + np.sum(np.where(taken, 1.0, 0.0))
        self.range_time = np.where(taken, moment, self.range_time)
        self.refused_time = np.where(refused, moment, self.refused_time)
        used = self.used_lately(moment)
        recent = moment - self.refused_time <= self.geometry_window
        against = recent & (self.refused_time > np.maximum(self.range_time, self.fix_time))
        believed = used & np.logical_not(against)
        self.hdop = np.where(wanted, dme.dilution(north, east, used), self.hdop)
        outvoted = navigator.outvoted(against, believed, dme.dilution(north, east, believed), self.dilution_limit)
        lacking = np.maximum(innovations**2 - navigator.variance_along(upper, north, east), 0.0)
        lacking = np.where(again & np.logical_not(outvoted), news * lacking, 0.0)
        self.upper = navigator.widen(upper, np.max(lacking))

    def bias_time(self):
        """Correlation time of the biases of ranges, s, (3.38)."""
        speed = np.sqrt(np.sum(self.velocity * self.velocity))
        return self.correlation_distance / np.maximum(speed, 1.0)
