"""A heading from a turned field, and a section that follows what was learned."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from scipy import stats
from scipy.spatial.transform import Rotation

from evidence.sensors import magnetometer_calibration as evidence
from navfmu.calibration.magnetometer.locus import SPHERE, fit
from navfmu.calibration.magnetometer.strips import table
from navfmu.report.page import Page
from tests.calibration import turned

IRON = np.array([3.9e-5, -1.6e-5, 4.0e-5])


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    """A made flight of 400 s whose true heading is known: turns with up to 40 degrees of roll."""
    folder = tmp_path_factory.mktemp("thor75")
    time = np.arange(200.0, 600.0, 0.2)
    roll, pitch = np.radians(40.0) * np.sin(0.21 * time), np.radians(6.0) * np.sin(0.5 * time)
    yaw = 0.05 * time
    magnetic = Rotation.from_euler("ZYX", np.stack([yaw - evidence.DECLINATION, pitch, roll], axis=1))
    dip = np.radians(72.0)
    field = magnetic.inv().apply(evidence.STRENGTH * np.array([np.cos(dip), 0.0, np.sin(dip)]))
    field += IRON + 3e-7 * np.random.default_rng(1).standard_normal(field.shape)
    pd.DataFrame(field, columns=["field_x", "field_y", "field_z"]).assign(time=time).to_parquet(
        folder / "magnetometer.parquet"
    )
    pd.DataFrame(
        {"time": time, "roll": roll, "pitch": pitch, "yaw": np.mod(yaw + np.pi, 2.0 * np.pi) - np.pi}
    ).to_parquet(folder / "reference.parquet")
    return folder


def test_what_is_learned_is_judged_on_the_rest(flight):
    """A heading error of the noise alone, 0.3 uT over 17.3 uT. Wrong: rows that were learned from, roll with the other
    sign (10 degrees), declination with the other sign (0.9), headings interpolated over half a turn."""
    one = evidence.learn(flight, 120.0)
    assert one.time[0] > 337.0
    assert one.time[-1] <= 578.0
    np.testing.assert_allclose(one.chosen.locus.centre, IRON, atol=2e-6)
    assert one.rms[0] < 2.5
    assert np.degrees(np.abs(np.mean(one.error))) < 0.6
    assert np.mean(one.level) < 0.6


@pytest.mark.parametrize(("turn", "holds"), [(0.0, True), (6.0, False)])
def test_the_section_follows_the_heading(flight, turn, holds):
    """Wrong: a title that is always the same."""
    one = evidence.learn(flight, 120.0)
    one = evidence.Learned(one.seconds, one.chosen, one.time, one.error + np.radians(turn), one.level)
    section = evidence.section([one], {"other": ("none", "errors of 20 %")}, table(3), {"sphere": 0.2})
    assert section.claims[0].holds is holds
    page = Page("")
    section.write(page)
    assert ("does not give the heading" in page.html()) is not holds
    assert "errors of 20 %" in page.html()


def test_agreement_is_a_probability_by_chi_square():
    """40 sets of six calibrations of one triad are spread evenly; one centre that is off by 20 sigma is told. Wrong:
    degrees of freedom that count the mean, errors of one calibration for those of all."""
    sets = []
    for seed in range(40):
        rng = np.random.default_rng(seed)
        sets.append([fit(SPHERE, turned.measured(rng, np.pi, 200, 5e-7, np.eye(3)), turned.FIELD) for _ in range(6)])
    assert stats.kstest([evidence.agreement(loci) for loci in sets], "uniform").pvalue > 1e-4
    one, *rest = sets[0]
    off = replace(one, centre=one.centre + 20.0 * np.sqrt(np.diag(one.covariance)[:3]))
    assert evidence.agreement([off, *rest]) < 1e-6
