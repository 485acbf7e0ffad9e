"""Failures in several sizes: what is flown is what was injected, larger or smaller, and nothing else."""

from __future__ import annotations

import pytest

from evidence import fmea
from evidence.failures.injection import Injection
from evidence.failures.sizes import Size, Sized, load_sizes, row, scaled, told
from navfmu.campaign import load_campaign
from navfmu.campaign.case import Case
from navfmu.faults import Fault
from tests.evidence.test_fmea import sighting

LOST = Fault("lost", "gps.jammed", "input", start=300.0)


@pytest.mark.parametrize(
    ("value", "twice", "said"),
    [
        (6e-6, 1.2e-5, "6e-06"),
        ("1 nmi", "2.0 nmi", "1"),
        ([-10.0, 0.0, 3.0], [-20.0, 0.0, 6.0], "10"),
        (["1 nmi", "0 nmi"], ["2.0 nmi", "0.0 nmi"], "1"),
    ],
)
def test_every_form_of_a_value_is_scaled_and_told(value, twice, said):
    assert scaled(value, 2) == twice and told(value, 1.0) == said


def test_a_value_is_told_in_its_unit():
    assert told(6e-6, 1e-6) == "6" and told(1.667e-9, 1.6667e-9) == "1"


def test_only_the_size_of_the_failure_itself_changes():
    """Neither the loss of GPS, nor its times, nor the case's parameters."""
    fault = Fault("echo", "dme.echo[1]", "input", start=900.0, value="1 nmi", mttf=240.0, mttr=60.0, fmea="F30")
    case = Case("backup: echo", faults=(LOST, fault), parameters={"dme.gate": 5.0}, written="backup")
    sizes = Sized(Size(failure="echo", unit="nmi", times=[0.5, 2.0]), case, ("echo",))
    assert sizes.told == ["0.5", "2"]
    small, large = sizes.cases
    assert [small.name, large.name] == ["backup: echo x 0.5", "backup: echo x 2"]
    for found, size in ((small, "0.5 nmi"), (large, "2.0 nmi")):
        assert found.faults[0] is LOST and found.parameters == case.parameters and found.written == "backup"
        assert found.faults[1] == Fault(
            "echo", "dme.echo[1]", "input", start=900.0, value=size, mttf=240.0, mttr=60.0, fmea="F30"
        )


def test_the_size_may_be_a_parameter():
    case = Case("offset", faults=(LOST,), parameters={"dme.receiver_offset": 200.0, "dme.mode": 3})
    (found,) = Sized(Size(failure="offset", parameter="dme.receiver_offset", unit="m", times=[2.0]), case, ()).cases
    assert found.parameters == {"dme.receiver_offset": 400.0, "dme.mode": 3} and found.faults == case.faults
    shear = Size(failure="shear", parameter="wind.shear_n", base=[-10.0, 0.0, 0.0], unit="m/s", times=[0.5])
    (found,) = Sized(shear, Case("shear"), ()).cases
    assert found.parameters == {"wind.shear_n": [-5.0, 0.0, 0.0]}


def test_flights_are_counted_by_size():
    """Harm from the size at which most flights have it; a sign that comes at none has no such size."""
    fault = Fault("x", "dme.delay_change[1]", "input", start=900.0, value=6e-6, fmea="F31")
    sizes = Sized(Size(failure="x", unit="us", one=1e-6, times=[1, 2, 4]), Case("c: x", faults=(fault,)), ("x",))
    quiet, bad = sighting({}, [True]), sighting({}, [False], True)
    seen = sighting({"A": 1.0}, [False], True)
    flown = [
        Injection(case, "main", case.faults, "none", ("F31",), 900.0, runs, 0, ("A",), ())
        for case, runs in zip(sizes.cases, [(quiet, bad, quiet), (bad, bad, quiet), (bad, bad, seen)], strict=True)
    ]
    expected = ["x", "6, 12, 24 us", "3", "1, 2, 3", "0, 0, 1", "1, 2, 2", "12 us", "-"]
    assert row(sizes, flown[::-1]) == expected and len(fmea.OF_SIZES) == len(expected)


def test_every_failure_of_the_file_is_one_of_a_campaign():
    """One that is in none would be left out without a word."""
    names = []
    for campaign in map(load_campaign, fmea.CAMPAIGNS):
        (variant,) = campaign.systems
        for case in campaign.cases:
            own = [fault for fault in case.faults if fault.id != "gps-jammed"]
            names.append((own[0].id if len(own) == 1 else case.name) + f" ({variant})" * (variant != "main"))
    for size in load_sizes(fmea.SIZES).size:
        assert names.count(size.failure) == 1, size.failure
