"""The wind: Berman-Powell over travelling time, MIL-F-8785C's turbulence, profile, gusts, and what shear does to dead
reckoning (F26), each beside its closed form."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from scipy import stats

from evidence.section import Section
from evidence.sensors.flown_wind import (
    DISTANCE,
    FLIGHTS,
    FREQUENCY,
    HEIGHTS,
    LAGS,
    LEVELS,
    RATIOS,
    SECONDS,
    SHEAR,
    STEP,
    STRETCHES,
    Flown,
    certified,
    exponential,
    measure,
    power_law,
    scatter,
    specified,
    spectrum,
    spread,
)
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png, title
from navfmu.report.page import Page

ALLOWED = 4.9
"""Standard deviations: probability 1e-6 on both sides."""
BAND = 8
"""Lines of the spectrum that are looked at together."""


def run(out: Path) -> Section:
    """Fly, compare and draw."""
    flown = measure()
    write_file(out / "sensors" / "wind.png", picture(flown, make_claims(flown)))
    return section(flown)


def section(flown: Flown) -> Section:
    """Claims and the picture."""
    claims = make_claims(flown)

    def write(page: Page) -> None:
        page.heading("Wind", 3)
        page.items(claim.sentence for claim in claims)
        page.picture(picture(flown, claims), "Turbulence, wander, profile, gusts and shear beside their closed forms")

    return Section(claims, write)


def make_claims(flown: Flown) -> list[Claim]:
    """One for each panel of the picture."""
    ratio = flown.power / spectrum(FREQUENCY)
    bands = np.array([np.mean(ratio[k : k + BAND], axis=0) for k in range(0, len(ratio) - BAND + 1, BAND)])
    degrees = 2 * STRETCHES * BAND
    tail = stats.chi2.ppf(1.0 - 5e-7 / len(bands), degrees) / degrees - 1.0
    strength = [
        np.abs((rms / specified(LEVELS, grade)[0]) ** 2 - 1.0) / scatter(grade)
        for grade, rms in flown.intensities.items()
    ]
    return [
        Claim(
            f"Turbulence has the spectra of MIL-F-8785C: largest deviation of a band of {BAND} lines",
            100.0 * float(np.max(np.abs(bands - 1.0))), 100.0 * float(tail), False, "%",
            "Turbulence has other spectra than MIL-F-8785C",
        ),
        Claim(
            "Wander forgets over travelling time, thesis (3.35): deviation from exp(-t_r/400 s), in its own sigma",
            float(np.max(np.abs(flown.correlations - exponential(LAGS)) / spread())), ALLOWED, False,
            opposite="Wander does not forget over travelling time, thesis (3.35)",
        ),
        Claim(
            "The profile is the power law of open country",
            float(np.max(np.abs(flown.profile - power_law(HEIGHTS)))), 1e-9, False, "m/s",
            "The profile is not the power law of open country",
        ),
        Claim(
            "The gust is that of CS-25.341",
            float(np.max(np.abs(next(iter(flown.gusts.values())) - certified(DISTANCE)))), 1e-9, False, "m/s",
            "The gust is not that of CS-25.341",
        ),
        Claim(
            f"Dead reckoning takes a shear for way: after {flown.time[-1] / 60.0:.0f} min, off the integral of the "
            "change by",
            100.0 * abs(flown.error[-1] / (-SHEAR * flown.time[-1]) - 1.0), 5.0, False, "%",
            "Dead reckoning does not take a shear for way",
        ),
        Claim(
            "Turbulence is as strong as in MIL-F-8785C: deviation of the mean square at each height, in its own sigma",
            float(np.max(strength)), ALLOWED, False,
            opposite="Turbulence is not as strong as in MIL-F-8785C",
        ),
    ]  # fmt: skip


def picture(flown: Flown, claims: Sequence[Claim]) -> bytes:
    """A panel for each claim."""
    with figure(2, 3, size=(14.0, 8.0)) as (drawing, axes):
        (power, wander, profile), (gust, shear, intensity) = axes
        drawing.subplots_adjust(hspace=0.32, wspace=0.28)
        smooth = np.geomspace(FREQUENCY[0], FREQUENCY[-1], 200)
        for k, name in enumerate(("along", "across and down")):
            power.loglog(FREQUENCY, flown.power[:, k], ".", ms=3, color=COLOURS[k], label=f"wind.fmu, {name}")
            power.loglog(smooth, spectrum(smooth)[:, k], "k-", lw=0.8)
            power.loglog(smooth, spectrum(smooth, folded=False)[:, k], "k:", lw=0.8)
        power.plot([], [], "k-", lw=0.8, label="MIL-F-8785C, sampled at 10 Hz")
        power.plot([], [], "k:", lw=0.8, label="MIL-F-8785C")
        power.set(xlabel="frequency at 50 m/s, Hz", ylabel="power, (m/s)²/Hz of 1 m/s rms")

        minutes, curves, deviation = LAGS * STEP / 60.0, exponential(LAGS), spread()
        for k, (name, ratio) in enumerate(zip(FLIGHTS, RATIOS, strict=True)):
            band = curves[k] - 2 * deviation[k], curves[k] + 2 * deviation[k]
            wander.plot(
                minutes, flown.correlations[k], ".", ms=3, color=COLOURS[k], label=f"{name}: t_r = {ratio:.3g} t"
            )
            wander.plot(minutes, curves[k], "-", color=COLOURS[k], lw=0.8)
            wander.fill_between(minutes, *band, color=COLOURS[k], alpha=0.15, lw=0)
        wander.set(xlabel="time, min", ylabel=f"correlation (shaded: 2 sigma of {SECONDS / 3600.0:.0f} h)")

        smooth = np.linspace(0.0, 400.0, 400)
        profile.plot(power_law(smooth), smooth, "k-", lw=0.8, label="power law")
        profile.plot(flown.profile, HEIGHTS, "o", ms=4, color=COLOURS[0], label="wind.fmu")
        profile.axhline(274.0, color=GREY, lw=0.8, ls=":")
        profile.set(xlabel="mean wind, m/s", ylabel="height above the ground, m", xlim=(0.0, None))

        for (name, values), colour in zip(flown.gusts.items(), COLOURS, strict=False):
            gust.plot(DISTANCE, values, color=colour, label=name)
        gust.set(xlabel="distance behind the front, m", ylabel="wind upward, m/s", ylim=(-0.5, 13.5))

        minutes = flown.time / 60.0
        shear.plot(minutes, flown.error / 1000.0, color=COLOURS[0], lw=2, label="error north, less that without shear")
        shear.plot(minutes, -SHEAR * flown.time / 1000.0, "k--", lw=0.8, label="10 m/s times time")
        shear.set(xlabel="time since the wind from the north fell by 10 m/s, min", ylabel="km")

        smooth = np.linspace(1.0, 900.0, 300)
        for (name, rms), colour in zip(flown.intensities.items(), COLOURS, strict=False):
            expected, _ = specified(smooth, name)
            for k, (mark, style) in enumerate((("o", "-"), ("x", ":"))):
                intensity.plot(expected[:, k], smooth, style, color=colour, lw=1)
                intensity.plot(rms[:, k], LEVELS, mark, color=colour, ms=4, label=f"{name}, {('along', 'down')[k]}")
        intensity.set(
            xlabel="rms of 50 min (lines: specified), m/s", ylabel="height above the ground, m", xlim=(0.0, None)
        )

        for ax, claim in zip((power, wander, profile, gust, shear, intensity), claims, strict=True):
            title(drawing, ax, claim.sentence.partition(":")[0].partition(",")[0])
            ax.legend(fontsize=8)
        return png(drawing, 80)
