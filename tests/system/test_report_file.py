"""Report files: the one that ships, and the one in the documentation, fit the backup navigator and name every kind."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from navfmu import System
from navfmu.files.toml import Document
from navfmu.system.report_file import PICTURES, STATISTICS, ReportFile
from system_ssp.backup_navigator.system import FMUS, source
from tests import built

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def package(tmp_path_factory) -> Path:
    for name in FMUS:
        built.fmu(name, tmp_path_factory)
    fmus = built.folder(tmp_path_factory)
    return source(fmus).pack(tmp_path_factory.mktemp("report") / "backup_navigator.ssp")


def test_the_backup_navigator_records_what_it_did_before_it_had_a_file(package):
    system = System.load(package, "scanning")
    assert {name.partition(".")[0] for name in system.signals()} == {"evaluation", "navigator"}
    outputs = [
        f"{name}.{variable.name}"
        for name in ("evaluation", "navigator")
        for variable in system.fmus[name].description.variables
        if variable.causality == "output"
    ]
    assert system.signals() == outputs
    assert [picture.kind for picture in system.report.pictures] == ["percentiles", "sigma", "map"]


def test_the_documented_file_names_every_kind_and_fits(package):
    text = (ROOT / "docs" / "reports.md").read_text()
    example = re.search(r"```toml\n(.*?)```", text, re.DOTALL)[1]
    report = ReportFile.of(Document(example, "docs/reports.md"), System.load(package).fmus)
    assert {picture.kind for picture in report.pictures} == set(PICTURES)
    assert {statistic.kind for statistic in report.statistics} == set(STATISTICS)
