"""JUnit XML: what servers accept, what is counted, and what a failure says."""

from __future__ import annotations

import shlex
import subprocess
import sys
from pathlib import Path

import pandas
import pytest
from click.testing import CliRunner
from lxml import etree

from navfmu.cli.main import main
from tests.campaign.axes import CASES, HEAD, written

# What Jenkins (its xunit plugin) and pytest take JUnit XML to be, in the elements and attributes that concern us here.
GRAMMAR = etree.RelaxNG(
    etree.fromstring("""
<grammar xmlns="http://relaxng.org/ns/structure/1.0" datatypeLibrary="http://www.w3.org/2001/XMLSchema-datatypes">
  <start>
    <element name="testsuites">
      <optional><attribute name="name"/></optional>
      <zeroOrMore><ref name="suite"/></zeroOrMore>
    </element>
  </start>
  <define name="suite">
    <element name="testsuite">
      <attribute name="name"/>
      <attribute name="tests"><data type="nonNegativeInteger"/></attribute>
      <attribute name="failures"><data type="nonNegativeInteger"/></attribute>
      <attribute name="errors"><data type="nonNegativeInteger"/></attribute>
      <optional><attribute name="skipped"><data type="nonNegativeInteger"/></attribute></optional>
      <optional><attribute name="time"><data type="decimal"/></attribute></optional>
      <optional><attribute name="timestamp"/></optional>
      <optional><attribute name="hostname"/></optional>
      <zeroOrMore><ref name="case"/></zeroOrMore>
    </element>
  </define>
  <define name="case">
    <element name="testcase">
      <attribute name="name"/>
      <optional><attribute name="classname"/></optional>
      <optional><attribute name="time"/></optional>
      <zeroOrMore>
        <choice>
          <ref name="failure"/><ref name="error"/>
          <element name="system-out"><text/></element>
          <element name="system-err"><text/></element>
        </choice>
      </zeroOrMore>
    </element>
  </define>
  <define name="failure">
    <element name="failure">
      <optional><attribute name="type"/></optional><optional><attribute name="message"/></optional><text/>
    </element>
  </define>
  <define name="error">
    <element name="error">
      <optional><attribute name="type"/></optional><optional><attribute name="message"/></optional><text/>
    </element>
  </define>
</grammar>
""")
)
REQUIREMENTS = """
[[requirement]]
id = "R-1"
description = "a length in reach"
signal = "estimator.solution.length"
at_most = 1.0
percent = 90

[[requirement]]
id = "R-2"
signal = "lag.y"
at_most = 100.0
cases = ["nominal"]

[[requirement]]
id = "R-3"
signal = "estimator.solution.length"
at_most = 0.5
quantile = 0.5
"""


def junit(folder: Path, text: str) -> etree._Element:
    """The verdicts of a campaign, as the command writes them."""
    file = written(folder, text, HEAD + 'seeds = "1-2"\n')
    words = ["campaign", str(file), "--out", str(folder / "out"), "--junit", str(folder / "v.xml")]
    result = CliRunner().invoke(main, [*words, "--workers", "thread"])
    assert result.exit_code == 0, result.output
    found = etree.parse(folder / "v.xml")
    GRAMMAR.assertValid(found)
    return found.getroot()


def test_pytest_itself_writes_what_the_grammar_takes(tmp_path):
    """The grammar is ours: were it looser or other than the format, this would tell."""
    (tmp_path / "test_x.py").write_text("def test_a():\n    assert 0\ndef test_b():\n    pass\n")
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--junitxml", "x.xml", "test_x.py"]
    subprocess.run(command, cwd=tmp_path, capture_output=True)
    found = etree.parse(tmp_path / "x.xml")
    GRAMMAR.assertValid(found)
    for name in ("name", "tests", "failures", "errors"):
        broken = etree.parse(tmp_path / "x.xml")
        del broken.getroot()[0].attrib[name]
        assert not GRAMMAR.validate(broken)


def test_one_test_case_for_each_requirement_variant_and_case(tmp_path):
    suite = junit(tmp_path, CASES + REQUIREMENTS)[0]
    verdicts = pandas.read_csv(tmp_path / "out" / "verdicts.csv")
    cases = [(case.get("classname"), case.get("name").split(":")[0], len(case) == 0) for case in suite]
    rows = [(f"campaign.main.{v.case}", v.requirement, v.verdict == "holds") for v in verdicts.itertuples()]
    assert cases == rows and len(rows) == 3 + 1 + 3
    assert 0 < suite.findall(".//failure").__len__() == int(suite.get("failures")) < 7
    assert (suite.get("tests"), suite.get("errors"), suite.get("name")) == ("7", "0", "campaign")


