"""Axes: which cases come of them, with which values, and what tables say of them."""

from __future__ import annotations

import itertools
import re
from pathlib import Path

import numpy as np
import pandas
import pytest

from navfmu import Fault
from navfmu.campaign import load_campaign, run_campaign
from navfmu.campaign.axis import Axis, Listed, Span
from navfmu.campaign.design import Design
from navfmu.campaign.runs import experiment_of, runs_of
from navfmu.errors import NavfmuError
from tests import built
from tests.campaign.axes import BIAS, CASES, loaded, written

ROOT = Path(__file__).parents[2]


# ---- designs ---------------------------------------------------------------------------------------------------------


def axis(values: Listed | Span, name: str = "a") -> Axis:
    return Axis(name, (), values)


def test_a_grid_has_equal_steps_or_equal_ratios_and_its_ends():
    linear, ratios = Span(1.0, 4.0, False, 4).levels, Span(0.01, 100.0, True, 5).levels
    assert linear == (1.0, 2.0, 3.0, 4.0)
    assert ratios == pytest.approx((0.01, 0.1, 1.0, 10.0, 100.0), rel=1e-15)
    assert (ratios[0], ratios[-1]) == (0.01, 100.0)


def test_a_latin_hypercube_has_one_point_in_every_share_of_every_axis():
    """Independent draws would leave a share empty with a probability of 1 - 1e-13 at this number."""
    count = 37
    axes = [axis(Span(2.0, 4.0)), axis(Span(1e-3, 1e3, logarithmic=True)), axis(Span(-1.0, 0.0))]
    points = np.array(list(Design("latin_hypercube", count, 5).points(axes)))
    shares = (points[:, 0] - 2.0) / 2.0, (np.log10(points[:, 1]) + 3.0) / 6.0, points[:, 2] + 1.0
    for share in shares:
        assert sorted(np.floor(count * share).astype(int)) == list(range(count))
    assert abs(np.corrcoef(np.array(shares))[np.triu_indices(3, 1)]).max() < 0.8  # not one diagonal


def test_sobol_points_are_a_net():
    """Every box of area 1/n with sides that are powers of 2 holds one of n points, as no grid and no chance has it."""
    power = 6
    points = np.array(list(Design("sobol", 2**power, 3).points([axis(Span(0.0, 1.0)), axis(Span(0.0, 1.0))])))
    for k in range(power + 1):
        boxes = np.floor(points * [2**k, 2 ** (power - k)]).astype(int)
        assert len({tuple(box) for box in boxes}) == 2**power, k


@pytest.mark.parametrize("kind", ["latin_hypercube", "sobol"])
def test_drawn_points_depend_on_the_seed_and_on_nothing_else(kind):
    axes = [axis(Span(0.0, 1.0)), axis(Span(0.0, 1.0))]
    first, again, other = (list(Design(kind, 8, seed).points(axes)) for seed in (1, 1, 2))
    assert first == again != other


@pytest.mark.parametrize("kind", ["latin_hypercube", "sobol"])
def test_values_one_by_one_have_equal_shares_of_the_points_that_are_drawn(kind):
    points = list(Design(kind, 16, 1).points([axis(Listed(("x", "y", "z", "w")))]))
    assert {value: points.count((value,)) for value in "xyzw"} == dict.fromkeys("xyzw", 4)


# ---- cases -----------------------------------------------------------------------------------------------------------

GRID = """
[[axis]]
vary = "fault.D.rate"
values = ["10 mm/s", "20 mm/s"]

[[axis]]
name = "onset"
vary = ["fault.D.start", "fault.B.start"]
low = 0.5
high = 1.5
count = 3
cases = ["both"]

[[axis]]
vary = "parameter.lag.tau"
values = [1.0, 2]
cases = ["both", "nominal"]
"""


def test_a_factorial_design_is_every_value_with_every_other_in_the_cases_that_have_them(tmp_path):
    campaign = loaded(tmp_path, CASES + GRID)
    seen = []
    for case in campaign.cases:
        entries = [(fault.parameters["rate"], fault.start) for fault in case.faults if fault.id == "D"]
        entries += [fault.start for fault in case.faults if fault.id == "B"]
        seen.append((case.written, *entries, *case.parameters.values()))
    rates, onsets = ("10 mm/s", "20 mm/s"), (0.5, 1.0, 1.5)
    assert seen == [
        *(("nominal", tau) for tau in (1.0, 2)),
        *(("drift", (rate, 0.5)) for rate in rates),
        *(("both", (rate, t), t, tau) for rate, t, tau in itertools.product(rates, onsets, (1.0, 2))),
    ]
    assert campaign.size == 2 + 2 + 2 * 3 * 2 == len({case.name for case in campaign.cases})
    assert campaign.cases[-1].name == "both (D.rate=20 mm/s, onset=1.5, lag.tau=2)"


