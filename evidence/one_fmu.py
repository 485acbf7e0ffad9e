"""``python -m evidence.one_fmu HOST FILE STOP STEP START ANSWER``: one FMU in one host, alone in its process.

START are start values by variable, as JSON. FMUs of others crash, exit and hang; so each has a process of its own, and
what it leaves is the file ANSWER.
"""

from __future__ import annotations

import json
import sys
import warnings
from pathlib import Path

import numpy as np

Start = dict[str, float]
Answer = dict[str, list[float]]  # the times (s) under "time", and the values of each output


def fmpy(file: str, stop: float, step: float, start: Start) -> Answer:
    """All outputs as FMPy's ``simulate_fmu`` records them."""
    import fmpy

    description = fmpy.read_model_description(file, validate=False)
    names = [v.name for v in description.modelVariables if v.causality == "output" and v.type != "String"]
    times = {"start_time": 0.0, "stop_time": stop, "output_interval": step}
    result = fmpy.simulate_fmu(file, **times, fmi_type="CoSimulation", output=names, start_values=start, validate=False)
    return {name: np.asarray(result[name], float).tolist() for name in ("time", *names)}


def navfmu(file: str, stop: float, step: float, start: Start) -> Answer:
    """All outputs as our master records them."""
    from navfmu import System

    warnings.simplefilter("ignore")
    system = System.load(file)
    (component,) = system.fmus
    parameters = {f"{component}.{name}": value for name, value in start.items()}
    frame = system.run(stop=stop, step=step, record_period=step, parameters=parameters)
    columns = {name.removeprefix(f"{component}."): frame[name].to_numpy(float).tolist() for name in frame}
    return {"time": frame.index.to_numpy(float).tolist(), **columns}


def main(host: str, file: str, stop: str, step: str, start: str, answer: str) -> None:
    """Run and write the answer, or why there is none."""
    try:
        made = {"fmpy": fmpy, "navfmu": navfmu}[host](file, float(stop), float(step), json.loads(start))
        content = {"values": made}
    except Exception as error:
        content = {"error": f"{error}".strip().partition("\n")[0] or type(error).__name__}
    Path(answer).write_text(json.dumps(content), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
