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


def test_a_set_with_a_wrong_name_is_refused_with_the_nearest(folder):
    class Ramp2(Ramp):
        name = "ramp"
        parameter_sets = {"wrong": ParameterSet("No source.", {"slop": 1.0})}  # noqa: RUF012

    with pytest.raises(NavfmuError, match=r"ramp, parameter set 'wrong': .*'slop'.*'slope'"):
        write(Ramp2, folder)
