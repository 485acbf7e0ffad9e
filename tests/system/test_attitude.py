"""The AHRS in the shipped system: against an independent filter on the same measurements, and against its own sigma."""

import numpy as np
import pytest

from fmus.ahrs import Ahrs
from navfmu.faults import Fault
from tests.models.native import interpret
from tests.models.reference_ahrs import Reference, wrap

ANGLES = ("roll", "pitch", "heading")
STEP = 0.01


@pytest.fixture(scope="module")
def parameters():
    """Start values of the FMU's parameters."""
    names = [name for name, field in Ahrs.layout.fields.items() if field.causality == "parameter"]
    defaults = interpret(Ahrs)
    return {name: defaults.get(name) for name in names}


def array(run, name):
    """Columns name[1], name[2] ... of a recording."""
    return run[[column for column in run if column.startswith(f"{name}[")]].to_numpy()


def test_the_fmu_is_the_filter_that_its_equations_say(load, parameters):
    """Four minutes with a turn, air data lost from 100 to 130 s and wrong by a blocked pitot tube from 170 s on.

    The reference shares no code: full matrices, derivatives by the complex step. Agreement is to rounding; a sign, a
    term of H or the order of two updates would show at 1e-6 and above.
    """
    signals = ["imu.reading", "magnetometer.field", "air_data.air", "ahrs.attitude", "ahrs.tilt_noise"]
    faults = [
        Fault("lost", "air_data.air", "dropout", 100.0, 30.0),
        Fault("pitot", "air_data.pitot_blocked", "input", start=170.0),
    ]
    run = load().run(stop=240.0, step=STEP, seed=4, faults=faults, record=signals, record_period=STEP)
    rate, force = array(run, "imu.reading.rate"), array(run, "imu.reading.specific_force")
    field_b = array(run, "magnetometer.field.field_b")

    def column(name):
        return run[name].to_numpy()

    field_time, field_number = column("magnetometer.field.time_of_validity"), column("magnetometer.field.sequence")
    air_time, air_number = column("air_data.air.time_of_validity"), column("air_data.air.sequence")
    air_valid, airspeed = column("air_data.air.valid"), column("air_data.air.true_airspeed")
    reference = Reference(parameters)
    angles, sigmas, seen, air_seen = [], [], 0, 0
    for k in range(1, len(run)):
        now = k * STEP
        if air_number[k] != air_seen:
            air_seen = air_number[k]
            if air_valid[k]:
                reference.indicated = airspeed[k]
        reference.take_imu(rate[k], force[k], now)
        angles.append(reference.x[:3].copy())
        sigmas.append(reference.sigmas() if reference.aligned else np.zeros(3))
        if k % 50 == 0:
            new = field_number[k] != seen
            seen = field_number[k]
            sample = (field_b[k], field_time[k]) if new else None
            reference.aid(now, 0.5, (bool(air_valid[k]), airspeed[k], air_time[k]), sample)
    got = run[[f"ahrs.attitude.{name}" for name in ANGLES]].to_numpy()[1:]
    got_sigmas = run[[f"ahrs.attitude.{name}_sigma" for name in ANGLES]].to_numpy()[1:]
    aligned = run["ahrs.attitude.valid"].to_numpy()[1:]
    assert np.argmax(aligned) == 100
    np.testing.assert_allclose(wrap(got - np.array(angles))[aligned], 0.0, atol=1e-9)
    np.testing.assert_allclose(got_sigmas[aligned], np.array(sigmas)[aligned], rtol=1e-8)
    np.testing.assert_allclose(
        array(run, "ahrs.tilt_noise")[-1], parameters["tilt_sigma"] * np.sqrt(reference.level), rtol=1e-8
    )
