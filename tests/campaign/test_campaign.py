"""Campaigns: verdicts against hand-made findings, jobs, resuming, runs that fail, and mistakes in the file."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path

import numpy as np
import pandas
import pytest
from click.testing import CliRunner

from navfmu import System
from navfmu.campaign import load_campaign, run_campaign
from navfmu.campaign.finding import Finding
from navfmu.campaign.requirement import Requirement, wilson
from navfmu.campaign.runs import runs_of
from navfmu.cli.main import main
from navfmu.engine.clock import Clock
from navfmu.engine.monitor import Observed, Observer, table
from navfmu.engine.operations import Operations
from navfmu.errors import NavfmuError
from navfmu.expressions.meaning import compile_expression
from tests.components import systems
from tests.expressions.made import SYSTEM

CAMPAIGN = """
name = "tracker"
system = "{system}"
variants = ["main", "slow"]
seeds = "1-3"

[[case]]
name = "nominal"

[[case]]
name = "stuck"
faults = "stuck"

[[requirement]]
id = "R-1"
signal = "estimator.solution.length"
at_most = "8 m"
percent = 90
from = 2.0

[[requirement]]
id = "R-2"
signal = "estimator.solution.length"
at_most = 9.5
at_least = -9.5
quantile = 0.9
variants = ["slow"]
"""


def write(folder: Path, text: str = CAMPAIGN) -> Path:
    file = folder / "campaign.toml"
    file.write_text(text.format(system=systems.tracker()) if "{system}" in text else text)
    return file


def copy(folder: Path, to: Path) -> Path:
    return Path(shutil.copytree(folder, to / "copy"))


def contents(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("[!.]*")) if p.is_file()}


def of_the_worst(report: str) -> str:
    """What stands in a report before the pictures over all runs."""
    return report.partition('<h2 id="all-runs">')[0]


def nothing_more(runs, *_):
    """Takes the place of the executor where nothing is left to do."""
    assert not runs, "ran again"
    return []


@pytest.fixture(scope="module", autouse=True)
def few_pictures():
    """Drawing takes longer than flying here."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("navfmu.campaign.pictured.PICTURED", 1)
        yield


@pytest.fixture(scope="module")
def done(few_pictures, tmp_path_factory) -> tuple[Path, Path]:
    """A campaign file and the folder of its results, made by two jobs."""
    folder = tmp_path_factory.mktemp("campaign")
    file = write(folder)
    run_campaign(load_campaign(file), folder / "out", jobs=2)
    return file, folder / "out"


def test_one_job_and_two_write_the_same_bytes(done, tmp_path):
    file, folder = done
    run_campaign(load_campaign(file), tmp_path / "one", jobs=1)
    assert contents(tmp_path / "one") == contents(folder)


def test_findings_are_those_of_the_runs(done):
    rows = pandas.read_csv(done[1] / "runs.csv").query("requirement == 'R-1'").set_index(["variant", "case", "seed"])
    assert len(rows) == 12
    frame = System.load(systems.tracker(), "slow").run(
        stop=20.0, step=0.1, seed=2, faults="stuck", record=["estimator.solution.length"]
    )
    values = frame["estimator.solution.length"][2.0:]
    row = rows.loc[("slow", "stuck", 2)]
    assert row.percent == pytest.approx(100 * (values <= 8.0).mean())
    assert row.worst == values.max() and row.worst_time == values.idxmax()
    assert row.held == (row.percent >= 90)


def test_a_second_time_runs_nothing(done, monkeypatch):
    file, folder = done
    monkeypatch.setattr(
        "navfmu.campaign.executor.in_threads", lambda runs, *rest: pytest.fail("ran again") if runs else []
    )
    before = contents(folder)
    run_campaign(load_campaign(file), folder)
    assert contents(folder) == before


def test_other_shares_judge_the_same_runs_anew(done, monkeypatch, tmp_path):
    file, folder = done[0], copy(done[1], tmp_path)
    monkeypatch.setattr(
        "navfmu.campaign.executor.in_threads", lambda runs, *rest: pytest.fail("ran again") if runs else []
    )
    text = file.read_text().replace("quantile = 0.9", "quantile = 1.0").replace("percent = 90", "percent = 100")
    outcome = run_campaign(load_campaign(write(tmp_path, text)), folder)
    cell = next(c for c in outcome.cells if c.requirement.id == "R-2" and c.case == "nominal")
    assert "100th percentile of 3 runs" in cell.sentence


