"""A campaign as a simulation task of SSP Traceability."""

from __future__ import annotations

from pathlib import Path

from navfmu.campaign.outcome import Outcome
from navfmu.campaign.report import FILES, provenance
from navfmu.campaign.seeds import seeds_text
from navfmu.campaign.tested import days
from navfmu.files.checkout import commit_of
from navfmu.files.reading import what_is
from navfmu.files.writing import write_file
from navfmu.ssp.traceability import Particle, Resource, Step, document
from navfmu.system.traceability import of_result, of_system

VERDICTS = "verdicts.csv"


def write_task(outcome: Outcome, file: Path) -> Path:
    """Write what was run, which files came of it, and how they were judged."""
    campaign, folder, about = outcome.campaign, outcome.folder.absolute(), provenance(outcome)
    found = [folder / name for name in FILES if what_is(folder / name) == "a file"]
    own = {"campaign": {"commit": commit_of(campaign.path)}} if commit_of(campaign.path) else {}
    inputs = [
        *map(of_system, campaign.systems.values()),
        Resource("testcase", Path(campaign.path).absolute(), about=own),
    ]
    experiment = {
        "variants": ", ".join(campaign.systems),
        "cases": str(len(campaign.cases)),
        "runs": str(len(outcome.runs)),
        "seeds": seeds_text(campaign.seeds),
        "stop (s)": f"{campaign.stop:g}",
        "steps (s)": ", ".join(f"{step:g}" for step in dict.fromkeys(campaign.steps)),
        "algorithm": campaign.algorithm,
        "flown": days(outcome),
    }
    command = Resource("configuration", text=about["command"], type="text/x-shellscript")
    how = {"experiment": {name: value for name, value in experiment.items() if value}, "versions": about["versions"]}
    flown = [one for one in found if one.suffix != ".html" and one.name != VERDICTS]
    execute = Step(Particle(tuple(inputs)), Particle((command,), how), Particle(tuple(map(of_result, flown))))
    steps = {"ExecuteSimulation": execute}
    if campaign.requirements:
        asked = "\n".join(f"{one.id}: {one.sentence}" for one in campaign.requirements)
        verdicts = {f"{cell.requirement.id}, {cell.variant}, {cell.case}": cell.verdict for cell in outcome.cells}
        judged = tuple(of_result(one) for one in found if one not in flown)
        steps["EvaluateSimulationResults"] = Step(
            Particle((Resource("requirement", text=asked),)),
            Particle(),
            Particle(judged, {"verdicts": verdicts}),
        )
    return write_file(file, document(campaign.name, "", steps, file.parent))
