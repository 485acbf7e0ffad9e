"""Which pictures a variant in a case gets, and what they are drawn from."""

from __future__ import annotations

from collections.abc import Sequence

from navfmu.campaign import valued
from navfmu.campaign.case import Case
from navfmu.campaign.outcome import Judged, Outcome
from navfmu.errors import NavfmuError
from navfmu.report.kind import Picture
from navfmu.report.pictures import percentiles
from navfmu.report.scene import Bound, Recorded, Scene
from navfmu.system.assembly import Assembly
from navfmu.system.scene import scene_of


def pictures_of(outcome: Outcome, variant: str, case: Case) -> list[Picture]:
    """Those of the system's report file, and what requirements put bounds on here and has no picture there."""
    campaign = outcome.campaign
    system = campaign.systems[variant]
    found = list(system.report.pictures) if system.report else []
    shown = {name for picture in found if isinstance(picture, percentiles.Picture) for name in picture.needs()}
    asked = [requirement for requirement in campaign.requirements if requirement.applies(variant, case)]
    for name, requirement in {requirement.signal: requirement for requirement in asked}.items():
        if requirement.signals != [name]:
            if requirement.kind == "signal" and not requirement.truth:
                found.append(valued.Picture(kind="percentiles", signal=name, requirement=requirement))
        elif name not in shown and _is_real(system, name):
            found.append(percentiles.Picture(kind="percentiles", signal=name))
    return found


def _is_real(system: Assembly, name: str) -> bool:
    try:
        return system.variable(name.removesuffix("@true")).type == "Real"
    except NavfmuError:  # another variant's
        return False


def scene(outcome: Outcome, variant: str, case: Case, picture: Picture, runs: Sequence[Judged], shown: Judged) -> Scene:
    """What a picture of these runs is drawn from; pictures of one run show ``shown``."""
    signals = picture.needs()
    drawn = runs if picture.many else [shown]
    series = {judged.run.key: recorded(outcome, judged, signals) for judged in drawn}
    return scene_of(
        picture,
        shown.run.experiment,
        list(series.values()),
        series[shown.run.key],
        [judged.answer.acted for judged in drawn],
        f"{variant}, {case.name}",
        bounds_of(outcome, variant, case),
    )


def recorded(outcome: Outcome, judged: Judged, signals: Sequence[str]) -> Recorded:
    """Recorded signals of a run."""
    series = outcome.series(judged, signals)
    return Recorded(f"seed {judged.run.seed}", series.pop("time"), series, judged.run.experiment.points)


def bounds_of(outcome: Outcome, variant: str, case: Case) -> list[Bound]:
    """What requirements ask of a variant in a case."""
    return [
        Bound(r.id, r.signal, r.least, r.most, r.unit, r.start, r.end)
        for r in outcome.campaign.requirements
        if r.kind == "signal" and r.applies(variant, case)
    ]