def test_a_point_is_the_experiment_that_one_writes_by_hand(tmp_path):
    """Same key: a value that went nowhere, or was written in another way, would make another one."""
    campaign = loaded(tmp_path, CASES + GRID)
    case = next(case for case in campaign.cases if case.name == "both (D.rate=20 mm/s, onset=1.5, lag.tau=2)")
    drift = Fault("D", "sensor.reading.length", "drift", start=1.5, rate="20 mm/s")
    bias = Fault("B", "sensor.reading.length", "bias", start=1.5, duration=1.0, value=2.0)
    by_hand = campaign.systems["main"].experiment(
        stop=2.0, step=0.1, seed=1, faults=[drift, bias], parameters={"lag.tau": 2},
        record=experiment_of(campaign, "main", case).record,
    )  # fmt: skip
    assert experiment_of(campaign, "main", case).key == by_hand.key
    assert "mm/s" in by_hand.command() and experiment_of(campaign, "main", case).command() == by_hand.command()


def test_a_fault_that_is_not_varied_stays_the_one_of_its_file(tmp_path):
    campaign = loaded(tmp_path, CASES + GRID)
    case = next(case for case in campaign.cases if case.written == "both")
    plain = loaded(tmp_path, CASES).cases[-1]
    bias, was = case.faults[1], plain.faults[1]
    assert (bias.parameters, bias.duration, bias.where) == (was.parameters, 1.0, was.where)
    assert case.faults[0].file == bias.file == ""  # neither is as the file has it


def test_one_element_of_a_list_varies(tmp_path):
    (tmp_path / "icing.toml").write_text(
        '[[fault]]\nid = "icing"\ntarget = ["lag.y", "sensor.reading.length"]\ntype = "bias"\nvalue = [1.0, "2 m"]\n'
    )
    text = '\n[[case]]\nname = "c"\nfaults = "icing.toml"\n\n[[axis]]\nvary = "fault.icing.value[2]"\nvalues = [3, 4]\n'
    cases = loaded(tmp_path, text).cases
    assert [case.faults[0].parameters["value"] for case in cases] == [[1.0, 3], [1.0, 4]]


def test_a_list_takes_the_values_of_all_axes_together(tmp_path):
    text = '\n[design]\nkind = "list"\n' + CASES
    text += '\n[[axis]]\nvary = "parameter.lag.tau"\nlow = 1\nhigh = 3\ncount = 3\n'
    text += '\n[[axis]]\nvary = "fault.D.rate"\nvalues = [0.1, 0.2, 0.3]\n'
    campaign = loaded(tmp_path, text)
    values = [tuple(case.values.values()) for case in campaign.cases]
    assert values == [(1.0,), (2.0,), (3.0,), *2 * [(1.0, 0.1), (2.0, 0.2), (3.0, 0.3)]]


def test_drawn_points_go_into_the_cases_that_have_the_axes(tmp_path):
    text = '\n[design]\nkind = "sobol"\ncount = 8\nseed = 4\n' + CASES
    text += '\n[[axis]]\nvary = "fault.D.rate"\nlow = "10 mm/s"\nhigh = "1000 mm/s"\nscale = "log"\n'
    text += '\n[[axis]]\nvary = "parameter.lag.tau"\nlow = 1.0\nhigh = 3.0\ncases = ["both"]\n'
    campaign = loaded(tmp_path, text)
    assert [case.written for case in campaign.cases] == ["nominal", *["drift"] * 8, *["both"] * 8]
    for case in campaign.cases[9:]:
        (rate, unit), tau = case.faults[0].parameters["rate"].split(), case.parameters["lag.tau"]
        assert (float(rate), unit, tau) == (case.values["D.rate"], "mm/s", case.values["lag.tau"])
    rates = [np.log10(case.values["D.rate"]) - 1.0 for case in campaign.cases[9:]]
    assert sorted(np.floor(4.0 * np.array(rates)).astype(int)) == list(range(8))


