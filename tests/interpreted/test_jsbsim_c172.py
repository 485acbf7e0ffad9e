"""JSBSim's Cessna as the truth: its outputs agree with one another and with the earth, and a shipped system flies it.

JSBSim integrates by Adams-Bashforth's method of two steps; the error of that method, from the outputs themselves, is
the bound for what is integrated here once more by other means (evidence.jsbsim).
"""

import importlib.util
import os
import shutil

import numpy as np
import pymap3d
import pytest
from scipy.spatial.transform import Rotation

from evidence.jsbsim import closure, wrapped
from fmus.motion.aircraft import Aircraft
from interpreted.jsbsim_c172 import JsbsimC172
from models.earth import earth
from models.motion.flight_plan import FlightPlan, straight, turn
from navfmu.constants import KNOT
from navfmu.errors import NavfmuError
from navfmu.export import needs
from navfmu.export.interpreter import Interpreter
from navfmu.export.twin import build_twin
from navfmu.faults import Fault
from navfmu.system.system import System
from system_ssp.backup_navigator.system import FMUS, source
from tests import built

pytestmark = pytest.mark.skipif(
    importlib.util.find_spec("jsbsim") is None and not os.environ.get("CI"),
    reason="the package jsbsim is not installed (pip install jsbsim)",
)

PERIOD = 0.01
STOP = 120.0
WIND = np.array([3.0, 6.0, 0.0])
SPEED = 90.0 * KNOT
PLAN = FlightPlan(
    np.radians(37.7),
    np.radians(179.99),
    1500.0,
    np.radians(70.0),
    SPEED,
    (
        straight(20.0, SPEED),
        turn(np.radians(120.0), np.radians(3.0), SPEED),
        straight(30.0, SPEED + 3.0, 1.5),
        straight(30.0, SPEED, 0.0),
    ),
)
"""To the east across the date line, a right turn to the south-west, a climb, level again."""
SIGNALS = (
    "latitude", "longitude", "altitude", "velocity_n", "roll", "pitch", "heading", "specific_force", "rate",
    "air_velocity_n", "true_airspeed", "angle_of_attack", "sideslip",
)  # fmt: skip


def begun(**values):
    flight = Interpreter(JsbsimC172)
    for name, value in {**PLAN.parameters(), "wind_n": WIND, **values}.items():
        flight.set(name, value)
    flight.setup()
    return flight


def test_speeds_of_the_plan_are_told_as_what_they_are():
    """The page called them speeds over ground, as they are in aircraft: in wind another flight."""
    for name in ("initial_speed", "segment_speed"):
        assert getattr(JsbsimC172, name).description.startswith("true airspeed")
        assert getattr(Aircraft, name).description.startswith("speed over ground")


@pytest.fixture(scope="module")
def flown():
    """Two minutes in a steady wind: arrays over 12001 samples, and what JSBSim itself says of position in e (m)."""
    flight = begun()
    fdm = flight.kept["flight"].fdm
    rows = {name: [flight.get(name)] for name in SIGNALS}
    ecef = [[fdm[f"position/ecef-{axis}-ft"] for axis in "xyz"]]
    for k in range(round(STOP / PERIOD)):
        flight.do_step(k * PERIOD, PERIOD)
        for name in SIGNALS:
            rows[name].append(flight.get(name))
        ecef.append([fdm[f"position/ecef-{axis}-ft"] for axis in "xyz"])
    return {name: np.array(values) for name, values in rows.items()} | {"ecef": 0.3048 * np.array(ecef)}


def test_latitude_longitude_and_altitude_are_those_of_the_ellipsoid(flown):
    """Catches geocentric latitude (20 km), heights over JSBSim's sea level (1 cm) and a foot of another length."""
    x, y, z = pymap3d.geodetic2ecef(flown["latitude"], flown["longitude"], flown["altitude"], deg=False)
    assert np.max(np.abs(np.column_stack([x, y, z]) - flown["ecef"])) < 1e-3


