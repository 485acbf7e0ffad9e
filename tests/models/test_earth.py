"""The ellipsoid and its gravity against pymap3d, navpy and the gradient of the geopotential."""

import navpy
import numpy as np
import pymap3d
import pytest

from models.earth import earth

LATITUDES = np.radians([-89.0, -45.0, -12.3, 0.0, 37.7, 60.0, 89.9])


def test_radii_agree_with_pymap3d():
    meridian, prime_vertical = earth.radii(LATITUDES)
    np.testing.assert_allclose(meridian, pymap3d.rcurve.meridian(LATITUDES, deg=False), rtol=1e-12)
    np.testing.assert_allclose(prime_vertical, pymap3d.rcurve.transverse(LATITUDES, deg=False), rtol=1e-12)


def test_radii_agree_with_the_thesis_to_first_order_in_the_flattening():
    meridian, prime_vertical = earth.radii(LATITUDES)
    s2, f, r = np.sin(LATITUDES) ** 2, earth.FLATTENING, earth.EQUATORIAL_RADIUS
    np.testing.assert_allclose(meridian, r * (1 + f * (3 * s2 - 2)), rtol=5 * f * f)
    np.testing.assert_allclose(prime_vertical, r * (1 + f * s2), rtol=5 * f * f)


@pytest.mark.parametrize("position", [(0.65, -2.1, 1500.0), (-1.2, 3.0, -50.0), (0.0, 0.0, 0.0)])
def test_ecef_agrees_with_pymap3d(position):
    np.testing.assert_allclose(earth.to_ecef(*position), pymap3d.geodetic2ecef(*position, deg=False), atol=1e-7)


@pytest.mark.parametrize("latitude", [-np.pi / 2, -1.2, -1e-9, 0.0, 0.65, 1.5, np.pi / 2])
@pytest.mark.parametrize("altitude", [-1e4, 0.0, 1500.0, 1e5, 2.0e7])
def test_positions_in_e_come_back(latitude, altitude):
    """From below the ground to the orbits, at poles and equator; one step of Bowring is 10 um off in orbit."""
    position_e = np.array(pymap3d.geodetic2ecef(latitude, 3.0, altitude, deg=False))
    found = earth.from_ecef(position_e)
    np.testing.assert_allclose(found, (latitude, 3.0, altitude), rtol=1e-14, atol=5e-9)
    np.testing.assert_allclose(earth.to_ecef(*found), position_e, atol=1e-8)


def test_axes_of_n_are_those_of_pymap3d():
    rotation = earth.north_east_down(0.65, -2.1)
    east, north, up = pymap3d.ecef2enuv(1.0, -2.0, 3.0, 0.65, -2.1, deg=False)
    np.testing.assert_allclose(rotation @ np.array([1.0, -2.0, 3.0]), (north, east, -up), atol=1e-14)


def test_gravity_has_the_published_values_on_the_ellipsoid():
    assert earth.gravity(0.0, 0.0) == pytest.approx(9.7803253359, abs=1e-10)
    assert earth.gravity(np.pi / 2, 0.0) == pytest.approx(9.8321849378, abs=1e-9)
    assert earth.gravity(np.pi / 4, 0.0) == pytest.approx(9.806197769, abs=1e-8)


@pytest.mark.parametrize("altitude", [0.0, 2000.0, 12000.0])
@pytest.mark.parametrize("latitude", [-1.2, 0.1, 0.6585, 1.4])
def test_gravity_is_the_gradient_of_the_geopotential(latitude, altitude):
    """WGS-84: GM, J2 from its C20, J4 and J6 of the ellipsoid's own field; the centrifugal term added."""
    gm, a, spin = 3.986004418e14, earth.EQUATORIAL_RADIUS, earth.EARTH_RATE
    j = {2: 1.082629821e-3, 4: -2.37091222e-6, 6: 6.08347e-9}

    def potential(r_e):
        r = np.linalg.norm(r_e)
        legendre = np.polynomial.legendre.Legendre
        sine = r_e[2] / r
        series = 1.0 - sum(jn * (a / r) ** n * legendre.basis(n)(sine) for n, jn in j.items())
        return gm / r * series + 0.5 * spin**2 * (r_e[0] ** 2 + r_e[1] ** 2)

    here = earth.to_ecef(latitude, 0.4, altitude)
    step = 100.0
    gradient = [(potential(here + step * u) - potential(here - step * u)) / (2 * step) for u in np.eye(3)]
    assert earth.gravity(latitude, altitude) == pytest.approx(np.linalg.norm(gradient), abs=2e-6)


@pytest.mark.parametrize("latitude", [-0.9, 0.0, 0.66])
def test_earth_rate_is_the_polar_axis_seen_from_the_local_level(latitude):
    east, north, up = pymap3d.ecef2enuv(0.0, 0.0, earth.EARTH_RATE, latitude, -2.1, deg=False)
    np.testing.assert_allclose(earth.earth_rate(latitude), [north, east, -up], atol=1e-18)


def test_rates_agree_with_navpy():
    latitude, altitude, velocity = 0.66, 1800.0, np.array([30.0, -45.0, 2.0])
    np.testing.assert_allclose(
        earth.transport_rate(latitude, altitude, velocity),
        np.ravel(navpy.navrate(*velocity, np.degrees(latitude), altitude)),
        rtol=1e-12,
    )
