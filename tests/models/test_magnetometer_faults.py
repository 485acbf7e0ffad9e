"""What can fail at a magnetometer: onset, signature and recovery of each; numbers F of the table in docs/fmea.md."""

import numpy as np
import pygeomag
import pytest
from scipy import stats

from fmus.magnetic.magnetometer import Magnetometer
from models.attitude import attitude
from models.magnetic import crust, magnetic_field, wire
from navfmu.errors import NavfmuError
from tests.models.native import Native, interpret

MG = 1e-7
PLACE = {"latitude": 0.6583, "longitude": -2.1225, "altitude": 1500.0}
QUIET = {"crustal_level": 0.0, "hard_iron_sigma": 0.0, "noise_sigma": 0.0}
QUIET |= {"soft_iron_sigma": 0.0, "scale_factor_sigma": 0.0, "misalignment_sigma": 0.0}
ON, OFF, STOP = 2.0, 4.0, 6.0
HEADINGS = np.arange(12) * np.pi / 6.0


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(Magnetometer, tmp_path_factory.mktemp("magnetometer"))


def flown(native, faults, parameters=None):
    """Samples (120, 3) of a turning aircraft with all errors drawn; faults act from ON to OFF."""

    def inputs(t):
        acts = ON - 1e-9 < t < OFF - 1e-9
        attitude_now = {"roll": 0.3 * np.sin(t), "pitch": 0.1, "heading": 0.5 * t}
        return {
            **PLACE,
            **attitude_now,
            **{name: value if acts else 0.0 * np.asarray(value) for name, value in faults.items()},
        }

    return native.run(STOP, 0.05, ["field.field_b"], parameters, inputs)["field.field_b"][1:]


CHANGES = {
    "F16 hard iron": {"hard_iron_change": [40 * MG, 0.0, -10 * MG]},
    "F16 current": {"wire_current": 12.0},
    "F17 soft iron": {"soft_iron_change": [[0.1, 0.0, 0.0], [0.05, -0.1, 0.0], [0.0, 0.0, 0.02]]},
    "F18 anomaly": {"anomaly_n": [0.0, 30 * MG, 20 * MG]},
}


@pytest.mark.parametrize("name", CHANGES)
def test_it_acts_from_the_first_sample_on_and_leaves_nothing_behind(native, name):
    """Bit for bit the same before and after: the triad has no memory, and no random number was drawn more or less."""
    parameters = {"ground_altitude": 1490.0, "seed": 3}
    changed, sound = flown(native, CHANGES[name], parameters), flown(native, {}, parameters)
    acts = slice(round(ON / 0.05), round(OFF / 0.05))
    np.testing.assert_array_equal(changed[: acts.start], sound[: acts.start])
    np.testing.assert_array_equal(changed[acts.stop :], sound[acts.stop :])
    assert np.all(np.linalg.norm(changed[acts] - sound[acts], axis=1) > 5 * MG)


def swing(native, declination=None, **faults):
    """Error of the heading of a level aircraft, rad, at HEADINGS."""
    truth_n = magnetic_field.field(*PLACE.values(), 2026.0)
    declination = magnetic_field.declination(truth_n) if declination is None else declination
    errors = []
    for heading in HEADINGS:
        run = native.run(
            2.0, 1.0, ["field.field_b"], QUIET, lambda t, heading=heading: {**PLACE, "heading": heading, **faults}
        )
        x, y, _ = run["field.field_b"][-1]
        errors.append(attitude.wrap(np.arctan2(-y, x) + declination - heading))
    return np.array(errors)


def coefficients(errors):
    """A ... E of thesis (3.52) over the magnetic heading, by least squares (3.53)."""
    field_n = magnetic_field.field(*PLACE.values(), 2026.0)
    psi = HEADINGS - magnetic_field.declination(field_n)
    columns = [np.ones(12), np.sin(psi), np.cos(psi), np.sin(2 * psi), np.cos(2 * psi)]
    found, left, *_ = np.linalg.lstsq(np.stack(columns, axis=1), errors, rcond=None)
    return found, np.sqrt(left[0] / 12)


def test_f16_hard_iron_turns_the_needle_once_to_and_fro_in_a_circle(native):
    """B = -dB_x / H, C = -dB_y / H of thesis (3.51); what is left is of second order."""
    field_n = magnetic_field.field(*PLACE.values(), 2026.0)
    horizontal = np.hypot(field_n[0], field_n[1])
    found, left = coefficients(swing(native, hard_iron_change=[5 * MG, -3 * MG, 20 * MG]))
    np.testing.assert_allclose(found, [0.0, -5 * MG / horizontal, 3 * MG / horizontal, 0.0, 0.0], atol=3e-4)
    assert left < 3e-4


