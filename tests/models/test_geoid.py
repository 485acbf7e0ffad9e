"""The table of the geoid against heights of EGM96 as its authors published them, and in C against NumPy."""

from pathlib import Path

import numpy as np
import pytest

from models.earth import geoid
from navfmu.export import Component, Grid, Input, Output, Parameter, every
from tests.models.native import Native

PUBLISHED = (
    (38.6281550, 269.7791550, -31.628),
    (-14.6212170, 305.0211140, -2.969),
    (46.8743190, 102.4487290, -43.575),
    (-23.6174460, 133.8747120, 15.871),
    (38.6254730, 359.9995000, 50.066),
    (-0.4667440, 0.0023000, 17.329),
)
"""Test values of the program F477 of the National Geospatial-Intelligence Agency: degrees and m."""
WITHIN, LARGEST = 5.2, 17.2
"""Of the fit, m: on 99.5 % of the sphere, and anywhere."""


class Sea(Component):
    """Height of the sea."""

    latitude = Input("rad", description="latitude")
    longitude = Input("rad", description="longitude")
    sample_period = Parameter("s", start=1.0, description="period")
    sea = Grid(
        axes=(("latitude", "rad", geoid.LATITUDES), ("longitude", "rad", geoid.LONGITUDES)),
        surfaces=(("coefficient", "m", geoid.TABLE),),
    )
    height = Output("m", description="of the geoid")

    @every("sample_period")
    def look(self):
        self.height = geoid.height(self.latitude, self.longitude, self.coefficients)

    def coefficients(self, latitude, longitude):
        return self.sea.around(latitude=latitude, longitude=longitude).corners[..., 0]


@pytest.mark.parametrize(("latitude", "longitude", "height"), PUBLISHED)
def test_published_heights(latitude, longitude, height):
    """Of six places that are on 99.5 % of the sphere; longitudes to the west, or a table upside down, are 30 m off."""
    assert geoid.height(np.radians(latitude), np.radians(longitude)) == pytest.approx(height, abs=WITHIN)


def test_heights_of_the_file_all_over_the_sphere():
    """650 heights of WW15MGH.DAC, every 7.25 by 14.25 degrees; the errors of all of them are 0.99 m rms.

    Their kurtosis is 20.3 and weights make 527 of the 650, so the mean square of a sample is 0.98 +- 0.19 m2; with
    three of these its root is below 1.25 m. Bilinear interpolation of the coefficients has 1.65 m.
    """
    rows = np.loadtxt(Path(__file__).with_name("egm96.csv"), delimiter=",", skiprows=1)
    longitudes = np.loadtxt(Path(__file__).with_name("egm96.csv"), delimiter=",", max_rows=1, dtype=str)[1:]
    error, area = [], []
    for latitude, *heights in rows:
        for longitude, height in zip(longitudes.astype(float), heights, strict=True):
            error.append(geoid.height(np.radians(latitude), np.radians(longitude)) - height)
            area.append(np.cos(np.radians(latitude)))
    assert len(error) == 650
    assert np.sqrt(np.average(np.square(error), weights=area)) < 1.25
    assert np.max(np.abs(error)) < LARGEST


def test_the_surface_has_no_seam():
    """Across the date line, Greenwich and the edges of cells height and slope go on; at a pole there is one height."""
    d = 1e-6
    for longitude in (-np.pi, 0.0, np.pi, 2.0 * np.pi, 5 * geoid.STEP):
        before, at, after = (geoid.height(0.4, longitude + k * d) for k in (-1, 0, 1))
        assert after - 2.0 * at + before == pytest.approx(0.0, abs=1e-8)
        assert geoid.height(0.4, longitude + 2.0 * np.pi) == pytest.approx(at, abs=1e-9)
    for pole in (-0.5 * np.pi, 0.5 * np.pi):
        assert np.ptp([geoid.height(pole, k) for k in range(7)]) < 0.01


def test_a_grid_in_an_fmu_has_the_same_heights(tmp_path):
    """At random places, at poles and edges of cells, on longitudes of any turn; NaN stays NaN."""
    rng = np.random.default_rng(4)
    places = [(np.arcsin(s), t) for s, t in rng.uniform((-1.0, -7.0), (1.0, 7.0), (200, 2))]
    places += [(s * np.pi / 2, t) for s in (-1, 1) for t in (-3.0, 0.0, 2.0 * np.pi)]
    places += [(geoid.LATITUDES[k], geoid.LONGITUDES[2 * k]) for k in range(1, 74)]
    places += [(0.3, float("nan")), (float("nan"), 0.3)]

    def inputs(t):
        return dict(zip(("latitude", "longitude"), places[round(t)], strict=True))

    found = Native(Sea, tmp_path).run(len(places), 1.0, ["height"], inputs=inputs)["height"][1:]
    np.testing.assert_allclose(found, [geoid.height(*place) for place in places], rtol=0, atol=1e-9)
    assert np.all(np.isnan(found[-2:])) and np.all(np.isfinite(found[:-2]))
