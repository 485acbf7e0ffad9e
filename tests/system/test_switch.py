"""Seamless transitions (thesis section 2.3): GPS is lost for ten minutes and comes back, over seeds."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from models.navigation import phases
from navfmu.faults import Fault

LOST, FOUND = 300.0, 900.0
OUTAGE = Fault("outage", "gps.jammed", "input", start=LOST, duration=FOUND - LOST)
SEEDS = range(1, 21)
ERRORS = ("evaluation.north_error", "evaluation.east_error")
SIGMAS = ("navigator.north_sigma", "navigator.east_sigma")
COVARIANCE = tuple(f"navigator.position_covariance[{i}]" for i in (1, 2, 3))
UNAUGMENTED = Fault("unaugmented", "gps.waas_lost", "input", start=200.0, duration=200.0)
RARE = 1.0e-3
"""Of an honest filter, that a test fails."""


@pytest.fixture(scope="module")
def flights(load):
    """Every second of each seed: mode, guidance, errors (2), sigmas (2), covariance (3); shape (seeds, seconds, 9)."""
    record = ["navigator.mode", "navigator.guidance", *ERRORS, *SIGMAS, *COVARIANCE]
    asked = {"stop": FOUND + 10.0, "faults": [OUTAGE], "record": record, "record_period": 1.0}
    return np.array([load().run(seed=seed, **asked)[record].to_numpy(float) for seed in SEEDS])


def switches(flight):
    """Rows at which GPS was lost, and at which it was back."""
    coasting = flight[:, 0] == phases.COASTING
    first = int(np.argmax(coasting))
    return first, first + int(np.argmin(coasting[first:]))


def test_phases_and_guidance_follow_gps(flights):
    """As soon as the receiver says that it has no fix, and with the first that it has again."""
    for flight in flights:
        lost, found = switches(flight)
        assert LOST <= lost <= LOST + 1.0
        assert FOUND <= found <= FOUND + 2.0
        assert np.all(flight[5:lost, 1] == phases.PRECISION)
        assert np.all(flight[lost:found, 1] == phases.BACKUP)
        assert np.all(flight[found:, 1] == phases.PRECISION)


def test_the_solution_does_not_jump_when_gps_is_lost(flights):
    """Filters that hand over to each other differ by what the second one had wrong: its error changes by more than the
    sigma allows. Of 20 seeds and two axes an honest one is beyond its 3 sigma in 0.11 on average."""
    most = stats.binom.isf(RARE, 2 * len(flights), 2.0 * stats.norm.sf(3.0))
    beyond = 0
    for flight in flights:
        lost, _ = switches(flight)
        step = np.abs(flight[lost, 2:4] - flight[lost - 1, 2:4])
        beyond += np.sum(step > 3.0 * flight[lost, 4:6])
    assert beyond <= most


def test_the_solution_jumps_by_no_more_than_it_claims_when_gps_is_back(flights):
    """The first fix moves the solution by the error of ten minutes of coasting, whose squares by the filter's own
    covariance are a chi-square; a filter that claims too little while it coasts jumps further."""
    squares = []
    for flight in flights:
        _, found = switches(flight)
        jump = flight[found, 2:4] - flight[found - 1, 2:4]
        nn, ne, ee = flight[found - 1, 6:]
        squares.append(jump @ np.linalg.solve([[nn, ne], [ne, ee]], jump))
    assert np.sum(squares) < stats.chi2.isf(RARE, 2 * len(flights))


def test_two_seconds_after_its_return_the_solution_is_that_of_gps(flights):
    """A filter that believes its long coasted wind and biases more than a fix is drawn back by them. An honest one is
    beyond this once in 400 times of 20 seeds."""
    for flight in flights:
        _, found = switches(flight)
        assert np.hypot(*flight[found + 2, 2:4]) < 3.0 * np.hypot(*flight[found + 2, 4:6])


@pytest.fixture(scope="module")
def unaugmented(load):
    """Of signals with WAAS, which is lost from 200 to 400 s: mode, guidance, errors and sigmas of five seeds."""
    record = ["navigator.mode", "navigator.guidance", *ERRORS, *SIGMAS]
    asked = {"stop": 420.0, "faults": [UNAUGMENTED], "record": record, "record_period": 1.0}
    system = load("gps_signals")
    runs = [system.run(seed=seed, parameters={"gps.waas": True}, **asked) for seed in SEEDS[:5]]
    return np.array([run[record].to_numpy(float) for run in runs])


def test_loss_of_waas_alone_leaves_gps(unaugmented):
    """Corrections go on to be used for a time; then there is GPS alone, with its own sigma, and no backup."""
    for flight in unaugmented:
        alone = flight[:, 1] == phases.ALONE
        assert np.all(flight[5:, 0] == phases.CALIBRATING)
        assert np.all(flight[5:201, 1] == phases.PRECISION)
        assert np.all(alone[350:400])
        assert np.all(flight[405:, 1] == phases.PRECISION)
        assert np.all(flight[350:400, 4:] > 2.0 * flight[150:200, 4:])


def test_loss_and_return_of_waas_leave_no_step(unaugmented):
    """At the switches, to and fro, on two axes of five seeds: an honest filter is beyond its 3 sigma in 0.05 of 20.
    Between GPS alone and with WAAS lies what the ionosphere does to one and not to the other, which the sigma of
    GPS alone has to hold."""
    steps = []
    for flight in unaugmented:
        alone = np.flatnonzero(flight[:, 1] == phases.ALONE)
        for switch in (alone[0], alone[-1] + 1):
            step = np.abs(flight[switch, 2:4] - flight[switch - 1, 2:4])
            steps.append(step / np.max(flight[switch - 1 : switch + 1, 4:], axis=0))
    most = stats.binom.isf(RARE, 20, 2.0 * stats.norm.sf(3.0))
    assert np.sum(np.array(steps) > 3.0) <= most