def test_f16_a_current_has_the_field_of_its_wire(native):
    """3.6 mG an ampere of the wire as it is, to the right: a needle that goes once to and fro, 6 degrees at 7 A."""
    expected = wire.field(np.array([-1.0, 0.0, 0.5]), np.array([1.0, 0.0, 0.5]), 7.0)
    assert np.linalg.norm(expected) == pytest.approx(25 * MG, rel=0.01)
    for current, factor in ((7.0, 1.0), (-7.0, -1.0), (0.7, 0.1)):
        level = {**PLACE, "wire_current": current}
        run = native.run(2.0, 1.0, ["field.field_b"], QUIET, lambda t, level=level: level)
        sound = magnetic_field.field(*PLACE.values(), 2026.0)
        np.testing.assert_allclose(run["field.field_b"][-1] - sound, factor * expected, rtol=1e-9, atol=1e-19)
    found, _ = coefficients(swing(native, wire_current=2.0))
    field_n = magnetic_field.field(*PLACE.values(), 2026.0)
    assert found[2] == pytest.approx(-2.0 / 7.0 * expected[1] / np.hypot(field_n[0], field_n[1]), rel=0.01)


def test_the_wire_is_soft_irons_too(native):
    """(3.28) has C_si (B + dB): what iron aboard makes of Earth's field it makes of the wire's."""
    soft = [[0.0, 0.2, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
    both = {**PLACE, "wire_current": 7.0, "soft_iron_change": soft}
    alone = {**PLACE, "wire_current": 0.0, "soft_iron_change": soft}
    with_wire, without = (
        native.run(2.0, 1.0, ["field.field_b"], QUIET, lambda t, which=which: which)["field.field_b"][-1]
        for which in (both, alone)
    )
    right = wire.field(np.array([-1.0, 0.0, 0.5]), np.array([1.0, 0.0, 0.5]), 7.0)[1]
    np.testing.assert_allclose(with_wire - without, [0.2 * right, right, 0.0], rtol=1e-9, atol=1e-18)


def test_f17_soft_iron_turns_the_needle_twice_to_and_fro(native):
    """A = (a_xy - a_yx) / 2, D = (a_yy - a_xx) / 2, E = -(a_xy + a_yx) / 2, which (3.48) to (3.50) give; in the text
    of thesis (3.51) each has a wrong index, and A, D and E would be 0.01, 0.003 and -0.01."""
    soft = np.array([[0.01, 0.012, 0.0], [0.004, -0.008, 0.0], [0.0, 0.0, 0.0]])
    found, left = coefficients(swing(native, soft_iron_change=soft))
    np.testing.assert_allclose(found, [0.004, 0.0, 0.0, -0.009, -0.008], atol=2e-4)
    assert left < 2e-4


def test_a_change_of_soft_iron_adds_to_what_is_there(native):
    """C_m C_sf (C_si + change): the same as a triad made so, to rounding."""
    soft, change = np.diag([0.02, -0.03, 0.01]), np.array([[0.0, 0.04, 0.0], [0.01, 0.0, 0.02], [0.0, -0.05, 0.03]])
    made = {**QUIET, "scale_factor": [0.05, -0.02, 0.01], "misalignment": [0.01, 0.02, -0.03]}
    tilted = {**PLACE, "roll": 0.4, "pitch": -0.2, "heading": 1.0}
    changed, built = (
        native.run(2.0, 1.0, ["field.field_b"], parameters, lambda t, inputs=inputs: inputs)["field.field_b"][-1]
        for parameters, inputs in (
            ({**made, "soft_iron": soft}, {**tilted, "soft_iron_change": change}),
            ({**made, "soft_iron": soft + change}, {**tilted, "soft_iron_change": 0.0 * change}),
        )
    )
    np.testing.assert_allclose(changed, built, rtol=1e-13)


def test_f18_an_anomaly_is_fixed_to_the_ground_and_falls_with_the_height(native):
    """The same in n on all headings; at a height of its depth an eighth is left, below the ground it does not grow."""
    anomaly_n = np.array([10 * MG, 40 * MG, -20 * MG])
    parameters = {**QUIET, "ground_altitude": 200.0, "anomaly_depth": 30.0}
    for height, share in ((0.0, 1.0), (30.0, 0.125), (270.0, 1e-3), (-50.0, 1.0)):
        for heading in (0.0, 2.0):
            place = {**PLACE, "altitude": 200.0 + height, "heading": heading, "roll": 0.2, "anomaly_n": anomaly_n}
            run = native.run(2.0, 1.0, ["field.field_b"], parameters, lambda t, place=place: place)
            seen_n = attitude.dcm(0.2, 0.0, heading) @ run["field.field_b"][-1]
            field_n = magnetic_field.field(PLACE["latitude"], PLACE["longitude"], 200.0 + height, 2026.0)
            np.testing.assert_allclose(seen_n - field_n, share * anomaly_n, rtol=1e-6, atol=1e-15)


def test_f19_an_old_chart_turns_all_headings_alike(native):
    """A chart of 2012 in the field of 2026 at Livermore: the difference of the declinations, by pygeomag."""
    at = {"glat": np.degrees(PLACE["latitude"]), "glon": np.degrees(PLACE["longitude"]), "alt": 1.5}
    old = pygeomag.GeoMag(coefficients_file="wmm/WMM_2010.COF").calculate(**at, time=2012.0).d
    new = pygeomag.GeoMag(coefficients_file="wmm/WMM_2025.COF").calculate(**at, time=2026.0).d
    charted = magnetic_field.declination(magnetic_field.field(*PLACE.values(), 2012.0))
    errors = np.degrees(swing(native, declination=charted))
    np.testing.assert_allclose(errors, old - new, atol=1e-6)
    assert abs(old - new) > 1.0


def test_f12_a_field_beyond_the_range_is_cut_off_axis_by_axis(native):
    strong = {**PLACE, "hard_iron_change": [3e-4, 0.0, -4e-4]}
    run = native.run(2.0, 1.0, ["field.field_b"], QUIET, lambda t: strong)["field.field_b"][-1]
    sound = magnetic_field.field(*PLACE.values(), 2026.0)
    np.testing.assert_array_equal(run[[0, 2]], [2e-4, -2e-4])
    assert run[1] == pytest.approx(sound[1], abs=1e-15)


def test_f12_a_coarse_converter_gives_multiples_with_an_even_error(tmp_path, native):
    """Steps of 2 mG of a field with 5 mG of noise: whole multiples, the error has the variance of an even
    distribution, step^2 / 12. 6000 values, bound at 1e-6: a variance of an even distribution has sd sqrt(4/5/n)."""
    step = 2 * MG
    quiet = {**QUIET, "noise_sigma": 5 * MG, "seed": 5}
    fine, coarse = (
        native.run(100.0, 0.05, ["field.field_b"], {**quiet, "resolution": r}, lambda t: PLACE)["field.field_b"][20:]
        for r in (0.0, step)
    )
    multiples = coarse / step
    np.testing.assert_allclose(multiples, np.rint(multiples), atol=1e-9)
    error = (coarse - fine).ravel() / step
    assert np.max(np.abs(error)) <= 0.5 + 1e-9
    bound = stats.norm.isf(5e-7) * np.sqrt(0.8 / error.size)
    assert abs(12.0 * np.mean(error**2) - 1.0) < bound
    assert abs(np.mean(error)) < stats.norm.isf(5e-7) / np.sqrt(12.0 * error.size)


@pytest.mark.parametrize("height", [0.0, 1000.0, 5000.0])
def test_the_crustal_anomaly_falls_with_the_height_when_it_is_told_to(native, height):
    """400 turn-ons, three axes: the variance is the share of its waves, bound at 1e-6; alike at all heights fails."""
    place = {**PLACE, "altitude": 300.0 + height}
    truth = magnetic_field.field(*place.values(), 2026.0)
    sigma = magnetic_field.left_out(truth, 2026.0)
    parameters = {**QUIET, "crustal_level": 1.0, "crust_decays": True, "ground_altitude": 300.0}
    left = []
    for seed in range(400):
        run = native.run(1.0, 1.0, ["field_n"], {**parameters, "seed": seed}, lambda t: place)
        left.append((run["field_n"][-1] - truth) / sigma)
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], 1200) / 1200
    share = crust.wave_share(height, 10e3) ** 2
    assert low < np.mean(np.square(left)) / share < high


def test_noise_and_anomaly_are_the_same_for_every_communication_step(native):
    turned = {**PLACE, "heading": 1.0}
    runs = [
        native.run(10.0, step, ["field.field_b"], {"seed": 9}, lambda t: turned)["field.field_b"][1:]
        for step in (0.05, 0.5, 2.5)
    ]
    np.testing.assert_array_equal(runs[0][9::10], runs[1])
    np.testing.assert_array_equal(runs[0][49::50], runs[2])
    other = native.run(10.0, 0.5, ["field.field_b"], {"seed": 10}, lambda t: turned)["field.field_b"][1:]
    assert not np.any(other[2:] == runs[1][2:])


def test_a_wire_through_the_triad_is_refused_with_a_sentence():
    with pytest.raises(NavfmuError, match="passes within 1 mm of the triad"):
        interpret(Magnetometer, wire_begin_b=[-1.0, 0.0, 0.0], wire_end_b=[1.0, 0.0, 0.0])
    interpret(Magnetometer, wire_begin_b=[0.5, 0.0, 0.0], wire_end_b=[1.0, 0.0, 0.0])
