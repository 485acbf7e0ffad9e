"""The FMU ``evaluation``: truth against the navigator's solution."""

from __future__ import annotations

import numpy as np

from fmus import examples
from models.evaluation import evaluation
from navfmu.export import Bundle, Component, Example, Input, Output, Parameter, State, every


class Evaluation(Component):
    """Compares a navigation solution with the truth: position errors, and whether they are what the filter says.

    Errors are estimate minus truth of the same moment, as a pilot would see them: a solution that arrives late is
    wrong by the way flown since. `consistent` says that north and east error are both within three of the filter's own
    standard deviations. Everything that counts or accumulates does so while the navigator coasts without GPS (`mode`
    2), every `update_period`; `limit` is the requirement of 0.5 nmi (thesis section 1.4, 7.3).
    """

    example = Example(
        text="A solution drifts to the north, faster and faster, once GPS is lost at 60 s (dotted), while its filter "
        "claims a sigma that grows evenly. First the error leaves three sigma (`consistent` falls to 0 and its share "
        "goes down), then it passes 926 m and `exceeded_share` rises. Shares and the maximum count the coasting time.",
        duration=600.0,
        step=1.0,
        mark=60.0,
        inputs=examples.evaluation_inputs,
        shows=(
            "north_error",
            "horizontal_error",
            "consistent",
            "consistent_share",
            "exceeded_share",
            "maximum_error",
            "coasting_time",
            "normalised_error",
        ),
    )

    latitude = Input("rad", display_unit="deg", description="true geodetic latitude")
    longitude = Input("rad", display_unit="deg", description="true longitude")
    altitude = Input("m", display_unit="ft", description="true height above the ellipsoid, positive up")
    solution = Bundle(
        latitude=Input("rad", display_unit="deg", description="estimated geodetic latitude"),
        longitude=Input("rad", display_unit="deg", description="estimated longitude"),
        altitude=Input("m", display_unit="ft", description="estimated height above the ellipsoid"),
        description="navigation solution",
    )
    north_sigma = Input("m", description="the filter's standard deviation of north position")
    east_sigma = Input("m", description="the filter's standard deviation of east position")
    mode = Input(kind="integer", description="the navigator's mode: 0 initialising, 1 calibrating, 2 coasting")

    update_period = Parameter("s", start=1.0, min=0.001, max=60.0, description="period of the comparison")
    limit = Parameter(
        "m",
        start=evaluation.HALF_NAUTICAL_MILE,
        min=0.0,
        display_unit="nmi",
        description="required horizontal accuracy, 0.5 nmi (thesis section 7.3)",
    )

    north_error = Output("m", description="estimated minus true north position")
    east_error = Output("m", description="estimated minus true east position")
    altitude_error = Output("m", description="estimated minus true altitude")
    horizontal_error = Output("m", description="horizontal distance of the estimate from the truth")
    consistent = Output(kind="boolean", description="north and east error are within three standard deviations")
    coasting_time = Output("s", description="time spent coasting since the start")
    consistent_share = Output("1", min=0.0, max=1.0, description="share of the coasting time that was consistent")
    exceeded_share = Output(
        "1", min=0.0, max=1.0, description="share of the coasting time with an error above the limit"
    )
    maximum_error = Output("m", description="largest horizontal error while coasting")
    normalised_error = Output(
        "1", description="mean while coasting of (north error/sigma)^2 + (east error/sigma)^2; 2 for an honest filter"
    )
    consistent_time = State("s", description="time coasting and consistent")
    exceeded_time = State("s", description="time coasting with an error above the limit")
    squares = State("1", description="sum of normalised squared errors while coasting")

    @every("update_period")
    def compare(self):
        known = self.solution.valid
        north, east = evaluation.position_error(
            self.latitude, self.longitude, self.altitude, self.solution.latitude, self.solution.longitude
        )
        horizontal = np.sqrt(north * north + east * east)
        consistent = np.logical_and(known, evaluation.consistent(north, east, self.north_sigma, self.east_sigma))
        coasting = np.logical_and(known, self.mode == 2)
        step = np.where(coasting, self.period, 0.0)
        self.north_error = np.where(known, north, 0.0)
        self.east_error = np.where(known, east, 0.0)
        self.altitude_error = np.where(known, self.solution.altitude - self.altitude, 0.0)
        self.horizontal_error = np.where(known, horizontal, 0.0)
        self.consistent = consistent
        self.coasting_time = self.coasting_time + step
        self.consistent_time = self.consistent_time + np.where(consistent, step, 0.0)
        self.exceeded_time = self.exceeded_time + np.where(horizontal > self.limit, step, 0.0)
        spent = np.where(self.coasting_time > 0.0, self.coasting_time, 1.0)
        self.consistent_share = self.consistent_time / spent
        self.exceeded_share = self.exceeded_time / spent
        self.maximum_error = np.where(coasting, np.maximum(self.maximum_error, horizontal), self.maximum_error)
        normalised = evaluation.normalised_square(north, east, self.north_sigma, self.east_sigma)
        self.squares = self.squares + np.where(coasting, normalised * self.period, 0.0)
        self.normalised_error = self.squares / spent
