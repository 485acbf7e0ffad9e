"""The backup navigator with GPS as positions and as signals: it coasts where a transmitter on its way jams them."""

from __future__ import annotations

import numpy as np
import pymap3d
import pytest
from scipy.spatial.transform import Rotation

from navfmu import System
from navfmu.faults import Fault
from system_ssp.backup_navigator.system import source
from tests import built

LEVELS = {"positions": None, "signals": "gps_signals"}
"""Variants by how GPS is modelled."""
REGION = (37.70, -121.62, 0.0)
"""A place on the way to Livermore, deg, that the aircraft passes over after 28 minutes, and its radius, m."""
RADIUS = 6000.0
HILL = (37.665, -121.53, 1100.0)
"""A place 5 km beside that way, deg and m, 300 m below it, and its power, W, from a time on at which circles end, in
which a low wing turns the antenna to it."""
POWER, ON = 0.5, 1400.0
LEAST, ENOUGH, NEEDED = 25.0, 27.0, 20.0
"""C/N0 at which signals are lost and found, dB-Hz, and how long it must be enough, s."""
CLOSE = 0.1
"""dB that two budgets may differ by: the wings roll by a tenth of a degree from one step to the next."""
LATE = 5.0
"""Of the navigator, s: a fix is overdue after 3 s, the solver looks for signals ten times a second."""
FAULTS = {
    "region": Fault("region", "gps.region_radius", "input", start=0.0, value=RADIUS),
    "jammer": Fault("jammer", "gps.jammer_power[1]", "input", start=ON, value=POWER),
}
PARAMETERS = {
    **{"gps.region_latitude": np.radians(REGION[0]), "gps.region_longitude": np.radians(REGION[1])},
    **{"gps.jammer_latitude[1]": np.radians(HILL[0]), "gps.jammer_longitude[1]": np.radians(HILL[1])},
    "gps.jammer_altitude[1]": HILL[2],
    **{"gps.acquisition_threshold": ENOUGH, "gps.acquisition_time": NEEDED},
}
FLOWN = ("navigator.mode", "evaluation.horizontal_error", "evaluation.consistent")
TRUTH = tuple(f"aircraft.{name}" for name in ("latitude", "longitude", "altitude", "roll", "pitch", "heading"))
SEEDS = (1, 2, 3)


@pytest.fixture(scope="module")
def fly(load):
    """``fly(level, seed, fault)``: time, FLOWN and TRUTH at each second."""
    done = {}

    def get(level, seed, fault):
        key = level, seed, fault
        if key not in done:
            run = load(LEVELS[level]).run(
                seed=seed, faults=[FAULTS[fault]], parameters=PARAMETERS, record=[*FLOWN, *TRUTH], record_period=1.0
            )
            done[key] = run.index.to_numpy(), *(run[name].to_numpy(float) for name in (*FLOWN, *TRUTH))
        return done[key]

    return get


def coasted(time, mode):
    """When GPS was lost for the first time, and found for good, s."""
    without = time[(mode == 2) & (time > 10.0)]
    return without[0], without[-1] + 1.0


def strength(latitude, longitude, altitude, roll, pitch, heading):
    """C/N0, dB-Hz, of signals that have 42.5 dB-Hz alone, and the distance of the jammer, m.

    1 / (C/N0) is that of the signal and J / (S R_c). The antenna has -5 dB along the plane of the wings, 3 dB upwards
    and 1 dB a degree less below, as far as 30.
    """
    hill = *np.radians(HILL[:2]), HILL[2]
    line_n = -np.stack(pymap3d.geodetic2ned(latitude, longitude, altitude, *hill, deg=False), axis=1)
    distance = np.linalg.norm(line_n, axis=1)
    line_b = Rotation.from_euler("ZYX", np.stack([heading, pitch, roll], axis=1)).inv().apply(line_n)
    up = np.arcsin(-line_b[:, 2] / distance)
    gain = np.where(up > 0.0, -5.0 + 8.0 * np.sin(up), -5.0 + np.maximum(np.degrees(up), -30.0))
    jammer = POWER * (0.190294 / (4.0 * np.pi * distance)) ** 2 * 10.0 ** (gain / 10.0)
    signal = 10.0 ** ((42.5 - 201.5) / 10.0)
    return -10.0 * np.log10(10.0**-4.25 + jammer / (signal * 1.023e6)), distance


def switched(time, received, of):
    """When signals are lost, and when they are found for good, s, if all comes late by ``of`` dB."""
    weak = time[received < LEAST - of]
    enough = np.convolve(received >= ENOUGH + of, np.ones(int(NEEDED)), "valid") > NEEDED - 0.5
    begins = time[: len(enough)]
    return weak[0], begins[enough & (begins > time[received < LEAST + of][-1])][0] + NEEDED