def test_another_bound_is_asked_in_new_runs(done, tmp_path):
    """It is asked at every communication point, of which the recordings have but some."""
    file, folder = done[0], copy(done[1], tmp_path)
    before = set((folder / "runs").glob("*.json"))
    text = file.read_text().replace("at_most = 9.5", "at_most = 0.5")
    outcome = run_campaign(load_campaign(write(tmp_path, text)), folder)
    cell = next(c for c in outcome.cells if c.requirement.id == "R-2" and c.case == "nominal")
    assert not cell.passed and not outcome.passed
    asked = {judged.run.answer(folder) for judged in outcome.runs if "R-2" in judged.findings}
    assert asked and not asked & before
    assert {judged.run.answer(folder) for judged in outcome.runs} - asked <= before


def test_an_interrupted_campaign_goes_on_where_it_stopped(done, tmp_path):
    file, folder = done
    outcome_folder = tmp_path / "out"
    made: list[int] = []

    def interrupt(done: int, total: int, note: str = "") -> None:
        made.append(done)
        if len(list((outcome_folder / "runs").glob("*.json"))) >= 3:
            raise KeyboardInterrupt

    with pytest.raises(NavfmuError, match=r"interrupted: [0-9]+ of 12 runs are finished"):
        run_campaign(load_campaign(file), outcome_folder, 1, interrupt)
    kept = {p.name: p.stat().st_mtime_ns for p in (outcome_folder / "runs").glob("*.json")}
    assert 3 <= len(kept) < 12
    run_campaign(load_campaign(file), outcome_folder, 1)
    assert {n: p.stat().st_mtime_ns for p in (outcome_folder / "runs").glob("*.json") if (n := p.name) in kept} == kept
    assert contents(outcome_folder) == contents(folder)


def test_a_changed_fault_runs_only_what_depends_on_it(done, tmp_path):
    file, folder = done[0], copy(done[1], tmp_path)
    faults = tmp_path / "stuck2.toml"
    faults.write_text(
        '[[fault]]\nid = "F1"\ntarget = "sensor.reading.length"\ntype = "stuck"\nvalue = 4.0\nstart = 5.0\n'
    )
    text = file.read_text().replace('faults = "stuck"', 'faults = "stuck2.toml"')
    before = set((folder / "runs").iterdir())
    run_campaign(load_campaign(write(tmp_path, text)), folder)
    assert len(set((folder / "runs").iterdir()) - before) == 2 * 6


def test_a_run_that_fails_is_a_row_and_not_the_end(tmp_path):
    text = CAMPAIGN.format(system=systems.tracker())
    text += '\n[[case]]\nname = "broken"\nparameters = { "lag.tau" = 0.02, "lag.sample_period" = 0.02 }\n'
    campaign = load_campaign(write(tmp_path, text))
    from navfmu.engine.recording import RunError
    from navfmu.system.experiment import Experiment

    fly = Experiment.run

    def failing(self, *rest, **more):
        if self.parameters and self.seed == 2:
            raise RunError("component 'lag': it broke (fmi2DoStep returned Error at t = 3 s)")
        return fly(self, *rest, **more)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Experiment, "run", failing)
        outcome = run_campaign(campaign, tmp_path / "out", 2, workers="thread")
    errors = [judged for judged in outcome.runs if judged.error]
    assert [(j.run.variant, j.run.case.name, j.run.seed) for j in errors] == [
        ("main", "broken", 2),
        ("slow", "broken", 2),
    ]
    assert not outcome.passed and sum(c.total for c in outcome.cells) == 3 * len(outcome.cells)
    cell = next(c for c in outcome.cells if c.case == "broken" and c.requirement.id == "R-1")
    assert cell.held <= 2 and "1 ended with an error" in cell.sentence
    assert "it broke" in (tmp_path / "out" / "report.html").read_text()


