"""Parameter sets beside an FMU: files that any tool which reads SSP can give an instance of it."""

from __future__ import annotations

import numpy as np
import pytest
from lxml import etree

from navfmu import System
from navfmu.errors import NavfmuError
from navfmu.export import Component, Output, Parameter, ParameterSet, every
from navfmu.export.build import build
from navfmu.export.parameter_sets import write
from navfmu.ssp.document import NAMESPACES, schema
from navfmu.ssp.writer import SystemSource


class Ramp(Component):
    """A ramp."""

    slope = Parameter("1/s", start=1.0, description="slope")
    level = Parameter(2, "1", start=(1.0, 2.0), description="levels")
    sample_period = Parameter("s", start=0.1, min=0.01, description="period")
    height = Output(2, "1", description="height")

    parameter_sets = {  # noqa: RUF012
        "steep": ParameterSet("A mountain, page 3.", {"slope": 5.0}),
        "high": ParameterSet('"Up" & above.', {"level": 7.0}),
    }

    @every("sample_period")
    def climb(self):
        self.height = self.level + self.slope * self.time


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sets")
    build([Ramp], folder)
    write(Ramp, folder)
    return folder


def test_a_set_is_a_valid_document_with_its_source(folder):
    rules = etree.XMLSchema(etree.parse(schema("SystemStructureParameterValues")))
    for name, of in Ramp.parameter_sets.items():
        document = etree.parse(folder / "parameters" / f"ramp_{name}.ssv")
        rules.assertValid(document)
        assert document.getroot().get("description") == of.source


def test_every_set_names_what_any_of_them_names(folder):
    """Left out, a parameter would keep the value of the set before: a mountain as high as the tower."""
    for name, values in {"steep": [1.0, 2.0, 5.0], "high": [7.0, 7.0, 1.0]}.items():
        document = etree.parse(folder / "parameters" / f"ramp_{name}.ssv")
        found = {p.get("name"): float(p[0].get("value")) for p in document.iterfind(".//ssv:Parameter", NAMESPACES)}
        assert [found.pop(n) for n in ("level[1]", "level[2]", "slope")] == values
        assert not found  # sample_period is in no set


def test_a_system_that_binds_the_file_runs_with_its_values(folder, tmp_path):
    source = SystemSource("climb", fmus=folder, stop_time=1.0, step=0.1)
    source.component("ramp", "ramp.fmu")
    source.parameters("ramp", {"slope": 2.0}, name="ramp")
    source.write(tmp_path)
    (tmp_path / "resources" / "ramp.ssv").write_bytes((folder / "parameters" / "ramp_steep.ssv").read_bytes())
    run = System.load(tmp_path).run(record=["ramp.height"])
    np.testing.assert_allclose(run["ramp.height[2]"].iloc[-1], 7.0, rtol=1e-12)


def test_a_system_is_written_from_the_file(folder, tmp_path):
    """Its units, too: a file in 1/h, as another tool may write it, is not taken for one in 1/s."""
    file = folder / "parameters" / "ramp_steep.ssv"
    slow = tmp_path / "ramp_slow.ssv"
    text = file.read_text(encoding="utf-8")
    for own, other in (
        ('value="5.0" unit="1/s"', 'value="5.0" unit="1/h"'),
        ('<ssc:Unit name="1/s">', '<ssc:Unit name="1/h">'),
        ('<ssc:BaseUnit s="-1"/>', '<ssc:BaseUnit s="-1" factor="0.0002777777777777778"/>'),
    ):
        assert text.count(own) == 1
        text = text.replace(own, other)
    slow.write_text(text, encoding="utf-8")
    for path, end in ((file, 7.0), (slow, 2.0 + 5.0 / 3600.0)):
        source = SystemSource("climb", fmus=folder, stop_time=1.0, step=0.1)
        source.component("ramp", "ramp.fmu").parameters("ramp", path)
        written = source.write(tmp_path / path.stem)
        assert tmp_path / path.stem / "resources" / f"{path.stem}.ssv" in written
        run = System.load(tmp_path / path.stem).run(record=["ramp.height"])
        np.testing.assert_allclose(run["ramp.height[2]"].iloc[-1], end, rtol=1e-9)


def test_a_file_that_is_no_parameter_set_is_refused(folder, tmp_path):
    source = SystemSource("climb", fmus=folder).component("ramp", "ramp.fmu")
    with pytest.raises(NavfmuError, match=r"nowhere\.ssv"):
        source.parameters("ramp", tmp_path / "nowhere.ssv")


def test_a_set_with_a_wrong_name_is_refused_with_the_nearest(folder):
    class Ramp2(Ramp):
        name = "ramp"
        parameter_sets = {"wrong": ParameterSet("No source.", {"slop": 1.0})}  # noqa: RUF012

    with pytest.raises(NavfmuError, match=r"ramp, parameter set 'wrong': .*'slop'.*'slope'"):
        write(Ramp2, folder)
