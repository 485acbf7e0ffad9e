"""The flow chart of thesis section 2.3: phases and guidance, and fixes at the time when they were valid."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from fmus.navigation.navigator import Navigator
from fmus.navigation.navigator_full import NavigatorFull
from fmus.navigation.navigator_reduced import NavigatorReduced
from models.navigation import phases
from tests.models.native import interpret

LATITUDE, LONGITUDE, ALTITUDE = np.radians(37.78), np.radians(-121.5), 1500.0
SPEED, TURN = 25.0, np.radians(14.0)
"""Of the smaller aircraft of the recorded flights in a steep turn: 6 m/s2 across."""
RADIUS_OF_EARTH = 6.38e6
LOST = 1.0e6
"""Protection level, m, that receivers tell where there is none."""


def chart(position, gps, augmented):
    """Fig 2.2 and the time line in words."""
    if not position:
        return phases.INITIALISING, phases.NO_GUIDANCE
    if not gps:
        return phases.COASTING, phases.BACKUP
    return phases.CALIBRATING, phases.PRECISION if augmented else phases.ALONE


@pytest.mark.parametrize("answers", list(itertools.product((False, True), repeat=3)))
def test_the_chart_is_that_of_the_thesis(answers):
    """A chart that asks for the augmentation first sends one to the backup that has GPS, which p. 23 forbids."""
    got = phases.outcome(phases.PHASES, answers[:2]), phases.outcome(phases.GUIDANCE, answers)
    assert (int(got[0]), int(got[1])) == chart(*answers)


class Turning:
    """The navigator in level turns with true sensors and no wind; what fixes say of themselves is given."""

    def __init__(self, late=0.0, told=True, kind=Navigator, **parameters):
        self.run, self.k, self.fixes = interpret(kind, **parameters), 0, 0
        self.late, self.told = late, told

    def truth(self, time):
        """Heading, rad, velocity and place, north and east: 60 s straight, then turns."""
        angle = TURN * max(time - 60.0, 0.0)
        place = np.array([min(time, 60.0) * SPEED, 0.0])
        place = place + SPEED / TURN * np.array([np.sin(angle), 1.0 - np.cos(angle)])
        return angle, SPEED * np.array([np.cos(angle), np.sin(angle)]), place

    def there(self, time):
        place = self.truth(time)[2] / (RADIUS_OF_EARTH + ALTITUDE)
        return LATITUDE + place[0], LONGITUDE + place[1] / np.cos(LATITUDE)

    def fly(self, seconds, fixes=True, sigma=0.0, protection=0.0):
        for _ in range(round(10 * seconds)):
            self.k += 1
            time = 0.1 * self.k
            heading = self.truth(time)[0]
            values = {"attitude.valid": True, "attitude.sequence": self.k, "attitude.time_of_validity": time}
            values |= {"attitude.heading": heading, "attitude.yaw_rate": TURN * (time > 60.0)}
            values |= {"air.valid": True, "air.sequence": self.k, "air.time_of_validity": time}
            values |= {"air.true_airspeed": SPEED, "air.pressure_altitude": ALTITUDE}
            values |= {"fix_error_sigma": sigma, "augmented_protection": protection}
            if fixes and self.k % 10 == 0:
                self.fixes += 1
                then = time - self.late
                latitude, longitude = self.there(then)
                north, east = self.truth(then)[1]
                values |= {"fix.valid": True, "fix.sequence": self.fixes, "fix.altitude": ALTITUDE}
                values |= {"fix.latitude": latitude, "fix.longitude": longitude, "fix.velocity_n": (north, east, 0.0)}
                values |= {"fix.time_of_validity": then if self.told else time}
            for name, value in values.items():
                self.run.set(name, value)
            self.run.do_step(time - 0.1, 0.1)
        return self

    def wrong(self):
        """Wind that there is not, m/s, and distance from the truth, m."""
        latitude, longitude = self.there(0.1 * self.k)
        north = (self.run.get("solution.latitude") - latitude) * RADIUS_OF_EARTH
        east = (self.run.get("solution.longitude") - longitude) * RADIUS_OF_EARTH * np.cos(LATITUDE)
        return np.hypot(*self.run.get("solution.wind_n")), np.hypot(north, east)

    def worst(self, seconds):
        return np.max([self.fly(1.0).wrong() for _ in range(round(seconds))], axis=0)

    def __getitem__(self, name):
        return self.run.get(name)


def test_without_augmentation_gps_goes_on_to_calibrate():
    """Loss of WAAS or LAAS alone is no loss of GPS: a chart that coasts then loses metres for kilometres."""
    flight = Turning().fly(30.0, sigma=1.0, protection=8.0)
    assert (flight["mode"], flight["guidance"]) == (phases.CALIBRATING, phases.PRECISION)
    before = flight["north_sigma"]
    flight.fly(60.0, sigma=8.0, protection=LOST)
    assert (flight["mode"], flight["guidance"]) == (phases.CALIBRATING, phases.ALONE)
    assert before < flight["north_sigma"] < 8.0
    flight.fly(30.0, sigma=1.0, protection=8.0)
    assert flight["guidance"] == phases.PRECISION


def test_what_a_fix_says_of_itself_is_its_weight():
    """Told 2.83 m it is that of 2 m each way, the bits of `fix_sigma`; told 20 m it counts a hundredth of that."""
    usual = Turning().fly(50.0)
    same = Turning().fly(50.0, sigma=2.0 * np.sqrt(2.0))
    coarse = Turning().fly(50.0, sigma=20.0)
    assert same["north_sigma"] == pytest.approx(usual["north_sigma"], rel=1e-12)
    assert coarse["north_sigma"] > 3.0 * usual["north_sigma"]


@pytest.mark.parametrize("sigma", [500.0, np.inf])
def test_a_fix_that_is_worse_than_the_backup_is_none(sigma):
    """If stand-alone accuracy is not sufficient the backup serves; what is no number tells no sigma."""
    flight = Turning().fly(30.0)
    before = flight["north_sigma"]
    flight.fly(10.0, sigma=sigma)
    if np.isfinite(sigma):
        assert (flight["mode"], flight["guidance"]) == (phases.COASTING, phases.BACKUP)
        assert flight["north_sigma"] > before
    else:
        assert flight["mode"] == phases.CALIBRATING
    assert (flight.fly(5.0)["mode"], flight["guidance"]) == (phases.CALIBRATING, phases.PRECISION)


@pytest.mark.parametrize("told", [True, False])
@pytest.mark.parametrize("kind", [Navigator, NavigatorFull, NavigatorReduced])
def test_late_fixes_are_those_of_their_time(kind, told):
    """0.38 s in a turn of 6 m/s2 are 2.3 m/s: compared with the velocity of now they are learned as wind that turns
    along. Whether the receiver tells the time or the parameter, the same comes of it."""
    flight = Turning(late=0.38, told=told, kind=kind, fix_delay=0.0 if told else 0.38).fly(70.0)
    wind, distance = flight.worst(60.0)
    assert wind < 0.05
    assert distance < 0.3


def test_fixes_whose_delay_is_not_known_are_learned_as_wind():
    """What the parameter is for: without it position lags by 0.38 s of 25 m/s, and there is a wind that is none."""
    flight = Turning(late=0.38, told=False).fly(70.0)
    wind, distance = flight.worst(60.0)
    assert wind > 0.5
    assert distance > 5.0


def test_with_a_delay_gps_is_not_lost_the_sooner():
    """Fixes that come every second and are 0.9 s old are not overdue by a timeout of 1.5 s."""
    flight = Turning(late=0.9, told=False, fix_delay=0.9, fix_timeout=1.5).fly(30.0)
    assert flight["mode"] == phases.CALIBRATING
    seen = {flight.fly(0.1)["mode"] for _ in range(30)}
    assert seen == {phases.CALIBRATING}