def test_the_report_stands_alone_and_says_how_to_repeat_every_run(done):
    text = (done[1] / "report.html").read_text()
    assert (
        of_the_worst(text).count("data:image/png;base64") == 1
        and "src=" in text
        and "http" not in text.split("<body>")[0]
    )
    for word in ("R-1", "VIOLATED", "--seed 3", "--variant slow", "95 % interval", "holds"):
        assert word in text
    about = json.loads((done[1] / "campaign.json").read_text())
    assert about["seeds"] == [1, 2, 3] and set(about["digests"]) == {"main", "slow"}


def test_a_signal_that_is_asked_in_one_case_only_has_its_picture_there(tmp_path, monkeypatch):
    """It was drawn in the others, too, where it is not recorded."""
    monkeypatch.setattr("navfmu.campaign.pictured.PICTURED", 2)
    text = f'system = "{systems.tracker()}"\nstop = 1.0\n[[case]]\nname = "one"\n[[case]]\nname = "other"\n'
    for case, signal in (("one", "lag.y"), ("other", "truth.y")):
        text += f'[[requirement]]\nid = "{case}"\nsignal = "{signal}"\nat_most = 100.0\ncases = ["{case}"]\n'
    outcome = run_campaign(load_campaign(write(tmp_path, text)), tmp_path / "out", workers="thread")
    assert outcome.passed and of_the_worst(outcome.report.read_text()).count("data:image/png;base64") == 2


def test_the_command_prints_verdicts_and_can_be_strict(done):
    file, folder = done
    runner = CliRunner()
    result = runner.invoke(main, ["campaign", str(file), "--out", str(folder)])
    assert result.exit_code == 0, result.output
    for words in ("VIOLATED", "violated R-1", "report.html"):
        assert words in result.output
    assert runner.invoke(main, ["campaign", str(file), "--out", str(folder), "--strict"]).exit_code == 1


def requirement(**given) -> Requirement:
    values = {
        "id": "R", "signal": "a.x", "most": None, "least": None, "unit": "m", "percent": 100.0, "quantile": None,
        "runs": 100.0, "start": 0.0, "end": np.inf, "program": compile_expression("a.x", SYSTEM),
    }  # fmt: skip
    return Requirement(**values | given)


def judge(asked: Requirement, time: np.ndarray, values: np.ndarray) -> Finding | None:
    """What a run says whose signal has these values at its first communication points, which are ``time``."""
    clock = Clock.of(1.0, time[-1])
    operations = Operations(lambda source: (0, 1.0, 0.0), ())
    rows = table([asked.monitor], [(asked.program, None)], operations, clock)
    observer = Observer(rows[0], operations.table)
    for k, value in enumerate(values):
        observer.observe([value], k, clock.time(k))
    return asked.question.judge(asked, Observed.of(observer.row, clock, len(values) - 1))


TIME = np.arange(11.0)
VALUES = np.array([0.0, 1, 2, 3, 4, 5, 4, 3, 2, 1, 0])


def test_a_requirement_is_judged_by_the_share_of_time_in_its_window():
    finding = judge(requirement(most=3.0, percent=70.0), TIME, VALUES)
    assert finding.held and finding.percent == pytest.approx(100 * 8 / 11)
    assert (finding.worst, finding.worst_time, finding.first_violation) == (5.0, 5.0, 4.0)
    assert not judge(requirement(most=3.0, percent=75.0), TIME, VALUES).held
    assert judge(requirement(most=3.0, start=7.0), TIME, VALUES).held
    assert judge(requirement(most=3.0, start=7.0), TIME, VALUES).first_violation is None
    assert judge(requirement(most=9.0, start=11.5), TIME, VALUES) is None


def test_a_lower_bound_and_a_missing_number_count():
    finding = judge(requirement(least=1.0), TIME, VALUES)
    assert not finding.held and finding.percent == pytest.approx(100 * 9 / 11) and finding.worst == 0.0
    values = VALUES.copy()
    values[3] = np.nan
    finding = judge(requirement(most=10.0), TIME, values)
    assert not finding.held and finding.worst_time == 3.0


