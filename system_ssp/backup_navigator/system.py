"""The thesis's backup navigator as a system: ten components, their connections, parameter sets and variants.

Thesis chapter 2 (Fig 2.5) and section 6.5 (Fig 6.5): a low-cost heading reference, airspeed and the ranges to a few DME
stations carry the aircraft through a GPS outage. Every variant is written from the calls below, none by hand.
"""

from __future__ import annotations

from pathlib import Path

from fmus.grades import GRADES, ahrs_parameters
from fmus.motion.flight_plans import FLIGHT_PLANS
from fmus.radio.grades import DME
from fmus.radio.stations import STATION_SETS
from navfmu.ssp.writer import SystemSource

HERE = Path(__file__).parent
COMPONENTS = (
    "wind",
    "aircraft",
    "imu",
    "magnetometer",
    "air_data",
    "dme",
    "gps",
    "ahrs",
    "navigator",
    "evaluation",
)
RECEIVERS = {"two_receivers": 2, "scanning": 3}
"""Variants by the mode of ``dme``; the base system has mode 1, one receiver that takes the stations in turn."""
BASE_GRADE = "automotive"
ATTITUDES: dict[str, dict] = {
    "ahrs_euler": {"compensated": True},
    "ahrs_quaternion": {"compensated": True},
    "ahrs_velocity": {},
    "ahrs_vectors": {},
}
"""Variants with another FMU in the place of ``ahrs``, and what its parameters are beside those of ``ahrs``: the filters
of the thesis take the acceleration that the airspeed shows out of the specific force, and have no gates."""
NAVIGATORS: dict[str, dict[str, str]] = {
    "navigator_reckoning": {},
    "navigator_full": {},
    "navigator_reduced": {},
    "navigator_inertial": {"navigator.imu": "imu.reading"},
}
"""Variants with another FMU in the place of ``navigator``, and what it is connected to beside that."""
FMUS = (*COMPONENTS, "gps_signals", "gps_solver", *ATTITUDES, *NAVIGATORS)
"""Those of all variants."""
POSITION = ("latitude", "longitude", "altitude")
ANGLES = ("roll", "pitch", "heading")


def source(fmus: str | Path, *, aircraft: str = "aircraft.fmu", name: str = "backup_navigator") -> SystemSource:
    """Describe the system with the built FMUs in the folder ``fmus``.

    ``aircraft`` may be any FMU with the outputs of ``aircraft``, for example a recorded track.
    """
    system = SystemSource(
        name,
        fmus=fmus,
        description="DME-aided dead reckoning that carries an aircraft through a GPS outage; one DME receiver",
        stop_time=2100.0,
        step=0.01,
    )
    for component in COMPONENTS:
        system.component(component, aircraft if component == "aircraft" else f"{component}.fmu")
    connect(system)
    if aircraft == "aircraft.fmu":
        system.parameters("aircraft", FLIGHT_PLANS["livermore"].parameters())
    use_stations(system.parameters, "thesis_like")
    system.parameters("imu", GRADES[BASE_GRADE], name=f"imu_{BASE_GRADE}")
    system.parameters("ahrs", ahrs_parameters(BASE_GRADE), name=f"ahrs_{BASE_GRADE}")
    add_variants(system)
    for file in sorted((HERE / "faults").glob("*.toml")):
        system.attach(f"faults/{file.name}", file)
    system.attach("report.toml", HERE / "report.toml")
    return system


