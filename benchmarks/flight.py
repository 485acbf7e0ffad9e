"""The backup navigator's flight: ten FMUs at 100 Hz.

Goals: at least 2000 x real time, at most 2 x a bare C loop; an FMPy loop takes at least 10 x as long, ecospy and
libcosimpy at least as long.
"""

from __future__ import annotations

from benchmarks.contest import Contest, compete, main
from benchmarks.masters import BareLoop, Ecos, FmpyLoop, Libcosim, Ours, check_bare, check_equal
from navfmu import System
from navfmu.system import shipped

STEP, LONG = 0.01, 50_000.0
WORK = (
    "Steps of one flight, not the same ones: whoever is faster makes more of them. Loading, initialisation and "
    "recording are not in the times. navfmu and the bare C loop make the same FMI calls, in Gauss-Seidel with the "
    "slopes of inputs, and leave out inputs of which no bit has changed; the bare loop checks no status and knows no "
    "faults and no names. The others run Jacobi: the FMPy loop, in Python as its users write it, sets all inputs at "
    "every step; ecospy and libcosimpy run masters in C++ that are called once for many steps. After 500 steps those "
    "of one algorithm have the same bits."
)


def run(rounds: int = 7) -> list[Contest]:
    ssp = shipped.path("backup_navigator.ssp")
    system = System.load(ssp)

    def plan(algorithm: str):
        record = ["evaluation.horizontal_error"]
        return system.plan(stop=LONG, step=STEP, algorithm=algorithm, record=record, record_period=LONG)

    jacobi, gauss_seidel = plan("jacobi"), plan("gauss_seidel")
    check_equal(ssp, jacobi)
    check_bare(gauss_seidel)
    shares = {
        "bare C loop": (BareLoop(jacobi), 20_000),
        "navfmu": (Ours(jacobi), 20_000),
        "bare C loop, Gauss-Seidel": (BareLoop(gauss_seidel), 20_000),
        "navfmu, Gauss-Seidel": (Ours(gauss_seidel), 20_000),
        "FMPy loop": (FmpyLoop(jacobi), 1_000),
        "ecospy": (Ecos(ssp, jacobi), 2_000),
        "libcosimpy": (Libcosim(ssp, jacobi), 2_000),
    }
    contenders = {name: (lambda m=m, n=n: m.run(n) / n) for name, (m, n) in shares.items()}
    contest = compete("backup navigator, ten FMUs", "macro step", contenders, rounds, WORK)
    real_time = STEP / contest.median("navfmu, Gauss-Seidel")
    contest.claim("Flight at 100 Hz, Gauss-Seidel: times real time in the loop", 2000.0, real_time)
    for algorithm, tail in (("Jacobi", ""), ("Gauss-Seidel", ", Gauss-Seidel")):
        ratio = contest.ratio(f"navfmu{tail}", f"bare C loop{tail}")
        text = f"Flight, {algorithm}: time of navfmu over that of a bare C loop, which checks nothing"
        contest.claim(text, 2.0, ratio, at_least=False)
    contest.claim("Flight: time of an FMPy loop over that of navfmu", 10.0, contest.ratio("FMPy loop", "navfmu"))
    for peer in ("ecospy", "libcosimpy"):
        contest.claim(f"Flight: time of {peer} over that of navfmu", 1.0, contest.ratio(peer, "navfmu"))
    return [contest]


if __name__ == "__main__":
    main(run)