def test_a_share_has_its_confidence_interval():
    low, high = wilson(8, 10)
    assert (low, high) == pytest.approx((49.0, 94.3), abs=0.1)
    assert wilson(0, 0) == (0.0, 100.0)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (("[[case]]", "[[case]"), "line 7, column"),
        (('name = "tracker"', 'nmae = "tracker"'), "line 2: unknown entry 'nmae'; did you mean 'name'"),
        (('seeds = "1-3"', 'seeds = "1-x"'), "line 5: '1-x' is not a seed"),
        (('seeds = "1-3"', "seeds = [1, 1]"), "line 5: a seed is given twice"),
        (('seeds = "1-3"', "seeds = 3"), "line 5: 'seeds' is 3, expected a text or a list"),
        (('seeds = "1-3"', 'stop = "long"'), "line 5: 'stop' is 'long', expected a time: a number of"),
        (('seeds = "1-3"', "stop = -1"), "stop time must be a positive number"),
        (('"slow"]\nseeds', '"slwo"]\nseeds'), "line 4: the system has no variant 'slwo'; did you mean 'slow'"),
        (('name = "stuck"', 'name = "nominal"'), "line 11: there are two cases named 'nominal'"),
        (('faults = "stuck"', 'faults = "stcuk"'), "line 12: faults: there is no file 'stcuk'; did you mean 'stuck'"),
        (('"8 m"', "nan"), "line 17: 'at_most' is nan, expected a finite number"),
        (('"8 m"', "8.0\nat_least = 9.0"), "line 18: 'at_least' is above 'at_most'"),
        (("from = 2.0", "to = nan"), "line 19: 'to' is nan"),
        (('seeds = "1-3"', 'record = ["lag.yy"]'), "line 5: variant 'main', case 'nominal': recorded signal 'lag.yy'"),
        (('seeds = "1-3"', 'algorithm = "jacobbi"'), "line 5: unknown algorithm 'jacobbi'; did you mean 'jacobi'"),
        (('seeds = "1-3"', "record_period = 0.15"), "line 5: the recording period 0.15 s is not a multiple"),
        (('name = "tracker"', 'name = "../tracker"'), "line 2: 'name' is '../tracker', expected a text"),
        (('name = "nominal"', 'name = "nominal"\nparameters = {{"lag.tua" = 1}}'),
         "line 9: variant 'main', case 'nominal': parameter 'lag.tua': lag has no parameter 'tua'; did you mean 'tau'"),
        (('name = "nominal"', 'nam = "nominal"'), "line 8: unknown entry 'nam'; did you mean 'name'"),
        (('id = "R-2"', 'id = "R-1"'), "line 22: there are two requirements 'R-1'"),
        (('signal = "estimator.solution.length"\nat_most = "8', 'signal = "estimator.x"\nat_most = "8'), "line 16: "),
        (('"8 m"', '"8 s"'), "line 17: 'at_most' = 8 s: 's' cannot be converted to 'm'"),
        (("percent = 90", "percent = 101"), "line 18: 'percent' is 101"),
        (("quantile = 0.9", "quantile = 90"), "line 26: 'quantile' is 90"),
        (("from = 2.0", "from = 30.0"), "line 19: 'from' is 30.0 s, expected a time from 0 to before 20 s"),
        (('variants = ["slow"]', 'cases = ["stcuk"]'), "line 27: 'cases': there is no 'stcuk' in this campaign; did"),
    ],
)  # fmt: skip
def test_a_mistake_in_the_file_is_answered_with_its_line(tmp_path, change, sentence):
    assert change[0] in CAMPAIGN
    file = write(tmp_path, CAMPAIGN.replace(*change, 1).format(system=systems.tracker()))
    result = CliRunner().invoke(main, ["campaign", str(file), "--out", str(tmp_path / "out")])
    assert result.exit_code == 2 and isinstance(result.exception, SystemExit)
    assert str(file) in result.stderr and not (tmp_path / "out").exists()
    assert sentence in result.stderr


def test_a_requirement_that_no_recorded_point_can_answer_is_refused(tmp_path):
    text = CAMPAIGN.replace("quantile = 0.9", "quantile = 0.9\nfrom = 2.1\nto = 2.9")
    text = text.replace("seeds", "record_period = 1.0\nseeds")
    file = write(tmp_path, text.format(system=systems.tracker()))
    with pytest.raises(NavfmuError, match=r"line 28: no point is recorded from 2\.1 s to 2\.9 s: .* period is 1 s"):
        load_campaign(file)