def test_faults_one_by_one_and_in_pairs(tmp_path):
    text = '\n[[case]]\nname = "one"\nfaults = "drift.toml"\neach = ["bias.toml", "noise.toml"]\n'
    text += '\n[[case]]\nname = "two"\npairs = ["drift.toml", "bias.toml", "noise.toml"]\n'
    text += '\n[[requirement]]\nid = "R"\nsignal = "lag.y"\nat_most = 100.0\ncases = ["two"]\n'
    campaign = loaded(tmp_path, text)
    assert [(case.name, [fault.id for fault in case.faults]) for case in campaign.cases] == [
        ("one: B", ["D", "B"]),
        ("one: N", ["D", "N"]),
        *((f"two: {a} + {b}", [a, b]) for a, b in itertools.combinations("DBN", 2)),
    ]
    recorded = [set(run.experiment.record) == {"lag.y"} for run in runs_of(campaign)]
    assert recorded == [False] * 2 + [True] * 3  # a requirement of the case in the file is asked of all that come of it


def test_what_files_have_alike_is_one_fault(tmp_path):
    """Each file of second failures has the first one, too."""
    drift = '[[fault]]\nid = "D"\ntarget = "sensor.reading.length"\ntype = "drift"\nrate = 1\nstart = "0.5 s"\n'
    text = '\n[[case]]\nname = "two"\nfaults = "drift.toml"\npairs = ["x.toml", "y.toml", "drift.toml"]\n'
    file = written(tmp_path, text)
    (tmp_path / "x.toml").write_text(drift + BIAS)
    (tmp_path / "y.toml").write_text(drift.replace("type", 'description = "again"\ntype') + BIAS.replace("B", "C"))
    assert [case.name for case in load_campaign(file).cases] == ["two: B + C"]
    (tmp_path / "y.toml").write_text(drift.replace("rate = 1", "rate = 3") + BIAS.replace("B", "C"))
    with pytest.raises(NavfmuError, match=r"line 8: two faults have the id 'D'"):
        load_campaign(file)


# ---- what becomes of them --------------------------------------------------------------------------------------------


def test_tables_have_a_column_for_each_axis(tmp_path):
    text = 'seeds = "1-2"\n' + CASES + GRID + '\n[[requirement]]\nid = "R"\nsignal = "lag.y"\nat_most = 100.0\n'
    campaign = loaded(tmp_path, text)
    outcome = run_campaign(campaign, tmp_path / "out", workers="thread")
    rows = pandas.read_csv(tmp_path / "out" / "runs.csv")
    assert list(rows.columns[:6]) == ["variant", "case", "D.rate (mm/s)", "onset", "lag.tau", "seed"]
    assert len(rows) == campaign.size == 2 * 16
    both = rows[rows["case"].str.startswith("both")]
    combinations = set(both[["D.rate (mm/s)", "onset", "lag.tau", "seed"]].itertuples(index=False, name=None))
    assert combinations == set(itertools.product((10.0, 20.0), (0.5, 1.0, 1.5), (1.0, 2.0), (1, 2)))
    nominal = rows[rows["case"].str.startswith("nominal")]
    assert nominal[["D.rate (mm/s)", "onset"]].isna().all(axis=None) and set(nominal["lag.tau"]) == {1.0, 2.0}
    for case, group in rows.groupby("case"):  # the columns are what the name says
        told = dict(re.findall(r"([\w.]+)=([\d.]+)", case))
        for column in ("D.rate (mm/s)", "onset", "lag.tau"):
            values = {f"{value:g}" for value in group[column].dropna()}
            assert values == ({told[column.split()[0]]} if column.split()[0] in told else set())
    verdicts = pandas.read_csv(tmp_path / "out" / "verdicts.csv")
    assert list(verdicts["case"]) == [case.name for case in campaign.cases] and set(verdicts["runs"]) == {2}
    assert outcome.passed and "both (D.rate=20 mm/s, onset=1.5, lag.tau=2)" in outcome.report.read_text()