def test_the_flight_begins_where_the_plan_does_and_longitude_goes_on_across_the_date_line(flown):
    start = [flown[name][0] for name in ("latitude", "longitude", "altitude")]
    assert np.allclose(start, [PLAN.latitude, PLAN.longitude, PLAN.altitude], rtol=0, atol=1e-6)
    north, east, _ = flown["velocity_n"][0]
    assert abs(wrapped(np.arctan2(east, north) - PLAN.track)) < 1e-4  # the trim leaves a little slip
    assert np.max(flown["longitude"]) > np.pi
    assert np.max(np.abs(np.diff(flown["longitude"]))) < 1e-6
    assert np.max(np.abs(np.diff(flown["heading"]))) < 0.01


def test_velocity_is_the_derivative_of_position(flown):
    """Central differences are off by 1/6, the two-step method by 5/12 of the velocity's second difference.

    1e-4 m/s are for the start, which JSBSim rounds to a micrometre. Catches an interchange of n and b, knots, and a
    latitude that is not geodetic.
    """
    north_south, east_west = earth.radii(flown["latitude"])
    scale = (
        north_south + flown["altitude"],
        (east_west + flown["altitude"]) * np.cos(flown["latitude"]),
        -np.ones_like(north_south),
    )
    for axis, name in enumerate(("latitude", "longitude", "altitude")):
        rate = (flown[name][2:] - flown[name][:-2]) / (2.0 * PERIOD) * scale[axis][1:-1]
        second = np.max(np.abs(np.diff(flown["velocity_n"][:, axis], 2)))
        assert np.max(np.abs(rate - flown["velocity_n"][1:-1, axis])) < (1 / 6 + 5 / 12) * second + 1e-4, name


def test_force_and_rate_integrated_anew_return_the_flight(flown):
    """An independent navigator in inertial space, with normal gravity; what JSBSim's gravity has beside it is added.

    Catches a rate relative to the earth (0.009 rad in two minutes), force without the engine's, gravity in the force.
    """
    again = closure(flown, PERIOD)
    assert again.attitude < again.attitude_bound < 1e-5
    assert np.all(np.abs(again.position) < again.position_bound[:, None])
    assert again.position_bound[-1] < 0.5


def test_air_flows_as_the_wind_blows(flown):
    """Catches a wind of the other sign (twice 6.7 m/s), and angles of another axis."""
    assert np.allclose(flown["air_velocity_n"], WIND, rtol=0, atol=1e-9)
    angles = np.column_stack([flown["heading"], flown["pitch"], flown["roll"]])
    u, v, w = Rotation.from_euler("ZYX", angles).inv().apply(flown["velocity_n"] - WIND).T
    assert np.allclose(flown["true_airspeed"], np.sqrt(u * u + v * v + w * w), rtol=0, atol=1e-6)
    assert np.allclose(flown["angle_of_attack"], np.arctan2(w, u), rtol=0, atol=1e-8)
    assert np.allclose(flown["sideslip"], np.arcsin(v / flown["true_airspeed"]), rtol=0, atol=1e-8)


def test_the_flight_begins_in_balance(flown):
    """Of the first second: catches a trim for another wind, which leaves 1 m/s2, and an engine that has to spool up."""
    force = flown["specific_force"][: round(1.0 / PERIOD)]
    assert np.max(np.abs(force - force[0])) < 0.005
    assert np.max(np.abs(flown["rate"][: len(force)])) < 1e-3
    assert abs(flown["roll"][0]) < 0.02


def test_the_autopilot_flies_the_plan(flown):
    """At the end of each part; a control of the wrong sign is a crash before the first. Airspeed is held, not speed."""
    for end, track, altitude, speed in ((20, 70, 1500, 0), (80, 190, 1526, 3), (120, 190, 1545, 0)):
        k = round(end / PERIOD)
        north, east, _ = flown["velocity_n"][k]
        assert abs(wrapped(np.arctan2(east, north) - np.radians(track))) < np.radians(2.0), end
        assert abs(flown["altitude"][k] - altitude) < 3.0, end
        assert abs(flown["true_airspeed"][k] - SPEED - speed) < 1.0, end
    assert np.max(np.abs(flown["sideslip"])) < np.radians(2.0)
    assert np.degrees(np.max(flown["roll"])) == pytest.approx(np.degrees(np.arctan(SPEED * np.radians(3) / 9.8)), abs=5)


