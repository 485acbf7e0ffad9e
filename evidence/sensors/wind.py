"""The wind: Berman-Powell over travelling time, MIL-F-8785C's turbulence, profile, gusts, and what shear does to dead
reckoning (F26), each beside its closed form."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from scipy import stats

from evidence.section import Section
from fmus.grades import TURBULENCE
from navfmu import System
from navfmu.faults import Fault
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png, title
from navfmu.report.page import Page
from navfmu.system import shipped

SPEED, LENGTH = 50.0, 533.4
FLIGHTS = {"at rest": (0.0, 0.0, 0.0), "north": (50.0, 0.0, 0.0), "north-east, climbing": (40.0, 30.0, -5.0)}
"""Velocities by what they are called; of each the travelling time is 1, sqrt(2) and 2 times the time."""
RATIOS = (1.0, np.sqrt(2.0), 2.0)
SHEAR, ONSET = -10.0, 900.0
"""Change of the wind from the north, m/s, and when, s."""
ALLOWED = 4.9
"""Standard deviations: probability 1e-6 on both sides."""


def run(out: Path) -> Section:
    """Fly, compare and draw."""
    wind = Winds()
    claims = [wind.turbulent, wind.correlated, wind.steady, wind.gusty, wind.sheared, wind.layered]
    write_file(out / "sensors" / "wind.png", picture(wind, claims))

    def write(page: Page) -> None:
        page.heading("Wind", 3)
        page.items(claim.sentence for claim in claims)
        page.picture(picture(wind, claims), "Turbulence, wander, profile, gusts and shear beside their closed forms")

    return Section(claims, write)


def fly(stop: float, step: float, faults: Sequence[Fault] = (), **parameters: object) -> np.ndarray:
    """Winds in n of the FMU alone, (samples, 3), from t = 0 on."""
    calm = {"sigma": [0.0, 0.0, 0.0]}
    recorded = System.load(shipped.path("wind.fmu")).run(
        stop=stop,
        step=step,
        seed=1,
        faults=faults,
        parameters={f"wind.{name}": value for name, value in (calm | parameters).items()},
        record=["wind.wind_n"],
        record_period=step,
    )
    return recorded.to_numpy()


@dataclass(frozen=True)
class Winds:
    """What is measured, each part when it is first asked for."""

    PERIOD = 0.1
    LINES = 1024  # samples of a stretch whose spectrum is taken
    STRETCHES = 400
    LAGS = np.arange(1, 121)  # samples of the wander
    STEP = 10.0  # between them, s
    HOURS = 200e3 / 3600.0
    LEVELS = np.array([10.0, 50.0, 150.0, 300.0, 400.0, 500.0, 650.0, 900.0])
    SAMPLES = 3000  # of turbulence at each level, one a second
    HEIGHTS = np.array([0.0, 3.0, 10.0, 30.0, 60.0, 100.0, 150.0, 200.0, 274.0, 300.0, 400.0])

    @cached_property
    def spectra(self) -> tuple[np.ndarray, np.ndarray]:
        """Frequencies, Hz, and mean power of the stretches along and down, (m/s)2/Hz: (lines,), (lines, 2)."""
        samples = fly(
            self.STRETCHES * self.LINES * self.PERIOD,
            self.PERIOD,
            turbulence_sigma=[1.0] * 3,
            turbulence_length=LENGTH,
            true_airspeed=SPEED,
        )
        stretches = samples[1:].reshape(self.STRETCHES, self.LINES, 3)[..., [0, 2]]
        window = np.hanning(self.LINES + 1)[:-1, None]
        power = np.mean(np.abs(np.fft.rfft(window * stretches, axis=1)) ** 2, axis=0)
        lines = np.arange(2, self.LINES // 2, 2)  # every other line, as good as independent
        return lines / (self.LINES * self.PERIOD), 2.0 * self.PERIOD * power[lines] / np.sum(window**2)

    def specified(self, frequency: np.ndarray, folded: bool = True) -> np.ndarray:
        """The spectra of MIL-F-8785C along and down; those of samples are folded: (lines, 2)."""
        total = np.zeros((len(frequency), 2))
        for k in range(-200, 201) if folded else (0,):
            reduced = LENGTH * 2.0 * np.pi * np.abs(frequency + k / self.PERIOD) / SPEED
            one = 1.0 + reduced**2
            total += 4.0 * LENGTH / SPEED * np.stack([1.0 / one, 0.5 * (1.0 + 3.0 * reduced**2) / one**2], axis=1)
        return total

    @property
    def turbulent(self) -> Claim:
        frequency, power = self.spectra
        ratio = power / self.specified(frequency)
        bands = [np.mean(ratio[k : k + 8], axis=0) for k in range(0, len(ratio) - 7, 8)]
        degrees = 2 * self.STRETCHES * 8
        tail = stats.chi2.ppf(1.0 - 5e-7 / len(bands), degrees) / degrees - 1.0
        return Claim(
            "Turbulence has the spectra of MIL-F-8785C: largest deviation of a band of eight lines",
            100.0 * float(np.max(np.abs(np.array(bands) - 1.0))), 100.0 * tail, False, "%",
            "Turbulence has other spectra than MIL-F-8785C",
        )  # fmt: skip

    @cached_property
    def correlations(self) -> np.ndarray:
        """Of the wander over LAGS, mean of north and east, by flight: (flights, lags)."""
        found = []
        for velocity in FLIGHTS.values():
            samples = fly(
                self.HOURS * 3600.0, self.STEP, sigma=[5.0, 5.0, 0.0], velocity_n=velocity, sample_period=self.STEP
            )[:, :2]
            found.append([np.mean(samples[:-k] * samples[k:]) / 25.0 for k in self.LAGS])
        return np.array(found)

    def exponential(self, lags: np.ndarray) -> np.ndarray:
        """exp(-t_r / 400 s) over lags of whole samples, (flights, lags)."""
        return np.exp(-np.outer(RATIOS, lags) * self.STEP / 400.0)

    @property
    def spread(self) -> np.ndarray:
        """Standard deviations of the correlations by Bartlett's formula, (flights, lags)."""
        reach = np.arange(-2000, 2001)
        terms = [
            np.sum(
                self.exponential(2 * np.abs(reach)) + self.exponential(np.abs(reach + k) + np.abs(reach - k)), axis=1
            )
            for k in self.LAGS
        ]
        return np.sqrt(np.stack(terms, axis=1) / (2 * self.HOURS * 3600.0 / self.STEP))

    @property
    def correlated(self) -> Claim:
        return Claim(
            "Wander forgets over travelling time, thesis (3.35): deviation from exp(-t_r/400 s), in its own sigma",
            float(np.max(np.abs(self.correlations - self.exponential(self.LAGS)) / self.spread)), ALLOWED, False,
            opposite="Wander does not forget over travelling time, thesis (3.35)",
        )  # fmt: skip

    @cached_property
    def profile(self) -> np.ndarray:
        """Mean wind from the west of 10 m/s over open country, at HEIGHTS."""
        parameters = {"mean_n": [0.0, 10.0, 0.0], "profile_exponent": 1.0 / 6.5}
        return np.array([fly(0.1, 0.1, altitude=h, **parameters)[-1, 1] for h in self.HEIGHTS])

    @property
    def steady(self) -> Claim:
        expected = 10.0 * (np.clip(self.HEIGHTS, 1.0, 274.0) / 274.0) ** (1.0 / 6.5)
        return Claim(
            "The profile is the power law of open country",
            float(np.max(np.abs(self.profile - expected))), 1e-9, False, "m/s",
            "The profile is not the power law of open country",
        )  # fmt: skip

    @cached_property
    def gusts(self) -> dict[str, np.ndarray]:
        """Upward winds over 500 m, front at 100 m, every m; by name."""
        front = Fault("gust", "wind.gust", "input", start=99.0 / SPEED, parameters={"value": True})
        kinds = {"CS-25.341, H = 107 m": (107.0, 0.0), "MIL-F-8785C, d = 200 m": (200.0, 1e7), "wake": (1.0, 38.0)}
        return {
            name: -fly(10.0, 1.0 / SPEED, [front], gust_n=[0.0, 0.0, -10.0], gust_gradient=gradient,
                       gust_plateau=plateau, true_airspeed=SPEED, sample_period=1.0 / SPEED)[:, 2]
            for name, (gradient, plateau) in kinds.items()
        }  # fmt: skip

    @property
    def gusty(self) -> Claim:
        s = np.arange(501.0) - 100.0
        certified = np.where((s >= 0.0) & (s <= 214.0), 5.0 * (1.0 - np.cos(np.pi * s / 107.0)), 0.0)
        return Claim(
            "The gust is that of CS-25.341",
            float(np.max(np.abs(self.gusts["CS-25.341, H = 107 m"] - certified))), 1e-9, False, "m/s",
            "The gust is not that of CS-25.341",
        )  # fmt: skip

    @cached_property
    def intensities(self) -> dict[str, np.ndarray]:
        """Rms of turbulence along and down at LEVELS, (levels, 2), by grade."""
        found = {}
        for name, grade in TURBULENCE.items():
            flown = [
                fly(
                    self.SAMPLES, 1.0, altitude=height, sample_period=1.0, true_airspeed=SPEED,
                    turbulence_sigma=[grade["turbulence_sigma"]] * 3, wind_at_20_feet=grade["wind_at_20_feet"],
                )
                for height in self.LEVELS
            ]  # fmt: skip
            found[name] = np.array([np.sqrt(np.mean(samples[1:, [0, 2]] ** 2, axis=0)) for samples in flown])
        return found

    @property
    def layered(self) -> Claim:
        worst = 0.0
        for name, rms in self.intensities.items():
            sigma, length = specified(self.LEVELS, name)
            x = np.arange(1, 1000)[:, None, None] * SPEED / length
            rho = np.exp(-x) * np.array([1.0 + 0.0 * x[..., 0], 1.0 - 0.5 * x[..., 1]]).transpose(1, 2, 0)
            spread = np.sqrt(2.0 * (1.0 + 2.0 * np.sum(rho**2, axis=0)) / self.SAMPLES)
            worst = max(worst, float(np.max(np.abs((rms / sigma) ** 2 - 1.0) / spread)))
        return Claim(
            "Turbulence is as strong as in MIL-F-8785C: deviation of the mean square at each height, in its own sigma",
            worst, ALLOWED, False,
            opposite="Turbulence is not as strong as in MIL-F-8785C",
        )  # fmt: skip

    @cached_property
    def errors(self) -> tuple[np.ndarray, np.ndarray]:
        """Times since the shear, s, and by how much more the dead-reckoned position is to the north with it, m."""
        system = System.load("backup_navigator", variant="open_loop")
        shear = Fault("shear", "wind.shear", "input", start=ONSET, parameters={"value": True})
        flights = [
            system.run(
                stop=ONSET + 600.0, seed=3, faults=["gps_lost", *faults], record=["evaluation.north_error"],
                record_period=1.0, parameters={"wind.shear_n": [SHEAR, 0.0, 0.0]},
            )["evaluation.north_error"]
            for faults in ([], [shear])
        ]  # fmt: skip
        after = flights[0].index >= ONSET
        return flights[0].index[after].to_numpy() - ONSET, (flights[1] - flights[0])[after].to_numpy()

    @property
    def sheared(self) -> Claim:
        time, error = self.errors
        return Claim(
            f"Dead reckoning takes a shear for way: after {time[-1] / 60.0:.0f} min, off the integral of the change by",
            100.0 * abs(error[-1] / (-SHEAR * time[-1]) - 1.0), 5.0, False, "%",
            "Dead reckoning does not take a shear for way",
        )  # fmt: skip


