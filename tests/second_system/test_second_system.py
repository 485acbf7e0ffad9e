"""Run, sweep and campaign of a system that the package has never heard of, with a report of its own."""

from __future__ import annotations

import html
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pandas
import pytest
from click.testing import CliRunner

from navfmu import System
from navfmu.cli.main import main
from navfmu.errors import NavfmuError
from navfmu.system import result
from tests.second_system.system import REPORT, pack

CAMPAIGN = """
system = "{system}"
variants = {variants}
seeds = "1-3"
[[case]]
name = "shifted"
faults = "shifted"
[[requirement]]
id = "R-1"
signal = "judge.distance"
at_most = 30.0
percent = 90
from = 5.0
[[requirement]]
id = "R-2"
signal = "judge.north_error"
at_most = 80.0
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("rover")
    pack(folder)
    return folder


def call(*arguments: object, code: int = 0) -> str:
    done = CliRunner().invoke(main, [str(argument) for argument in arguments])
    assert done.exit_code == code, done.output + done.stderr
    return done.output if code == 0 else done.stderr


def text_of(page: Path) -> str:
    text = re.sub(r'base64,[^"]*|<style>.*?</style>', "", page.read_text(), flags=re.DOTALL)
    return html.unescape(text)


def pictures(page: Path) -> list[str]:
    """Titles; of a campaign those of the worst, without those over all runs."""
    text = page.read_text().partition('<h2 id="all-runs">')[0]
    return [html.unescape(title) for title in re.findall(r'<img[^>]*alt="([^"]*)"', text)]


@pytest.fixture(scope="module")
def campaign(folder, tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("campaign")
    (out / "c.toml").write_text(CAMPAIGN.format(system=folder / "rover.ssp", variants='["main", "shy"]'))
    call("campaign", out / "c.toml", "--out", out / "out")
    return out / "out"


def test_a_run_records_what_the_report_file_says(folder):
    frame = System.load(folder / "rover.ssp").run(stop=2.0)
    members = ("latitude", "longitude", "valid", "sequence", "time_of_validity")
    judged = [f"judge.{name}" for name in ("north_error", "east_error", "distance")]
    assert sorted(frame.columns) == sorted([*judged, *(f"finder.place.{name}" for name in members)])


def test_a_sweep_compares_it(folder):
    out = call("sweep", folder / "rover.ssp", "--steps", "0.5,1", "--stop", "10")
    assert "judge.distance" in out and "finder.place.latitude" in out and "rover.latitude" not in out


def test_the_report_of_a_run_shows_the_pictures_of_the_system(folder, tmp_path):
    given = ("--seed", 3, "--faults", "shifted", "--set", "finder.claim=12")
    call("run", folder / "rover.ssp", *given, "--report", tmp_path)
    titles = pictures(tmp_path / "report.html")
    begin = ("judge.distance, seed 3", "north error inside", "ground track, seed 3: estimate up to", "finder.place.seq")
    assert len(titles) == 4 and all(title.startswith(start) for title, start in zip(titles, begin, strict=True))
    frame = result.read(tmp_path / "recording.parquet")
    points = frame[frame["finder.place.valid"]]
    inside = (points["judge.north_error"].abs() <= 2 * points["finder.north_sigma"]).mean()
    assert f"north error inside 2 sigma for {100 * inside:.1f} % of 119 points" in titles[1]
    text = text_of(tmp_path / "report.html")
    for words in ("Run of rover", "a rover at the date line", "finder.claim", "finder.offset", "30 to 40", "--seed 3"):
        assert words in text
    assert "judge.distance" in frame and "rover.latitude" in frame  # what only the map needs is recorded, too
    command = shlex.split(re.search(r"<pre>(navfmu run .*?)</pre>", text)[1])
    call(*command[1:], "--out", tmp_path / "again.parquet")
    pandas.testing.assert_frame_equal(result.read(tmp_path / "again.parquet"), frame)


def test_signals_that_are_named_are_drawn_in_the_report_of_a_run(folder, tmp_path):
    call("run", folder / "rover.ssp", "--stop", 5, "--record", "rover", "--report", tmp_path)
    assert pictures(tmp_path / "report.html")[-1].startswith("rover.latitude, rover.longitude")


def test_the_campaign_shows_the_pictures_of_the_system(campaign):
    titles = [title.removeprefix("main, shifted: ") for title in pictures(campaign / "report.html")[:5]]
    assert titles[0].startswith("judge.distance, 3 runs, 0 to ") and titles[0].endswith(" m")
    assert "east error inside 2 sigma for" in titles[1] and titles[2].startswith("ground track, seed ")
    assert titles[3].startswith("finder.place.sequence, judge.north_error, seed ")
    assert titles[4].startswith("judge.north_error, 3 runs")  # asked by a requirement and pictured nowhere


def test_a_variant_that_lacks_a_signal_leaves_that_picture_out_and_says_so(campaign):
    text = text_of(campaign / "report.html")
    assert "The picture 'sigma' is left out: shy has no finder.north_sigma, finder.east_sigma." in text
    assert "The picture 'map' is left out: shy has no finder.beacon_latitude" in text
    shy = [title for title in pictures(campaign / "report.html") if title.startswith("shy")]
    assert len(shy) == 3 and not any("sigma" in title or "ground track" in title for title in shy)
    assert "shy is left out: it has no finder.north_sigma, finder.east_sigma" in text


def test_the_statistics_are_those_of_the_report_file(campaign):
    table = pandas.read_csv(campaign / "statistics.csv")
    assert list(table["variant"]) == ["main"] and table["limit"][0] == 30.0
    runs = [result.read(file) for file in (campaign / "runs").glob("*.parquet")]
    runs = [run["judge.distance"][5.0:] for run in runs if "finder.north_sigma" in run]
    assert len(runs) == 3
    assert table["above"][0] == pytest.approx(100 * pandas.concat(runs).gt(30.0).mean())
    assert table["high"][0] == max(max(values) for values in zip(*runs, strict=True))  # of three runs, the worst
    assert "Distance over all runs" in text_of(campaign / "report.html")


def test_without_a_report_file_all_outputs_are_recorded_and_requirements_pictured(folder, tmp_path):
    plain = pack(folder, None)
    assert len(System.load(plain).run(stop=2.0).columns) == 12
    (tmp_path / "c.toml").write_text(CAMPAIGN.format(system=plain, variants='["main"]'))
    call("campaign", tmp_path / "c.toml", "--out", tmp_path / "out")
    titles = [title.removeprefix("main, shifted: ") for title in pictures(tmp_path / "out" / "report.html")]
    assert [title.partition(",")[0] for title in titles] == ["judge.distance", "judge.north_error"]
    assert not (tmp_path / "out" / "statistics.csv").exists()
    call("run", plain, "--stop", 5, "--report", tmp_path / "run")
    assert len(pictures(tmp_path / "run" / "report.html")) == 1


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (('"judge.distance"', '"judge.distnce"'),
         "line 6: picture 'percentiles': 'judge.distnce': component 'judge' has no variable 'distnce'; did you"),
        (('record = ["judge"', 'record = ["juge"'), "line 2: 'record': 'juge': there is no component 'juge'; did you"),
        (('"finder.beacon_count"', '"findr.beacon_count"'), "there is no component 'findr'; did you mean 'finder'?"),
        (('kind = "sigma"', 'kind = "sgma"'), "line 9: there is no picture of the kind 'sgma'; did you mean 'sigma'?"),
        (('kind = "sigma"\n', ""), "line 8: this picture has no 'kind'"),
        (("factor = 2", "facter = 2"), "line 10: unknown entry 'facter'; did you mean 'factor'?"),
        (("factor = 2", "factor = 0"), "line 10: 'factor' is 0, expected more than 0"),
        (('error = "judge.north_error"', 'error = "rover.latitude"'), "is in rad, 'finder.north_sigma' in m"),
        (('truth = ["rover.latitude"', 'truth = ["judge.distance"'), "'judge.distance' is in m, expected an angle"),
        (('truth = ["rover.latitude", ', "truth = ["), "line 19: 'truth' holds 1, expected two"),
        (('"finder.place.sequence", ', '"finder.place", '), "'finder.place' stands for 5 signals; name one"),
        (('label = "beacon"', 'lable = "beacon"'), "line 24: unknown entry 'lable'; did you mean 'label'?"),
        (("[[statistic]]", '[[statistic]]\nkind = "radial"\nerror = "judge.distance"\naxes = []\n[[statistic]]'),
         "'axes' holds 0, expected two"),
    ],
)  # fmt: skip
def test_a_mistake_in_the_report_file_is_answered_with_its_line(folder, tmp_path, change, sentence):
    text = REPORT.read_text()
    assert change[0] in text
    (tmp_path / "report.toml").write_text(text.replace(*change, 1))
    here = Path(shutil.copytree(folder, tmp_path / "rover"))
    system = pack(here, tmp_path / "report.toml")
    said = call("run", system, "--stop", 2, "--report", tmp_path / "out", code=2)
    assert not (tmp_path / "out").exists()
    assert f"{system}: extra/report.toml, line " in said and sentence in said


def test_a_wrong_picture_does_not_stop_a_run_without_a_report_but_a_wrong_default_does(folder, tmp_path):
    here = Path(shutil.copytree(folder, tmp_path / "rover"))
    (tmp_path / "report.toml").write_text(REPORT.read_text().replace('kind = "sigma"', 'kind = "sgma"'))
    call("run", pack(here, tmp_path / "report.toml"), "--stop", 2)
    (tmp_path / "report.toml").write_text(REPORT.read_text().replace('record = ["judge"', 'record = ["juge"'))
    said = call("run", pack(here, tmp_path / "report.toml"), "--stop", 2, code=2)
    assert "extra/report.toml, line 2: 'record': 'juge': there is no component 'juge'; did you mean 'judge'?" in said


def test_a_run_without_a_report_does_not_load_what_checks_the_report(folder):
    code = (
        "import sys; from navfmu import System; System.load(sys.argv[1]).run(stop=2.0);"
        "print([name for name in ('pydantic', 'matplotlib') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code, folder / "rover.ssp"], capture_output=True, text=True)
    assert done.stdout == "[]\n", done.stderr


def test_several_statistics_need_names(folder, tmp_path):
    text = REPORT.read_text()
    statistic = text[text.index("[[statistic]]") :]
    (tmp_path / "report.toml").write_text(text + statistic)
    with pytest.raises(NavfmuError, match="of several statistics each needs a 'name'"):
        System.load(pack(Path(shutil.copytree(folder, tmp_path / "rover")), tmp_path / "report.toml")).report  # noqa: B018