@pytest.mark.parametrize("speed", [30.0, 60.0])
@pytest.mark.parametrize("altitude", [100.0, 4000.0])
def test_it_flies_at_the_corners_of_what_it_takes(speed, altitude):
    """Straight, a turn at 2 deg/s, straight: catches gains that swing at low or high speed, and an engine too weak."""
    plan = FlightPlan(
        0.65, -2.0, altitude, 1.0, speed,
        (straight(20.0, speed), turn(np.radians(60.0), np.radians(2.0), speed), straight(40.0, speed)),
    )  # fmt: skip
    flight = begun(**plan.parameters())
    for k in range(90):
        flight.do_step(float(k), 1.0)
    north, east, _ = flight.get("velocity_n")
    assert abs(wrapped(np.arctan2(east, north) - 1.0 - np.radians(60.0))) < np.radians(2.0)
    assert abs(flight.get("altitude") - altitude) < 3.0
    assert abs(flight.get("true_airspeed") - speed) < 1.0
    assert abs(flight.get("roll")) < np.radians(2.0)


def test_the_flight_is_the_same_at_every_communication_step_and_after_a_reset():
    flights = []
    for step in (0.01, 0.05, 0.25):
        flight = begun()
        for k in range(round(5.0 / step)):
            flight.do_step(k * step, step)
        flights.append([np.ravel(flight.get(name)).tolist() for name in SIGNALS])
        flight.reset()
        flight.set("initial_speed", SPEED)
        flight.setup()
        flight.do_step(0.0, 0.01)
    assert flights[0] == flights[1] == flights[2]


@pytest.mark.parametrize(
    ("values", "told"),
    [
        ({"initial_speed": 20.0, "segment_speed": np.full(24, 20.0)}, "30 m/s to 60 m/s"),
        ({"initial_altitude": 9000.0}, "initial_altitude 9000 m is not one of a Cessna 172: 0 m to 4000 m"),
        ({"segment_duration": np.zeros(24)}, "the flight plan has a gap"),
    ],
)
def test_what_a_cessna_does_not_fly_is_refused(values, told):
    with pytest.raises(NavfmuError, match=told):
        begun(**values)


def test_its_state_is_not_pretended_to_be_saved():
    flight = begun()
    with pytest.raises(NavfmuError, match="cannot save or restore its state: part of it is in jsbsim"):
        flight.get_state()


def test_a_missing_package_is_a_sentence(monkeypatch):
    monkeypatch.setattr(needs.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(NavfmuError, match=r"'jsbsim_c172' needs the Python package jsbsim, .* pip install jsbsim"):
        needs.require(JsbsimC172)


@pytest.fixture(scope="module")
def system(tmp_path_factory):
    """The shipped system, in which nothing is changed but the file of the aircraft."""
    folder = tmp_path_factory.mktemp("with_jsbsim")
    for name in FMUS:
        shutil.copy(built.fmu(name, tmp_path_factory), folder)
    build_twin(JsbsimC172, folder, pictures=False).replace(folder / "aircraft.fmu")
    return System.load(source(folder).pack(folder / "flown.ssp"))


@pytest.mark.slow
def test_a_shipped_system_flies_on_it(system):
    """Five minutes, four of them without GPS: both errors within four of the filter's own sigmas at every second.

    Errors live for minutes, so that four minutes hold few independent ones: of two axes and ten each beyond four sigma
    with a probability of 6e-5, one in a thousand flights. The aircraft turns by 360 degrees meanwhile.
    """
    faults = [Fault("gps", "gps.jammed", "input", value=True, start=60.0)]
    flight = system.run(stop=300.0, seed=1, faults=faults, record=["aircraft", "evaluation", "navigator"],
                        record_period=1.0)  # fmt: skip
    for axis in ("north", "east"):
        ratio = flight[f"evaluation.{axis}_error"] / flight[f"navigator.{axis}_sigma"]
        assert np.max(np.abs(ratio.iloc[60:])) < 4.0
        assert flight[f"navigator.{axis}_sigma"].max() > 20.0  # m: GPS is lost
    assert np.ptp(flight["aircraft.heading"]) > 5.0
