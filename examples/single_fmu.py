"""One component in a host that is not ours: the DME receiver in FMPy.

    python examples/single_fmu.py [dist/dme.fmu]

An aircraft flies east past Livermore at 50 m/s; the receiver takes the two stations in turn, every 15 s.
"""

import sys

import numpy as np
from fmpy import simulate_fmu

fmu = sys.argv[1] if len(sys.argv) > 1 else "dist/dme.fmu"
time = np.arange(0.0, 121.0)
columns = ["time", "latitude", "longitude", "altitude", *(f"velocity_n[{i}]" for i in (1, 2, 3))]
switches = [f"station_off[{i}]" for i in range(1, 6)]
truth = np.zeros(len(time), [(name, float) for name in columns] + [(name, bool) for name in switches])
truth["time"] = time
truth["latitude"] = np.radians(37.7)
truth["longitude"] = np.radians(-121.8) + 50.0 * time / (6378137.0 * np.cos(np.radians(37.7)))
truth["altitude"] = 1500.0
truth["velocity_n[2]"] = 50.0

ranges = [f"ranging.slant_range[{i}]" for i in (1, 2)]
result = simulate_fmu(
    fmu,
    stop_time=120.0,
    step_size=1.0,
    start_values={"mode": 1, "seed": 7},
    input=truth,
    output=["ranging.sequence", *ranges],
)
last = 0
for row in result:
    if row["ranging.sequence"] != last:
        last = row["ranging.sequence"]
        print(f"t = {row['time']:5.1f} s  " + "  ".join(f"{row[name] / 1852.0:7.3f} nmi" for name in ranges))