@pytest.mark.parametrize("level", LEVELS)
def test_it_coasts_in_a_region_and_not_outside_of_it(fly, level):
    """F34: lost when the aircraft comes in, found when it has been outside for the time that it takes."""
    time, mode, _, _, latitude, longitude, *_ = fly(level, 1, "region")
    middle = np.radians(REGION[:2])
    inside = time[np.hypot(*pymap3d.geodetic2ned(latitude, longitude, 0.0, *middle, 0.0, deg=False)[:2]) < RADIUS]
    began, ended = coasted(time, mode)
    assert inside[0] <= began <= inside[0] + LATE
    assert inside[-1] + NEEDED <= ended <= inside[-1] + NEEDED + LATE


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("level, share", [("positions", 0.0), ("signals", 0.45)])
def test_a_jammer_takes_gps_from_the_distance_on_that_the_link_budget_says(fly, level, share, seed):
    """F34. As positions at the second that the budget says; as signals at a distance that depends on the satellites of
    the hour, which scatters by 15 %. Without the attitude of the antenna, or with the power of two jammers, a bank or
    half a distance would lie between."""
    time, mode, _, _, *truth = fly(level, seed, "jammer")
    received, distance = strength(*truth)
    began, ended = coasted(time, mode)
    on = time >= ON
    (lost, found), (lost_late, found_late) = (switched(time[on], received[on], of) for of in (-CLOSE, CLOSE))
    if share:
        assert distance[time == began] == pytest.approx(distance[time == lost], rel=share)
        assert distance[time == ended] == pytest.approx(distance[time == found_late], rel=share)
    else:
        assert lost <= began <= lost_late + LATE
        assert found - 1.0 <= ended <= found_late + LATE
    assert 60.0 < ended - began < 400.0


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("fault", FAULTS)
def test_the_requirement_holds_with_either(fly, level, fault):
    """Within half a nautical mile while it coasts, and within what it says; a few metres before and afterwards."""
    coasting, consistent = [], []
    for seed in SEEDS:
        time, mode, error, inside, *_ = fly(level, seed, fault)
        began, ended = coasted(time, mode)
        without = (time >= began) & (time < ended)
        coasting.append(error[without])
        consistent.append(inside[without])
        assert np.max(error[(time > 10.0) & (time < min(began, ON))]) < 12.0  # then some are lost
        assert np.max(error[time > ended + 30.0]) < 20.0
    coasting = np.concatenate(coasting)
    assert np.percentile(coasting, 95) < 926.0 and np.max(coasting) > 30.0
    assert np.mean(np.concatenate(consistent)) >= 0.95


def test_three_antennas_make_heading_as_good_as_they_are_and_are_lost_with_gps(load):
    """Thesis section 4.11.1 and p. 101: 0.25 degrees at 2 Hz and better behind the gyros, until GPS is lost; then the
    heading grows to that of the magnetometer, and its sigma with it. Without them it is that of the magnetometer."""
    lost = Fault("lost", "gps.jammed", "input", start=300.0)
    errors, sigmas = {}, {}
    for variant in (None, "three_antennas"):
        names = ("ahrs.attitude.heading", "aircraft.heading", "ahrs.attitude.heading_sigma")
        runs = [load(variant).run(stop=900.0, seed=s, faults=[lost], record=names, record_period=1.0) for s in SEEDS]
        told, true, sigma = (np.array([run[name].to_numpy() for run in runs]) for name in names)
        errors[variant] = np.degrees((told - true + np.pi) % (2.0 * np.pi) - np.pi)
        sigmas[variant] = np.degrees(sigma)
    with_gps, after = slice(60, 300), slice(600, 900)
    rms = {key: np.sqrt(np.mean(error[:, with_gps] ** 2)) for key, error in errors.items()}
    assert rms["three_antennas"] < 0.25 < 0.5 < rms[None]
    assert np.mean(sigmas["three_antennas"][:, with_gps]) < 0.25
    for error, sigma in zip(errors.values(), sigmas.values(), strict=True):
        assert np.mean(np.abs(error[:, 60:]) < 3.0 * sigma[:, 60:]) > 0.95
        assert 0.5 < np.mean(sigma[:, after]) < 2.5


def test_antennas_that_hear_satellites_take_the_place_of_those_that_do_not(fmus, tmp_path_factory):
    """Both levels of GPS have the same bundles: attitude of signals calibrates heading and is lost with them."""
    built.fmu("gps_attitude", tmp_path_factory)
    both = source(fmus)
    both.variant(
        "both",
        components={"gps": "gps_signals.fmu", "gps_solver": "gps_solver.fmu", "antennas": "gps_attitude.fmu"},
        connections={
            **{"gps_solver.signals": "gps.signals", "navigator.fix": "gps_solver.fix"},
            **{"antennas.signals": "gps.signals", "ahrs.gps": "antennas.attitude"},
            **{f"antennas.{signal.partition('.')[2]}": signal for signal in TRUTH},
        },
    )
    system = System.load(both.pack(tmp_path_factory.mktemp("both") / "both.ssp", variant="both"))
    lost = Fault("lost", "gps.jammed", "input", start=200.0)
    names = ("ahrs.attitude.heading", "aircraft.heading", "ahrs.attitude.heading_sigma", "antennas.attitude.valid")
    run = system.run(stop=400.0, seed=1, faults=[lost], record=names, record_period=1.0)
    told, true, sigma, valid = (run[name].to_numpy(float) for name in names)
    error = np.degrees((told - true + np.pi) % (2.0 * np.pi) - np.pi)
    assert np.all(valid[5:200]) and not np.any(valid[203:])
    assert np.sqrt(np.mean(error[60:200] ** 2)) < 0.25
    assert np.degrees(sigma[199]) < 0.25 < np.degrees(sigma[210]) < np.degrees(sigma[399])
