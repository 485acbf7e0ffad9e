"""The named air data systems: numbers of their sources, run as systems that bind their parameter sets."""

import ambiance
import numpy as np
import pytest

from fmus.air.air_data import AirData
from fmus.air.grades import AIR
from navfmu import System
from navfmu.export.parameter_sets import write
from navfmu.ssp.writer import SystemSource
from tests.models.native import Native
from tests.models.test_pitot_static import QUIET

FOOT, KNOT = 0.3048, 1852.0 / 3600.0
READING = "air_data.air.pressure_altitude"


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    native = Native(AirData, tmp_path_factory.mktemp("air_data"))
    write(AirData, native.folder.parent)
    return native


@pytest.fixture
def run(native, tmp_path):
    """Altitudes of a second with the file of a set bound, and with other values besides."""

    def fly(name, parameters):
        source = SystemSource("bench", fmus=native.folder.parent, stop_time=1.0, step=0.1)
        source.component("air_data", "air_data.fmu")
        source.parameters("air_data", AIR["cp298"].values, name="air_data")
        source.write(tmp_path)
        file = native.folder.parent / "parameters" / f"air_data_{name}.ssv"
        (tmp_path / "resources" / "air_data.ssv").write_bytes(file.read_bytes())
        given = {f"air_data.{key}": value for key, value in parameters.items()}
        return System.load(tmp_path).run(parameters=given, record=[READING])[READING].to_numpy()[1:]

    return fly


@pytest.mark.parametrize("name", AIR)
def test_a_system_that_binds_a_set_runs_as_one_with_its_values(native, run, name):
    """The values of the file are those of the source; the noise and the field of cp298, which was bound before, are
    gone."""
    bound = run(name, {"altitude": 3000.0})
    values = {**AIR[name].values, "altitude": 3000.0}
    found = native.run(1.0, 0.1, ["air.pressure_altitude"], values)["air.pressure_altitude"][1:]
    np.testing.assert_array_equal(bound, found)
    assert (np.std(np.diff(bound)) > 3.0) == (name == "cp298")


def test_the_light_aircraft_has_half_of_the_position_error_that_was_allowed(run):
    """15 ft at 100 kn."""
    still, moving = (
        run("light_aircraft", {**QUIET, "altitude": 0.0, "velocity_n[1]": v})[-1] for v in (0.0, 100.0 * KNOT)
    )
    assert (still - moving) / FOOT == pytest.approx(15.0, abs=0.3)


def test_the_transport_has_the_altimetry_error_of_the_regulation(run):
    """At FL 370 and Mach 0.78 80 ft, and 200 ft with three sigma."""
    height = float(ambiance.Atmosphere.from_pressure(21662.7).h[0])
    speed = 0.78 * float(ambiance.Atmosphere(height).speed_of_sound[0])
    values = {**QUIET, "altitude": height, "velocity_n[1]": speed}
    mean = (37000.0 * FOOT - run("transport", values)[-1]) / FOOT
    assert mean == pytest.approx(80.0, abs=1.5)
    assert mean + 3.0 * AIR["transport"].values["altitude_error_sigma"] / FOOT == pytest.approx(200.0, abs=1.5)
