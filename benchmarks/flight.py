"""The backup navigator's flight: ten FMUs at 100 Hz.

Goals: at least 2000 x real time, at most 2 x a bare C loop, 10 x an FMPy loop, faster than ecospy and libcosimpy.
"""

from __future__ import annotations

from benchmarks.contest import Contest, compete, main
from benchmarks.masters import BareLoop, Ecos, FmpyLoop, Libcosim, Ours, check_equal
from navfmu import System
from navfmu.system import shipped

STEP, LONG = 0.01, 50_000.0


def run(rounds: int = 7) -> Contest:
    ssp = shipped.path("backup_navigator.ssp")
    system = System.load(ssp)

    def plan(algorithm: str):
        record = ["evaluation.horizontal_error"]
        return system.plan(stop=LONG, step=STEP, algorithm=algorithm, record=record, record_period=LONG)

    jacobi, gauss_seidel = plan("jacobi"), plan("gauss_seidel")
    check_equal(ssp, jacobi)
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
    contest = compete("backup navigator, ten FMUs", "macro step", contenders, rounds)
    real_time = STEP / contest.median("navfmu, Gauss-Seidel")
    contest.claim("flight at 100 Hz: times real time (Gauss-Seidel)", 2000.0, real_time)
    contest.claim("flight: engine / bare C loop (Jacobi)", 2.0, contest.ratio("navfmu", "bare C loop"), at_least=False)
    ratio = contest.ratio("navfmu, Gauss-Seidel", "bare C loop, Gauss-Seidel")
    contest.claim("flight: engine / bare C loop (Gauss-Seidel)", 2.0, ratio, at_least=False)
    contest.claim("flight: FMPy loop / engine", 10.0, contest.ratio("FMPy loop", "navfmu"))
    for peer in ("ecospy", "libcosimpy"):
        contest.claim(f"flight: {peer} / engine", 1.0, contest.ratio(peer, "navfmu"))
    return contest


if __name__ == "__main__":
    main(run)
