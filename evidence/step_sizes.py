"""The step-size sweep of the flight: 2 ms to 1 s, both algorithms, the same noise at every step."""

from __future__ import annotations

from pathlib import Path

from evidence.section import Section
from navfmu.report.claim import Claim
from navfmu.report.page import Page
from navfmu.sweep.recommendation import recommendation
from navfmu.sweep.report import caption, picture, write_report
from navfmu.sweep.result import ALGORITHMS, Sweep
from navfmu.sweep.sweep import sweep
from navfmu.system.system import System
from navfmu.terminal.progress import Progress

STEPS = (0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)
SIGNALS = (
    "aircraft.latitude",
    "imu.reading.rate",
    "ahrs.attitude.heading",
    "air_data.air.true_airspeed",
    "navigator.solution.latitude",
    "navigator.solution.longitude",
    "navigator.north_sigma",
    "navigator.east_sigma",
    "evaluation.horizontal_error",
)


def run(out: Path) -> Section:
    """Sweep, with GPS lost at minute 5; the full table is in ``out``/step_sizes."""
    system = System.load("backup_navigator", "scanning")
    experiment = system.experiment(stop=900.0, seed=1, faults="gps_lost", record=SIGNALS)
    with Progress("step sizes") as progress:
        result = sweep(experiment, STEPS, progress=progress)
    write_report(result, out / "step_sizes")
    return section(result, system.structure.step)


def section(result: Sweep, own: float) -> Section:
    """What a sweep shows of the step (s) that the system itself suggests."""
    best = result.recommended("gauss_seidel") or 0.0
    limit = f"{100 * result.tolerance:g} % of its range"
    step = Claim(
        f"The system's own step of {own:g} s keeps every signal within {limit} of what {result.steps[0]:g} s gives",
        best, own, unit="s",
    )  # fmt: skip
    lost = Claim(
        f"At {own:g} s no measurement is lost between components",
        float(result.lost_at("gauss_seidel", own)), 0.0, at_least=False,
    )  # fmt: skip

    def write(page: Page) -> None:
        page.heading("Communication step size")
        page.text(recommendation(result))
        page.picture(
            picture(result), "Error against communication step size, log-log, Jacobi and Gauss-Seidel", caption(result)
        )
        page.table(
            ["signal", *(f"order, {a}" for a in ALGORITHMS)],
            [[name, *("-" if (order := result.order(a, name)) is None else str(order) for a in ALGORITHMS)]
             for name in result.signals],
        )  # fmt: skip
        sigmas = [name for name in result.signals if name.endswith("_sigma")]
        if sigmas:
            page.text("rms change of the filter's reported sigma against the smallest step, m:")
            page.table(
                ["signal", "algorithm", *(f"{step:g} s" for step in result.steps[1:])],
                [[name, a, *(row.problem or f"{row.rms:.3g}" for row in result.of(a, name)[1:])]
                 for name in sigmas for a in ALGORITHMS],
            )  # fmt: skip
        if any(any(counts.values()) for counts in result.lost.values()):
            page.text("Samples lost because the step was longer than the measurement period:")
            page.table(
                ["counter", "algorithm", *(f"{step:g} s" for step in result.steps)],
                [[name, a, *(str(counts[a, step]) for step in result.steps)] for name, counts in result.lost.items()
                 for a in ALGORITHMS],
            )  # fmt: skip

    return Section([step, lost], write)
