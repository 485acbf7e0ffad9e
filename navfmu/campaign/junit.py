"""Verdicts of a campaign as JUnit XML, the format in which servers take the results of tests."""

from __future__ import annotations

from pathlib import Path

from lxml import etree

from navfmu.campaign.judged import Judged
from navfmu.campaign.outcome import Cell, Outcome
from navfmu.errors import visible
from navfmu.files.writing import write_file

WELL = "every run ends well"  # name of the test case of what no requirement asks


def write_junit(outcome: Outcome, path: str | Path) -> Path:
    """Write a test case for each requirement, variant and case, and one for each variant and case that went wrong."""
    suite = etree.Element("testsuite", name=visible(outcome.campaign.name))
    for cell in outcome.cells:
        case = _testcase(suite, outcome, cell.variant, cell.case, f"{cell.requirement.id}: {cell.requirement.sentence}")
        if not cell.passed:
            _add(case, "failure", f"requirement {cell.requirement.id} {cell.sentence}", violation(outcome, cell))
    for (variant, name), sentences in _wrong(outcome).items():
        case = _testcase(suite, outcome, variant, name, WELL)
        _add(case, "error", sentences[0], "\n".join(sentences))
    suite.set("tests", str(len(suite)))
    suite.set("failures", str(len(suite.findall(".//failure"))))
    suite.set("errors", str(len(suite.findall(".//error"))))
    suites = etree.Element("testsuites")
    suites.append(suite)
    return write_file(path, etree.tostring(suites, xml_declaration=True, encoding="UTF-8", pretty_print=True))


def _testcase(suite: etree._Element, outcome: Outcome, variant: str, case: str, name: str) -> etree._Element:
    """A test case; servers make a tree of the points of its class name."""
    inner = ".".join(part.replace(".", "\N{ONE DOT LEADER}") for part in (outcome.campaign.name, variant, case))
    return etree.SubElement(suite, "testcase", classname=visible(inner), name=visible(name))


def _add(case: etree._Element, kind: str, message: str, text: str) -> None:
    element = etree.SubElement(case, kind, message=visible(message))
    element.text = "\n".join(map(visible, text.split("\n")))


def violation(outcome: Outcome, cell: Cell) -> str:
    """Which requirement, when, by how much, and the command that repeats the worst run."""
    requirement, worst = cell.requirement, cell.worst
    lines = [f"requirement {requirement.id} ({requirement.sentence})", cell.sentence]
    if requirement.description:
        lines.insert(1, requirement.description)
    for judged in outcome.of(cell.variant, cell.case):
        finding = judged.findings.get(requirement.id)
        if requirement.quantile is None and finding is not None and not judged.holds(requirement):
            lines.append(f"seed {judged.run.seed}: {requirement.question.seen(requirement, finding)}")
    failed = [judged for judged in outcome.of(cell.variant, cell.case) if judged.error is not None]
    lines += [f"seed {judged.run.seed}: {judged.error}" for judged in failed]
    shown = worst or next(iter(failed), None)
    if shown is not None:
        lines += [f"seed {shown.run.seed} again:", shown.run.experiment.command()]
    return "\n".join(lines)


def _wrong(outcome: Outcome) -> dict[tuple[str, str], list[str]]:
    """What is wrong beside requirements, by variant and case; each is a reason why the campaign does not pass."""
    found: dict[tuple[str, str], list[str]] = {}

    def say(judged: Judged, sentence: str) -> None:
        again = judged.run.experiment.command()
        place = judged.run.variant, judged.run.case.name
        found.setdefault(place, []).append(f"seed {judged.run.seed}: {sentence}\n{again}")

    for judged in outcome.every:
        if judged.error is not None:
            say(judged, judged.error)
        for signal, count in judged.answer.not_finite.items():
            say(judged, f"{signal} is not finite at {count} recorded points")
    for (variant, case, fault, why), seeds in outcome.idle.items():
        sentence = f"fault '{fault}' {why} (seeds {', '.join(map(str, seeds))})"
        found.setdefault((variant, case), []).append(sentence)
    return found
