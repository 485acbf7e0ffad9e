"""F19: the chart aboard is of another date than the field outside."""

import numpy as np
import pygeomag
import pytest

OLD, NOW = 2012.0, 2026.0


def declination(date, name, place):
    """At a position in rad and m, by pygeomag, rad."""
    chart = pygeomag.GeoMag(coefficients_file=f"wmm/WMM_{name}.COF")
    latitude, longitude, altitude = place
    at = {"glat": np.degrees(latitude), "glon": np.degrees(longitude), "alt": altitude / 1e3}
    return np.radians(chart.calculate(**at, time=date).d)


def test_an_old_chart_turns_the_heading_by_the_change_of_the_declination(load):
    """The same flight, the same noise, one AHRS with the field of 2012 as its chart: 1.2 degrees at Livermore, and
    nothing else. A date without effect on the chart, or with one on the field outside, fails."""
    signals = ["ahrs.attitude.heading", "ahrs.attitude.roll", "ahrs.attitude.valid"]
    place = [f"aircraft.{name}" for name in ("latitude", "longitude", "altitude")]
    new, old = (
        load().run(
            stop=300.0, step=0.01, seed=5, record=[*signals, *place], record_period=1.0,
            parameters={"ahrs.date": date, "magnetometer.date": NOW},
        )
        for date in (NOW, OLD)
    )  # fmt: skip
    end = new.iloc[-1]
    change = declination(OLD, "2010", end[place]) - declination(NOW, "2025", end[place])
    assert np.degrees(change) > 1.0 and end["ahrs.attitude.valid"] == 1.0
    turned = old.iloc[-1]["ahrs.attitude.heading"] - end["ahrs.attitude.heading"]
    # the sigma of the declination, which goes into the gains, is that of another model: 0.3 and 0.33 degrees
    assert turned == pytest.approx(change, abs=0.02 * change)
    assert old.iloc[-1]["ahrs.attitude.roll"] == pytest.approx(end["ahrs.attitude.roll"], abs=0.02 * change)