def test_a_failure_says_which_requirement_when_by_how_much_and_how_to_repeat_it(tmp_path):
    suite = junit(tmp_path, CASES + REQUIREMENTS)[0]
    rows = pandas.read_csv(tmp_path / "out" / "runs.csv").query("case == 'both' and requirement == 'R-1'")
    (case,) = [c for c in suite if c.get("classname").endswith("both") and c.get("name").startswith("R-1")]
    failure = case[0]
    assert failure.get("message").startswith("requirement R-1 held in 0 of 2 runs; worst: seed")
    assert failure.text.startswith(
        "requirement R-1 (estimator.solution.length <= 1 m for 90 % of the time)\na length in"
    )
    for row in rows.itertuples():
        said = next(line for line in failure.text.split("\n") if line.startswith(f"seed {row.seed}: "))
        assert f"first violated at t = {row.first_violation:.9g} s" in said
        assert f"worst {row.worst:.4g} m at t = {row.worst_time:.9g} s" in said
        assert f"({row.worst - 1.0:.4g} m beyond the bound)" in said
    command = shlex.split(failure.text.split("\n")[-1])
    out = tmp_path / "again.parquet"
    assert CliRunner().invoke(main, [*command[1:], "--out", str(out)]).exit_code == 0
    worst = rows.loc[rows["percent"].idxmin()]
    assert pandas.read_parquet(out)["estimator.solution.length"].max() == worst.worst


def test_a_run_that_ends_with_an_error_is_one(tmp_path, monkeypatch):
    from navfmu.engine.recording import RunError
    from navfmu.system.experiment import Experiment

    fly = Experiment.run

    def failing(self, *rest, **more):
        if self.faults and self.seed == 2:
            raise RunError("component 'lag': it broke \x00\x1b[2J (fmi2DoStep returned Error at t = 3 s)")
        return fly(self, *rest, **more)

    monkeypatch.setattr(Experiment, "run", failing)
    suite = junit(tmp_path, CASES + REQUIREMENTS.replace("at_most = 1.0", "at_most = 100.0"))[0]
    wrong = [case for case in suite if case.get("name") == "every run ends well"]
    assert [case.get("classname") for case in wrong] == ["campaign.main.drift", "campaign.main.both"]
    assert all("seed 2: component 'lag': it broke" in case[0].text and case[0].tag == "error" for case in wrong)
    assert suite.get("errors") == "2" and all("--seed 2" in case[0].text for case in wrong)
    (held,) = [c for c in suite if c.get("classname").endswith("drift") and c.get("name").startswith("R-1")]
    assert "1 ended with an error" in held[0].get("message") and "seed 2: component 'lag'" in held[0].text


def test_events_are_counted_and_what_is_no_bound_has_no_worst_value(tmp_path):
    """The source is 10 sin(t / 5 s): below 1 m up to 0.501 s, at 6 of 21 points, and above it up to the end at 2 s."""
    text = CASES + '\n[[requirement]]\nid = "E"\nevents = "truth.y > 1 m"\nat_most = 0\n'
    text += '\n[[requirement]]\nid = "T"\nsignal = "truth.y < 1 m"\n'
    cases = {case.get("name")[0]: case for case in junit(tmp_path, text)[0] if "nominal" in case.get("classname")}
    said = {name: case[0].text.split("\n")[2] for name, case in cases.items()}
    assert said["E"] == "seed 1: 1 time, first at t = 0.6 s"
    assert said["T"] == "seed 1: inside for 28.5 % of the time, first violated at t = 0.6 s"


def test_names_with_points_make_no_further_levels(tmp_path):
    text = CASES + '\n[[axis]]\nvary = "fault.D.rate"\nvalues = [0.25]\n' + REQUIREMENTS
    names = {case.get("classname") for case in junit(tmp_path, text)[0]}
    assert len(names) == 3 and all(name.count(".") == 2 for name in names)


@pytest.mark.parametrize(("name", "sentence"), [("v.txt", "expected .xml at its end"), ("d.xml", "d.xml: is a folder")])
def test_a_file_that_cannot_be_written_is_refused_before_anything_is_flown(tmp_path, name, sentence):
    (tmp_path / "d.xml").mkdir()
    file = written(tmp_path, CASES)
    out = tmp_path / "out"
    result = CliRunner().invoke(main, ["campaign", str(file), "--out", str(out), "--junit", str(tmp_path / name)])
    assert result.exit_code == 2 and sentence in result.stderr and not out.exists()