def connect(system: SystemSource) -> None:
    """Wire truth to sensors, sensors to estimators, and both ends to the evaluation."""
    for sensor in ("magnetometer", "dme", "gps", "evaluation"):
        for output in POSITION:
            system.connect(f"aircraft.{output}", f"{sensor}.{output}")
    for sensor in ("magnetometer", "gps"):
        for output in ANGLES:
            system.connect(f"aircraft.{output}", f"{sensor}.{output}")
    for sensor in ("air_data", "dme", "gps"):
        system.connect("aircraft.velocity_n", f"{sensor}.velocity_n")
    system.connect("aircraft.altitude", "air_data.altitude")
    system.connect("aircraft.specific_force", "imu.specific_force")
    system.connect("aircraft.rate", "imu.rate")
    system.connect("wind.wind_n", "aircraft.wind_n")
    system.connect("aircraft.air_velocity_n", "air_data.wind_n")
    system.connect("imu.reading", "ahrs.imu")
    system.connect("magnetometer.field", "ahrs.field")
    system.connect("air_data.air", "ahrs.air")
    system.connect("ahrs.attitude", "navigator.attitude")
    system.connect("air_data.air", "navigator.air")
    system.connect("dme.ranging", "navigator.ranging")
    system.connect("gps.fix", "navigator.fix")
    system.connect("navigator.solution", "ahrs.position")  # for the declination: slow, one step late
    system.connect("navigator.solution", "evaluation.solution")
    for output in ("north_sigma", "east_sigma", "mode"):
        system.connect(f"navigator.{output}", f"evaluation.{output}")


def use_stations(give, name: str) -> None:
    """Give receiver and navigator the same stations; ``give(component, values)`` takes them."""
    stations = STATION_SETS[name]
    give("dme", {**stations.parameters(), **stations.ranges()})
    give("navigator", stations.parameters())


def add_variants(system: SystemSource) -> None:
    """Open loop, other receivers of DME and GPS, the literal (6.40), the other grades of Table 3.2, real stations."""
    system.variant(
        "open_loop",
        parameters={"navigator": {"dme_aiding": False}},
        description="dead reckoning alone: ranges are ignored",
    )
    for name, mode in RECEIVERS.items():
        system.variant(name, parameters={"dme": {"mode": mode}}, description=f"DME receiver: {name.replace('_', ' ')}")
    system.variant(
        "shared_bias",
        parameters={"dme": {"receiver_share": DME["annex_10"].values["receiver_share"]}},
        description="72 % of the variance of the ranges' biases is the DME receiver's, common to its stations",
    )
    system.variant(
        "three_antennas",
        connections={"ahrs.gps": "gps.attitude"},
        description="three GPS antennas: their attitude calibrates gyros and hard iron, thesis section 4.11",
    )
    for name, values in ATTITUDES.items():
        system.variant(
            name,
            components={"ahrs": f"{name}.fmu"},
            parameters={"ahrs": values} if values else {},
            description=f"attitude by {name} in the place of ahrs",
        )
    for name, connections in NAVIGATORS.items():
        system.variant(
            name,
            components={"navigator": f"{name}.fmu"},
            connections=connections,
            description=f"navigation by {name} in the place of navigator",
        )
    system.variant(
        "gps_signals",
        components={"gps": "gps_signals.fmu", "gps_solver": "gps_solver.fmu"},
        connections={
            "gps.specific_force": "aircraft.specific_force",
            "gps_solver.signals": "gps.signals",
            "navigator.fix": "gps_solver.fix",
            "navigator.fix_error_sigma": "gps_solver.horizontal_sigma",
            "navigator.augmented_protection": "gps_solver.augmented_horizontal_protection",
        },
        description="GPS as signals of satellites, whose solver makes the fixes",
    )
    system.variant(
        "r_as_printed",
        parameters={"navigator": {"bias_sigma": 0.0, "innovation_gate": 0.0, "prior": 0.0, "wind_mean_sigma": 0.0}},
        description="thesis (6.40) as printed: the range bias is left out of the measurement noise; overconfident",
    )
    for grade in sorted(GRADES.keys() - {BASE_GRADE}):
        name = f"imu_{grade}"
        system.variant(
            name,
            parameters={"imu": GRADES[grade], "ahrs": ahrs_parameters(grade)},
            sets={"imu": name, "ahrs": f"ahrs_{grade}"},
            description=f"{grade} grade IMU, thesis Table 3.2",
        )
    real: dict[str, dict] = {}
    use_stations(lambda component, values: real.update({component: values}), "bay_area")
    for name, mode in {"bay_area": 1, "bay_area_scanning": 3}.items():
        parameters = {**real, "dme": {**real["dme"], "mode": mode}}
        system.variant(name, parameters=parameters, description="real Bay Area stations, navigation data cycle 2013.10")
