"""Which calibration turns allow: whatever they are, no answer is wild."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.spatial.transform import Rotation

from navfmu.calibration.magnetometer.choice import AUTOMATIC, LIMIT, METHODS, choose
from navfmu.calibration.magnetometer.locus import HARD_IRON, UNTOLD, fit
from navfmu.errors import NavfmuError
from tests.calibration.turned import CENTRE, FIELD, measured

FLIGHTS = 60
SOFT = 0.03
"""Standard deviation of gains and soft iron."""


def slowly(rng, sigma, samples, count):
    """Numbers (count,) that go together over so many samples."""
    keep = 1.0 - 1.0 / samples
    return sigma * np.sqrt(1.0 - keep**2) * lfilter([1.0], [1.0, -keep], rng.standard_normal(count))


def flight(seed):
    """Fields and what they were, T, of a flight at any dip, with few or many turns, and noise part of which is slow."""
    rng = np.random.default_rng(seed)
    count, dip = int(rng.integers(60, 2000)), np.radians(rng.uniform(20.0, 80.0))
    yaw = rng.uniform(0.0, 6.0) + 0.1 * np.cumsum(rng.standard_normal(count))
    roll, pitch = (np.radians(slowly(rng, rng.uniform(*most), 30.0, count)) for most in ((2.0, 40.0), (1.0, 15.0)))
    turned = Rotation.from_euler("ZYX", np.stack([yaw, pitch, roll], axis=1)).inv()
    true = FIELD * turned.apply([np.cos(dip), 0.0, np.sin(dip)])
    soft = SOFT * rng.standard_normal((3, 3))
    gained, iron = np.eye(3) + 0.5 * (soft + soft.T), FIELD * rng.uniform(-1.0, 1.0, 3)
    size = FIELD * 10.0 ** rng.uniform(-2.7, -1.7)
    noise = size * (rng.standard_normal((count, 3)) + np.outer(slowly(rng, 1.0, 40.0, count), rng.standard_normal(3)))
    return true @ gained + iron + 0.7 * noise, true @ gained + iron, true


def test_no_answer_is_wild():
    """60 flights: the largest error of a corrected field, of all samples, is below four times what is said, its own
    errors and those of the gains and the soft iron that are left out: of three normal numbers 1 of 900 is beyond.

    Wrong: an ellipsoid without end, a sphere in fields of a straight flight, samples that are taken for independent.
    """
    methods = []
    for seed in range(FLIGHTS):
        fields, clean, true = flight(seed)
        try:
            one = choose(fields, FIELD, None, AUTOMATIC, "made")
        except NavfmuError:
            methods.append("none")
            continue
        methods.append(one.method)
        if METHODS[one.method].level:
            continue
        error = np.max(np.linalg.norm(one.locus.corrected(clean) - true, axis=1)) / FIELD
        assert one.error <= LIMIT
        assert error < 4.0 * np.hypot(one.error, SOFT / UNTOLD * one.untold), seed
    assert {"ellipsoid", "sphere", "hard-iron"} <= set(methods)


@pytest.mark.parametrize("method", METHODS)
def test_a_straight_flight_tells_nothing(method):
    """Wrong: centre and gains from the noise."""
    fields = np.array([2e-5, 1e-5, 4e-5]) + 3e-7 * np.random.default_rng(1).standard_normal((500, 3))
    with pytest.raises(NavfmuError, match="no calibration is to be had"):
        choose(fields, FIELD, 2.2e-5, method, "made")


@pytest.mark.parametrize("strength", [FIELD, None])
@pytest.mark.parametrize("across", [1e-6, 1e-4])
def test_fields_in_a_disc_are_no_flank_of_a_huge_ellipsoid(strength, across):
    """A triad whose z tells nothing but a slow creep, and one with gains of 4 and 2, which is one (thesis Table 3.3).

    Wrong: Earth's field of 0.37 T, or a gain of z of 600, with an error of 0.03 %.
    """
    rng = np.random.default_rng(2)
    fields = measured(rng, np.pi, 3000, 2e-7)
    fields[:, 2] = 4e-5 + across * FIELD * np.linspace(0.0, 1.0, len(fields))
    with pytest.raises(NavfmuError, match="no calibration is to be had"):
        choose(fields, strength, None, "ellipsoid", "made")
    turned = measured(rng, np.pi, 3000, 2e-7, gained=np.diag([4.0, 2.0, 1.0]), centre=7.0 * CENTRE)
    assert choose(turned, strength, None, "ellipsoid", "made").method == "ellipsoid"


@pytest.mark.parametrize("method", ["ellipse", "circle"])
def test_fields_all_over_a_disc_are_no_circle(method):
    """Wrong: a circle with an error of 1 %, from which fields are a quarter of it away, as if that were noise."""
    turned = np.random.default_rng(2).standard_normal((3000, 3))
    fields = FIELD * turned / np.linalg.norm(turned, axis=1)[:, None] * [1.0, 1.0, 0.0]
    with pytest.raises(NavfmuError, match=rf"{method}: .* % of the field are left, rms; expected 10 %"):
        choose(fields, 0.9 * FIELD, 0.9 * FIELD, method, "made")


def test_fields_on_a_line_are_refused():
    """Wrong: a sphere of negative gain, whose mean over three axes is a complex number."""
    along = np.outer(np.random.default_rng(1).standard_normal(3000), [1e-5, 5e-6, 2e-6])
    for strength in (FIELD, None):
        with pytest.raises(NavfmuError, match="no calibration is to be had"):
            choose(along, strength, None, AUTOMATIC, "made")


def level(seed):
    """Fields, what they were without noise, and the true ones, T, of a level turn at a dip of 60 degrees."""
    rng = np.random.default_rng(seed)
    turned = Rotation.from_euler("z", np.linspace(0.0, 720.0, 600)[:, None], degrees=True).inv()
    true = FIELD * turned.apply([0.5, 0.0, np.sqrt(0.75)])
    clean = true + FIELD * rng.uniform(-1.0, 1.0, 3)
    return clean + 3e-7 * rng.standard_normal((600, 3)), clean, true


def test_a_level_turn_does_not_say_whether_the_field_points_up_or_down():
    """12 level turns: two spheres of the known radius go through a circle, and which of them noise prefers is chance.
    Wrong: the nearer of them with a sigma of nanotesla, 80 uT off in z in every third turn."""
    for seed in range(12):
        fields, clean, true = level(seed)
        one = choose(fields, FIELD, 0.5 * FIELD, AUTOMATIC, "made")
        assert METHODS[one.method].level
        assert any("one surface as another" in why for why in one.refused)
        error = one.locus.corrected(clean[:, :2]) - true[:, :2]
        assert np.max(np.linalg.norm(error, axis=1)) < 5.0 * one.error * one.locus.field


@pytest.mark.parametrize("seed", [1, 4, 8, 9])
def test_much_soft_iron_in_a_strip_is_found(seed):
    """Gains and soft iron of 30 % in turns that leave a plane by 5 degrees. Wrong: nothing is found, because no sphere
    lies next to these fields."""
    rng = np.random.default_rng(seed)
    time, across = np.linspace(0.0, 1.0, 2000), np.diag(rng.uniform(0.7, 1.4, 3))
    around, up = 6.0 * np.pi * time, np.radians(5.0) * np.sin(46.0 * time)
    true = FIELD * np.stack([np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up)], axis=1)
    turned = Rotation.random(random_state=seed).as_matrix()
    gained, iron = turned @ across @ turned.T, FIELD * rng.uniform(-1.0, 1.0, 3)
    one = choose(true @ gained + iron + 1e-7 * rng.standard_normal(true.shape), FIELD, None, AUTOMATIC, "made")
    assert one.method == "ellipsoid"
    error = np.max(np.linalg.norm(one.locus.corrected(true @ gained + iron) - true, axis=1)) / FIELD
    assert error < 4.0 * one.error


def test_wild_samples_are_left_out():
    """20 of 2000 samples are two field strengths off: what is found is within a sigma what is found without them.
    Wrong: their scatter counts for all, and a sphere is taken where the gains are 10 % apart."""
    samples = measured(np.random.default_rng(8), np.pi, 2000, 1e-7)
    spoiled, wild = samples.copy(), np.random.default_rng(9)
    spoiled[::100] += 2.0 * FIELD * wild.standard_normal((20, 3))
    clean, found = (choose(one, FIELD, None, AUTOMATIC, "made") for one in (samples, spoiled))
    assert (clean.wild, found.method) == (0, "ellipsoid")
    assert 18 <= found.wild <= 20  # some of them may be next to the surface
    sigma = np.sqrt(np.diag(clean.locus.covariance)[:3])
    np.testing.assert_array_less(np.abs(found.locus.centre - clean.locus.centre), sigma)


def test_a_sphere_is_refused_where_the_fields_are_an_ellipsoid():
    """Gains from 0.95 to 1.1 scatter about a sphere like noise that many samples average out. Wrong: a small error."""
    samples = measured(np.random.default_rng(8), np.pi, 2000, 1e-7)
    with pytest.raises(NavfmuError, match=r"sphere: gains or soft iron that it leaves out leave \d"):
        choose(samples, FIELD, None, "sphere", "made")


def test_errors_of_a_hard_iron_alone_are_those_of_the_sphere_that_has_the_fields_strength():
    """A narrow strip of a triad that has gains of 1, with noise. Wrong: errors at the sphere of any size that lies next
    to it, whose centre is elsewhere."""
    fields = measured(np.random.default_rng(9), 0.2, 300, 4e-6, gained=np.eye(3))
    with pytest.raises(NavfmuError, match="no calibration is to be had") as refused:
        choose(fields, FIELD, None, "hard-iron", "made")
    said = re.search(r"hard-iron: errors of ([\d.]+) %", str(refused.value))
    own = fit(HARD_IRON, fields, FIELD)
    seen = own.corrected(fields)
    errors = own.errors(seen / np.linalg.norm(seen, axis=1)[:, None]) / FIELD
    assert float(said[1]) == pytest.approx(100.0 * errors.max(), rel=0.01)