def specified(heights: np.ndarray, grade: str) -> tuple[np.ndarray, np.ndarray]:
    """Intensities, m/s, and lengths, m, of MIL-F-8785C along and down, (heights, 2) each."""
    h = np.clip(heights, 3.048, 304.8)
    factor = 0.177 + 0.000823 * h / 0.3048
    down = 0.1 * TURBULENCE[grade]["wind_at_20_feet"]
    low = np.stack([down / factor**0.4, 0.0 * h + down], axis=1), np.stack([h / factor**1.2, h], axis=1)
    above = np.clip(heights / 304.8 - 1.0, 0.0, 1.0)[:, None]
    high = TURBULENCE[grade]["turbulence_sigma"], LENGTH
    return tuple((1.0 - above) * one + above * other for one, other in zip(low, high, strict=True))


def picture(wind: Winds, claims: Sequence[Claim]) -> bytes:
    """A panel for each claim."""
    with figure(2, 3, size=(14.0, 8.0)) as (drawing, axes):
        (spectrum, wander, profile), (gust, shear, intensity) = axes
        drawing.subplots_adjust(hspace=0.32, wspace=0.28)
        frequency, power = wind.spectra
        smooth = np.geomspace(frequency[0], frequency[-1], 200)
        for k, name in enumerate(("along", "across and down")):
            spectrum.loglog(frequency, power[:, k], ".", ms=3, color=COLOURS[k], label=f"wind.fmu, {name}")
            spectrum.loglog(smooth, wind.specified(smooth)[:, k], "k-", lw=0.8)
            spectrum.loglog(smooth, wind.specified(smooth, folded=False)[:, k], "k:", lw=0.8)
        spectrum.plot([], [], "k-", lw=0.8, label="MIL-F-8785C, sampled at 10 Hz")
        spectrum.plot([], [], "k:", lw=0.8, label="MIL-F-8785C")
        spectrum.set(xlabel="frequency at 50 m/s, Hz", ylabel="power, (m/s)²/Hz of 1 m/s rms")

        minutes, curves = wind.LAGS * wind.STEP / 60.0, wind.exponential(wind.LAGS)
        for k, (name, ratio) in enumerate(zip(FLIGHTS, RATIOS, strict=True)):
            band = curves[k] - 2 * wind.spread[k], curves[k] + 2 * wind.spread[k]
            wander.plot(
                minutes, wind.correlations[k], ".", ms=3, color=COLOURS[k], label=f"{name}: t_r = {ratio:.3g} t"
            )
            wander.plot(minutes, curves[k], "-", color=COLOURS[k], lw=0.8)
            wander.fill_between(minutes, *band, color=COLOURS[k], alpha=0.15, lw=0)
        wander.set(xlabel="time, min", ylabel=f"correlation (shaded: 2 sigma of {wind.HOURS:.0f} h)")

        smooth = np.linspace(0.0, 400.0, 400)
        profile.plot(10.0 * (np.clip(smooth, 1.0, 274.0) / 274.0) ** (1 / 6.5), smooth, "k-", lw=0.8, label="power law")
        profile.plot(wind.profile, wind.HEIGHTS, "o", ms=4, color=COLOURS[0], label="wind.fmu")
        profile.axhline(274.0, color=GREY, lw=0.8, ls=":")
        profile.set(xlabel="mean wind, m/s", ylabel="height above the ground, m", xlim=(0.0, None))

        for (name, values), colour in zip(wind.gusts.items(), COLOURS, strict=False):
            gust.plot(np.arange(501.0) - 100.0, values, color=colour, label=name)
        gust.set(xlabel="distance behind the front, m", ylabel="wind upward, m/s", ylim=(-0.5, 13.5))

        time, error = wind.errors
        shear.plot(time / 60.0, error / 1000.0, color=COLOURS[0], lw=2, label="error north, less that without shear")
        shear.plot(time / 60.0, -SHEAR * time / 1000.0, "k--", lw=0.8, label="10 m/s times time")
        shear.set(xlabel="time since the wind from the north fell by 10 m/s, min", ylabel="km")

        smooth = np.linspace(1.0, 900.0, 300)
        for (name, rms), colour in zip(wind.intensities.items(), COLOURS, strict=False):
            expected, _ = specified(smooth, name)
            for k, (mark, style) in enumerate((("o", "-"), ("x", ":"))):
                intensity.plot(expected[:, k], smooth, style, color=colour, lw=1)
                intensity.plot(
                    rms[:, k], wind.LEVELS, mark, color=colour, ms=4, label=f"{name}, {('along', 'down')[k]}"
                )
        intensity.set(
            xlabel="rms of 50 min (lines: specified), m/s", ylabel="height above the ground, m", xlim=(0.0, None)
        )

        for ax, claim in zip((spectrum, wander, profile, gust, shear, intensity), claims, strict=True):
            title(drawing, ax, claim.sentence.partition(":")[0].partition(",")[0])
            ax.legend(fontsize=8)
        return png(drawing, 80)