def test_steps_that_vary_have_recordings_and_verdicts_of_their_own(tmp_path):
    """With h = 0.1 and 0.05 a lag of 1 s and sample period of 0.1 s after a step at 0.5 is told apart by its points."""
    text = '[[case]]\nname = "c"\n\n[[axis]]\nvary = "step"\nvalues = [0.1, "50 s"]\n'
    with pytest.raises(NavfmuError, match=r"line 9: 'values' have different units"):
        loaded(tmp_path, text)
    text = text.replace('"50 s"', "0.05") + '\n[[requirement]]\nid = "R"\nsignal = "lag.y"\nat_most = 100.0\n'
    text += "to = 1.05\n\n[[requirement]]\nid = 'Q'\nsignal = 'lag.y'\nat_most = 100.0\nquantile = 0.5\n"
    outcome = run_campaign(loaded(tmp_path, text), tmp_path / "out", workers="thread")
    frames = [pandas.read_parquet(run.run.recording(tmp_path / "out")) for run in outcome.runs]
    assert [len(frame) for frame in frames] == [21, 41] and outcome.passed
    assert [run.run.experiment.step for run in outcome.runs] == [0.1, 0.05]
    assert "in steps of 0.05 to 0.1 s" in outcome.report.read_text()
    with pytest.raises(NavfmuError, match=r"line 8: variant 'main', case 'c \(step=0.3\)': the stop time 2 s is not"):
        loaded(tmp_path, text.replace("0.05]", "0.3]"))


def test_one_changed_value_flies_its_own_runs_only(tmp_path, monkeypatch):
    text = CASES + '\n[[axis]]\nvary = "fault.D.rate"\nvalues = [0.1, 0.2, 0.3]\n'
    run_campaign(loaded(tmp_path, text), tmp_path / "out", workers="thread")
    flown = []
    from navfmu.campaign import executor

    fly = executor.fly
    monkeypatch.setattr(executor, "fly", lambda run, *rest: flown.append(run.case.name) or fly(run, *rest))
    run_campaign(loaded(tmp_path, text.replace("0.2,", "0.25,")), tmp_path / "out", workers="thread")
    assert sorted(flown) == ["both (D.rate=0.25)", "drift (D.rate=0.25)"]


@pytest.mark.parametrize("rows", [32, 31])
def test_a_matrix_of_many_cases_has_a_row_for_each_case_of_the_file(tmp_path, monkeypatch, capsys, rows):
    from navfmu.campaign.show import show

    monkeypatch.setattr("navfmu.campaign.show.ROWS", rows)
    monkeypatch.setattr("navfmu.campaign.pictured.PICTURED", 1)
    text = 'variants = ["main", "slow"]\n' + CASES + GRID
    text += (
        '\n[[requirement]]\nid = "R"\nsignal = "estimator.solution.length"\nat_most = 1.4\ncases = ["drift", "both"]\n'
    )
    outcome = run_campaign(loaded(tmp_path, text), tmp_path / "out", workers="thread")
    show(outcome)
    printed = capsys.readouterr().out
    verdicts = pandas.read_csv(tmp_path / "out" / "verdicts.csv")
    verdicts["written"] = verdicts["case"].str.split(" ").str[0]
    groups = {k: (v["verdict"] == "holds").agg(["sum", "count"]) for k, v in verdicts.groupby(["variant", "written"])}
    assert len(groups) == 4 and len({tuple(counts) for counts in groups.values()}) > 1
    for (variant, name), (held, count) in groups.items():
        row = [variant, name, "holds" if held == count else "VIOLATED", f"{held}/{count}"]
        assert (row in [line.split() for line in printed.splitlines()]) == (rows < 32), row
    assert (["main", "nominal", "not", "asked"] in [line.split() for line in printed.splitlines()]) == (rows < 32)


@pytest.mark.slow
def test_the_documented_example_runs(tmp_path, tmp_path_factory):
    from system_ssp.backup_navigator.system import FMUS, source

    for name in FMUS:
        built.fmu(name, tmp_path_factory)
    package = source(built.folder(tmp_path_factory)).pack(tmp_path / "backup_navigator.ssp")
    text = (ROOT / "docs" / "campaigns.md").read_text(encoding="utf-8")
    example = re.findall(r"```toml\n(.*?)```", text, re.DOTALL)[1]
    (tmp_path / "example.toml").write_text(example.replace('"backup_navigator"', f'"{package}"'))
    outcome = run_campaign(load_campaign(tmp_path / "example.toml"), tmp_path / "out")
    names = [case.name for case in outcome.campaign.cases]
    assert len(names) == 3 * 2 and f"`{names[2]}`" in " ".join(text.split())
    assert not any(judged.error for judged in outcome.every) and len(outcome.thresholds) == 2
    for threshold in outcome.thresholds:
        assert 0.0 < threshold.bracket.holds_at < threshold.bracket.violated_at <= threshold.bracket.holds_at + 0.1
