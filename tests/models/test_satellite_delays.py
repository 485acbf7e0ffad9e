"""Delays of the atmosphere: vectors of RTKLIB's test/utest/t_atmos.c, and Klobuchar's example."""

from __future__ import annotations

import numpy as np
import pytest

from models.satellite import klobuchar, niell, saastamoinen, sines

ALPHA, BETA = (0.2e-7, -0.8e-8, -0.5e-7, 0.1e-6), (0.2e6, 0.2e6, -0.1e6, -0.1e7)


@pytest.mark.parametrize(
    ("hour", "latitude", "longitude", "azimuth", "elevation", "delay"),
    [
        (1, 35, 140, 60, 75, 6.73590532099438),
        (1, -80, -170, 60, 75, 3.56895382197387),
        (1, 10, 30, 60, 75, 3.80716435655161),
        (13, 35, 140, 60, 75, 5.21796954585452),
        (22, 35, 140, 60, 75, 5.90190539264777),
        (1, 35, 140, 190, 3, 21.6345415123632),
        (1, 35, 140, 350, 60, 7.33844278822561),
        (1, 35, 140, 0, 90, 6.58339711400694),
    ],
)
def test_klobuchar_has_the_vectors_of_rtklib(hour, latitude, longitude, azimuth, elevation, delay):
    """At night, at the pole, near the horizon; an azimuth from east, or a period that is not cut, would be off by m."""
    angles = np.radians([latitude, longitude, elevation, azimuth])
    for day in (0.0, 2 * 86400.0):
        found = klobuchar.delay(*angles[:3], sines.of(angles[3]), 3600.0 * hour + day, ALPHA, BETA)
        assert found == pytest.approx(delay, abs=1e-8)


def test_klobuchar_has_the_value_of_the_published_example():
    """40 N, 260 E, 20 h 45 min: 23.784 m."""
    angles = *np.radians([40.0, 260.0, 20.0]), sines.of(np.radians(210.0))
    found = klobuchar.delay(*angles, 74700.0, (3.82e-8, 1.49e-8, -1.79e-7, 0.0), (1.43e5, 0.0, -3.28e5, 1.13e5))
    assert found == pytest.approx(23.784, abs=5e-4)


@pytest.mark.parametrize(
    ("latitude", "altitude", "elevation", "delay"),
    [
        (35.0, 100.0, 75.0, 2.44799870144088),
        (35.0, 100.0, 3.0, 45.1808916506163),
        (-80.0, 1000.0, 75.0, 2.17295817298152),
    ],
)
def test_saastamoinen_has_the_vectors_of_rtklib(latitude, altitude, elevation, delay):
    zenith = sum(saastamoinen.zenith(np.radians(latitude), altitude, 0.5))
    assert saastamoinen.slant(zenith, np.sin(np.radians(elevation))) == pytest.approx(delay, abs=1e-8)


def test_the_troposphere_thins_out_with_height():
    """Finite, positive and falling up to where there is none; a power of a negative base would be no number."""
    delays = np.array([sum(saastamoinen.zenith(0.9, height)) for height in np.linspace(-500.0, 6e4, 200)])
    assert np.all(np.diff(delays) <= 0.0)
    assert delays[0] == pytest.approx(2.4, abs=0.1)
    assert 0.0 <= delays[-1] < 1e-3


@pytest.mark.parametrize(
    ("latitude", "altitude", "elevation", "hydrostatic", "wet"),
    [
        (35, 100, 75, 1.035184526466435, 1.035233787448654),
        (35, 100, 3, 14.643271711748200, 16.455045694559484),
        (35, 100, 60, 1.154226397147367, 1.154481126139610),
        (35, 100, 90, 1.0, 1.0),
        (-80, 1000, 75, 1.035186155749051, 1.035230548304367),
        (10, 0, 75, 1.035181919429758, 1.035233200318210),
    ],
)
def test_niell_has_the_vectors_of_rtklib(latitude, altitude, elevation, hydrostatic, wet):
    """2007-01-16, 6 h; south of the equator the year is turned by half, and tables end at 15 and 75 degrees."""
    found = niell.mapping(16.25, np.radians(latitude), float(altitude), np.sin(np.radians(elevation)))
    np.testing.assert_allclose(found, (hydrostatic, wet), atol=1e-8)