def test_the_worst_comes_first(done):
    cells = sorted(run_campaign(load_campaign(done[0]), done[1]).cells, key=lambda cell: cell.rank)
    assert [cell.passed for cell in cells] == sorted(cell.passed for cell in cells)
    shares = [cell.held / cell.total for cell in cells if not cell.passed]
    assert shares == sorted(shares)
    percents = [
        cell.worst.findings[cell.requirement.id].percent
        for cell in cells
        if cell.worst is not None and not cell.passed and cell.held == 0 and cell.requirement.quantile is None
    ]
    assert percents == sorted(percents)


def test_paths_beside_the_file_have_no_detours(tmp_path):
    (tmp_path / "faults").mkdir()
    (tmp_path / "campaigns").mkdir()
    fault = '[[fault]]\nid = "F"\ntarget = "lag.y"\ntype = "bias"\nvalue = 1.0\n'
    (tmp_path / "faults" / "f.toml").write_text(fault)
    text = CAMPAIGN.replace('faults = "stuck"', 'faults = "../faults/f.toml"')
    campaign = load_campaign(write(tmp_path / "campaigns", text.format(system=systems.tracker())))
    assert [fault.file for fault in campaign.cases[1].faults] == [str(tmp_path / "faults" / "f.toml")]


def test_a_single_table_is_answered_with_the_way_to_write_it(tmp_path):
    file = write(tmp_path, f'system = "{systems.tracker()}"\n[case]\nname = "nominal"\n')
    with pytest.raises(NavfmuError, match=r"line 2: 'case' is written as tables: \[\[case\]\]"):
        load_campaign(file)


def test_parameters_may_be_named_without_quotes(tmp_path):
    """TOML reads lag.tau = 2.0 as a table in a table."""
    text = CAMPAIGN + "\n[parameters]\nlag.tau = 2.0\nsensor.sigma = 0.1\n"
    campaign = load_campaign(write(tmp_path, text.format(system=systems.tracker())))
    assert campaign.parameters == {"lag.tau": 2.0, "sensor.sigma": 0.1}


def test_a_parameter_that_does_not_exist_is_answered_with_its_line(tmp_path):
    text = CAMPAIGN + '\n[parameters]\n# for all runs\n"lag.tua" = 2.0\n'
    file = write(tmp_path, text.format(system=systems.tracker()))
    line = text.splitlines().index('"lag.tua" = 2.0') + 1
    with pytest.raises(NavfmuError, match=rf"line {line}: .*did you mean 'tau'"):
        load_campaign(file)


def test_a_missing_campaign_file_is_a_sentence(tmp_path):
    with pytest.raises(NavfmuError, match="no such file; expected a campaign file"):
        load_campaign(tmp_path / "none.toml")


