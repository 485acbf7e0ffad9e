"""Runs a system of which one FMU ends the process. Started by ``test_blackbox.py``, not by pytest.

The arguments are the file of the black box, how the FMU ends the process, and in which call.
"""

import sys

from navfmu.engine import compiled
from navfmu.engine.blackbox import BlackBox
from navfmu.engine.link import Link
from navfmu.engine.plan import Plan, make_plan
from tests.engine.probe import probe

WAYS = {"segfault": 10, "abort": 11, "exit": 12, "hang": 13}
CALLS = {"doStep": 0, "exitInitializationMode": 1, "getReal": 2, "enterInitializationMode": 5, "terminate": 6}


def plan(way: str, call: str) -> Plan:
    """Two lags, the second of which ends the process: at 0.5 s, if not before."""
    if call == "instantiate":
        bad = probe("bad", guid=f"{{dies}}{WAYS[way]}")
    else:
        bad = probe("bad", fail_call=CALLS[call], fail_status=WAYS[way], fail_at=0.45 * (call == "doStep"))
    system = [probe("good", start=1.0), bad], [Link("good.y", "bad.u")]
    return make_plan(*system, step=0.1, stop=1.0, record=["good.y", "bad.y"], record_period=0.2)


if __name__ == "__main__":
    path, *what = sys.argv[1:]
    flight = plan(*what)
    compiled.run(flight, memory=BlackBox.open(path, flight))