def test_a_fault_that_does_not_fit_the_system_is_found_before_anything_runs(tmp_path):
    (tmp_path / "f.toml").write_text('[[fault]]\nid = "F"\ntarget = "lag.u"\ntype = "input"\nvalue = 1.0\n')
    file = write(tmp_path, CAMPAIGN.replace('faults = "stuck"', 'faults = "f.toml"').format(system=systems.tracker()))
    with pytest.raises(NavfmuError, match=r"variant 'main', case 'stuck': .*f\.toml, line 3.* is a connected input"):
        run_campaign(load_campaign(file), tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_jobs_default_to_the_cores_and_seeds_can_be_replaced(done, tmp_path):
    campaign = load_campaign(done[0], seeds="5")
    assert campaign.seeds == (5,) and campaign.size == 4
    outcome = run_campaign(campaign, tmp_path / "out")
    assert {judged.run.seed for judged in outcome.runs} == {5} and os.cpu_count() >= 1


def test_the_documented_example_uses_entries_that_exist():
    import re

    from navfmu.campaign.schema import CampaignFile
    from navfmu.files.schema import validated
    from navfmu.files.toml import Document

    text = (Path(__file__).parents[2] / "docs" / "campaigns.md").read_text(encoding="utf-8")
    document = Document(re.search(r"```toml\n(.*?)```", text, re.DOTALL)[1], "docs/campaigns.md")
    content = validated(document, CampaignFile)
    named = {name for entry in content.requirement for name in entry.variants or ()}
    assert named <= set(content.variants)


def test_the_command_in_the_report_repeats_the_run(done, tmp_path):
    import shlex

    from navfmu.system.result import read

    campaign = load_campaign(done[0])
    from navfmu.campaign.runs import runs_of

    run = next(r for r in runs_of(campaign) if (r.variant, r.case.name, r.seed) == ("slow", "stuck", 3))
    words = shlex.split(run.experiment.command())
    assert words[0] == "navfmu"
    out = tmp_path / "again.parquet"
    result = CliRunner().invoke(main, [*words[1:], "--record", "estimator.solution.length", "--out", str(out)])
    assert result.exit_code == 0, result.output
    kept = read(run.recording(done[1]))
    assert read(out)["estimator.solution.length"].equals(kept["estimator.solution.length"])


@pytest.mark.parametrize("text", ["1", "1-8", "3,1-2,9", "7-8,1"])
def test_seeds_are_written_as_they_are_read(text):
    from navfmu.campaign.seeds import parse_seeds, seeds_text

    assert seeds_text(parse_seeds(text, NavfmuError)) == text


def test_a_campaign_touches_no_file_that_is_not_its_own(tmp_path):
    """It tidies up after a kill; dotfiles of the user with two dots in their name once went with that."""
    own = [tmp_path / name for name in (".pre-commit-config.yaml", ".my.secret", ".bashrc", "runs/.x.parquet")]
    (tmp_path / "runs").mkdir()
    for file in own:
        file.write_text("mine")
    left = tmp_path / "runs" / ".navfmu-abc.parquet.12345678.parquet"
    left.write_text("half")
    file = write(tmp_path, f'system = "{systems.tracker()}"\nstop = 1.0\n')
    run_campaign(load_campaign(file), tmp_path, workers="thread")
    assert all(file.read_text() == "mine" for file in own) and not left.exists()


@pytest.mark.parametrize("runs", [6, 11, 21, 41])
@pytest.mark.parametrize("quantile", [0.5, 0.8, 0.9])
def test_a_quantile_is_the_same_from_above_and_from_below(runs, quantile):
    """As many runs may be outside as the quantile leaves, on either side: 1 - 0.9 is not 0.1 in binary."""
    from navfmu.campaign.outcome import judge_quantile

    for outside in range(runs):
        values = np.zeros((runs, 1))
        values[:outside] = 1.0
        above = judge_quantile(requirement(most=0.5, quantile=quantile, percent=None), TIME[:1], values)
        below = judge_quantile(requirement(least=-0.5, quantile=quantile, percent=None), TIME[:1], -values)
        assert above.passed == below.passed


def test_the_sentence_of_a_quantile_names_the_side_that_is_wrong():
    from navfmu.campaign.outcome import judge_quantile

    values = np.array([[-5.0]] * 3 + [[0.0]] * 10)
    found = judge_quantile(requirement(least=-1.0, most=1.0, quantile=0.9, percent=None), TIME[:1], values)
    assert not found.passed and found.sentence.startswith("10th percentile of 13 runs at worst -5 m")


def test_a_sentence_never_looks_like_the_opposite_of_its_verdict():
    from navfmu.campaign.finding import percent
    from navfmu.campaign.question import told

    assert (percent(99.98), percent(94.9505), percent(100.0), percent(94.99999)) == (
        "99.9 %",
        "94.9 %",
        "100.0 %",
        "94.9 %",
    )
    assert told(requirement(most=926.0), 926.04) == "926.04 m" and told(requirement(most=1852.0), 1852.3) == "1852.3 m"
    assert told(requirement(most=926.0), 1403.2) == "1403 m"


@pytest.mark.parametrize("place", ["answer", "recording", "partial", "report.html", "runs.csv"])
def test_what_is_in_the_way_of_a_file_is_told_before_anything_is_flown(done, tmp_path, monkeypatch, place):
    plan, out = load_campaign(done[0]), tmp_path / "out"
    run = runs_of(plan)[-1]
    places = {"answer": run.answer(out), "recording": run.recording(out), "partial": run.recording(out, whole=False)}
    file = places.get(place, out / place)
    file.mkdir(parents=True)
    monkeypatch.setattr("navfmu.campaign.executor.fly", lambda *_: pytest.fail("it was flown"))
    with pytest.raises(NavfmuError) as caught:
        run_campaign(plan, out, 1, workers="thread")
    assert str(caught.value) == f"{file}: is a folder, where a file is to be written; move it away"
    assert [found for found in out.rglob("*") if found.is_file()] == []
