"""Observations of a made sky become an FMU: what it gives out, and what gps_solver makes of it."""

from __future__ import annotations

from pathlib import Path

import fmpy
import numpy as np
import pymap3d
import pytest
from click.testing import CliRunner
from fmpy.validation import validate_fmu

from fmus.satellite.observations_replay import ObservationsReplay
from fmus.satellite.signals import PLACES
from navfmu import Fault, NavfmuError, System
from navfmu.cli.main import main
from navfmu.recorded.observations.importer import import_observations
from navfmu.recorded.observations.phases import doppler
from navfmu.ssp.writer import SystemSource
from navfmu.system import shipped
from tests import built
from tests.models.native import interpret
from tests.recorded.sky import SECOND, WEEK, Sky
from tests.satellite import made
from tests.satellite.made import written

EPOCHS = np.arange(0.0, 300.0, 30.0)


@pytest.fixture(scope="module")
def player(tmp_path_factory):
    return built.fmu("observations_replay", tmp_path_factory)


@pytest.fixture
def imported(player, tmp_path):
    """Import texts of files."""

    def take(observations, *navigation, **asked):
        file = written(tmp_path, "seen.rnx.gz", observations)
        nav = [written(tmp_path, f"nav{k}.rnx", text) for k, text in enumerate(navigation)]
        return import_observations(file, nav, player, **asked)

    return take


@pytest.fixture
def solved(tmp_path, tmp_path_factory):
    """Fly a player and gps_solver in the master; columns by their names, a row for each epoch."""

    def run(found, tick=1.0, faults=(), **parameters):
        folder = tmp_path / "parts"
        folder.mkdir(exist_ok=True)
        found.write(folder / "observations.fmu")
        (folder / "gps_solver.fmu").write_bytes(built.fmu("gps_solver", tmp_path_factory).read_bytes())
        system = SystemSource("day", fmus=folder, stop_time=tick * np.ceil(found.duration / tick + 2.0), step=tick)
        system.component("observations", "observations.fmu").component("solver", "gps_solver.fmu")
        system.connect("observations.signals", "solver.signals")
        system.parameters("solver", {"tick_period": tick, "ionosphere": 2, "troposphere": 3})  # both off
        system.parameters("observations", {"tick_period": tick, **parameters})
        system.write(tmp_path / "system")
        result = System.load(tmp_path / "system").run(
            record=["observations", "solver"], record_period=tick, faults=list(faults)
        )
        return result[np.diff(result["solver.fix.sequence"], prepend=0) > 0]

    return run


def east_north_up(sky, result):
    place = [result[f"solver.fix.{name}"].to_numpy() for name in ("latitude", "longitude", "altitude")]
    return np.stack(pymap3d.geodetic2enu(*place, sky.latitude, sky.longitude, sky.altitude, deg=False), 1)


def test_a_made_sky_gives_the_place_from_which_it_was_seen(imported, solved):
    """Files round to 0.5 mm and 0.1 mm/s. Without group delay it is some m off, with satellites at reception 60 m,
    with the other sign of Doppler hundreds of m/s."""
    sky = Sky()
    found = imported(sky.observations(EPOCHS), sky.navigation())
    result = solved(found)
    assert len(result) == len(EPOCHS) and result["solver.fix.valid"].all()
    assert (result["solver.satellites"] >= 6).all()
    np.testing.assert_allclose(east_north_up(sky, result), 0.0, atol=5e-3)
    velocity = [result[f"solver.fix.velocity_n[{i}]"] for i in (1, 2, 3)]
    np.testing.assert_allclose(velocity, 0.0, atol=1e-3)
    np.testing.assert_allclose(result["solver.clock_bias"], sky.clock + sky.drift * EPOCHS, rtol=0, atol=2e-11)
    np.testing.assert_allclose(result["solver.clock_drift"], sky.drift, rtol=0, atol=2e-12)
    np.testing.assert_array_equal(result["observations.signals.week"], WEEK)
    np.testing.assert_array_equal(result["observations.signals.seconds"], SECOND + EPOCHS)


def test_a_satellite_keeps_its_place_and_a_new_one_has_the_first_that_is_free(imported):
    sky = Sky()
    seen = np.flatnonzero([sky.high(k, 0.0) for k in range(32)])
    second = seen[1]
    found = imported(
        sky.observations(EPOCHS[:4], left_out=lambda k, time: k == second and time == 30.0), sky.navigation()
    )
    number = found.epochs.number
    assert number.shape == (4, PLACES)
    np.testing.assert_array_equal(number[0][: len(seen)], seen + 1)
    assert number[1][1] == 0.0 and number[2][1] == second + 1
    others = np.delete(number, 1, axis=1)
    np.testing.assert_array_equal(others, np.tile(others[0], (4, 1)))


def test_without_a_good_orbit_a_satellite_is_not_tracked(imported, solved):
    """One satellite has none, one is unhealthy, and the sentence names both; places of the others are used."""
    sky = Sky()
    gone, ill = np.flatnonzero([sky.high(k, 0.0) for k in range(32)])[[0, 2]]
    good = [k for k in range(32) if k not in (gone, ill)]
    found = imported(sky.observations(EPOCHS), sky.navigation(of=good), sky.navigation(of=[ill], health=1.0))
    (told,) = (sentence for sentence in found.sentences() if "not `tracked`" in sentence)
    assert told.endswith(f"satellites {', '.join(map(str, sorted((gone + 1, ill + 1))))}")
    result = solved(found)
    tracked = np.stack([result[f"observations.signals.tracked[{i + 1}]"] for i in range(PLACES)], 1)
    numbers = found.epochs.number
    assert {gone + 1, ill + 1} < set(numbers.ravel())
    np.testing.assert_array_equal(tracked, (numbers > 0) & ~np.isin(numbers, (gone + 1, ill + 1)))
    np.testing.assert_allclose(east_north_up(sky, result), 0.0, atol=1e-2)
    assert found.good.sum(axis=1).tolist() == result["solver.satellites"].tolist()


def test_a_receiver_has_an_orbit_from_when_it_was_sent(imported, solved):
    """The only orbits were sent 150 s after the first epoch: of a file all count, heard only from then on."""
    sky = Sky()
    found = imported(sky.observations(EPOCHS), sky.navigation(sent=150.0))
    assert solved(found)["solver.fix.valid"].all()
    heard = solved(found, future=False)
    np.testing.assert_array_equal(heard["solver.fix.valid"], EPOCHS >= 150.0)


def test_it_begins_where_it_is_told_to(imported, solved):
    """t = 0 is second 345660 of the week: two epochs are left out, the others come a minute earlier."""
    sky = Sky()
    found = imported(sky.observations(EPOCHS), sky.navigation(), start=SECOND + 60.0)
    assert any(sentence == "2 epoch(s) before t = 0 are left out" for sentence in found.sentences())
    result = solved(found)
    np.testing.assert_array_equal(result["observations.signals.seconds"], SECOND + EPOCHS[2:])
    np.testing.assert_array_equal(result["observations.signals.time_of_validity"], EPOCHS[2:] - 60.0)


def test_epochs_within_a_tick_are_lost_and_told(imported, solved):
    sky = Sky()
    found = imported(sky.observations(np.arange(0.0, 4.0, 0.05)), sky.navigation())
    (told,) = (sentence for sentence in found.sentences() if "are lost" in sentence)
    with pytest.warns(match=r"40 samples of 'solver\.signals' were lost"):
        result = solved(found, tick=0.1)
    assert told.startswith(f"with ticks of 0.1 s {80 - len(result)} of 80 epochs are lost")
    np.testing.assert_allclose(east_north_up(sky, result), 0.0, atol=5e-3)


def test_epochs_that_are_late_by_less_than_a_tick_resolves_are_solved_at_once(imported, solved):
    """By a receiver's clock that drifts. An epoch that came, and held for a microsecond later, waited until then: it
    was solved a tick late, or lost, for the next one had come."""
    sky = Sky()
    times = 2.0 * np.arange(10) + 1e-6 * (np.arange(10) > 0)
    with pytest.warns(match=r"1 sample of 'solver\.signals' was lost"):  # two come in the first tick
        result = solved(imported(sky.observations(times), sky.navigation()), tick=2.0)
    seconds = result["observations.signals.seconds"].to_numpy()
    np.testing.assert_allclose(seconds - SECOND, times[1:], atol=1e-7)
    np.testing.assert_array_equal(result["solver.fix.time_of_validity"], 2.0 * np.arange(1, 10))


def test_time_tags_of_utc_that_no_reader_sees_are_no_fix(imported, solved):
    """At an epoch a second nothing shows that tags are 18 s late; positions would be kilometres off."""
    sky = Sky()
    found = imported(sky.observations(np.arange(0.0, 20.0), tags=-18.0), sky.navigation())
    assert not solved(found, tick=0.5)["solver.fix.valid"].any()


def test_epochs_that_are_solved_show_tags_that_no_reader_sees(imported, tmp_path_factory, monkeypatch):
    """A second late at an epoch a second; nothing is refused of what is right, and of too few satellites for a test."""
    sky, solver = Sky(), built.fmu("gps_solver", tmp_path_factory)
    times, nav = np.arange(0.0, 8.0), sky.navigation()
    told = imported(sky.observations(times), nav, solver=solver).sentences()
    assert "of 8 epochs that were solved 8 give a fix" in told
    late = sky.observations(times, tags=1.0)
    with pytest.raises(NavfmuError, match="none of 8 epochs that were solved agrees with itself"):
        imported(late, nav, solver=solver)
    taken = imported(late, nav, solver=solver, unchecked=True).sentences()
    assert sum(sentence.startswith("not plausible, and taken: none of 8 epochs") for sentence in taken) == 1
    monkeypatch.setenv("NAVFMU_CACHE", "/proc/none")
    assert any("no epoch could be solved on this machine" in s for s in imported(late, nav, solver=solver).sentences())
    over = [k for k in range(32) if sky.high(k, 0.0)]
    few = sky.observations(times, tags=1.0, left_out=lambda k, time: k not in over[:5])
    assert not any("solved" in sentence for sentence in imported(few, nav, solver=solver).sentences())


def test_an_fmu_of_observations_is_one_as_others(imported, tmp_path):
    sky = Sky()
    fmu = imported(sky.observations(EPOCHS), sky.navigation()).write(tmp_path / "seen.fmu")
    assert validate_fmu(str(fmu)) == []


def test_has_what_a_system_connects_of_the_receiver_that_it_replaces(player, tmp_path_factory):
    """Inputs of the truth and outputs of the bundle have the same names, types and units."""

    def face(path):
        variables = fmpy.read_model_description(str(path)).modelVariables
        return {v.name: (v.causality, v.type, v.unit) for v in variables if v.causality in ("input", "output")}

    own, other = face(player), face(built.fmu("gps_signals", tmp_path_factory))
    faults = built.components()["gps_signals"].layout.fields
    needed = {n for n, v in other.items() if v[0] == "output" or not faults[n.partition("[")[0]].fault}
    assert {name: own[name] for name in needed} == {name: other[name] for name in needed}
    assert set(own) <= set(other)  # a fault that cannot act on a recording is not there


def test_jammed_and_silent_satellites_are_not_tracked_and_come_back_at_once(imported, solved):
    sky = Sky()
    found = imported(sky.observations(EPOCHS), sky.navigation())
    prn = int(found.epochs.number[0, 0])
    off = [False] * 32
    off[prn - 1] = True
    faults = (
        Fault("jam", "observations.jammed", "input", value=True, start=100.0, duration=60.0),
        Fault("silent", "observations.satellite_off", "input", value=off, start=200.0, duration=45.0),
    )
    plain, failed = solved(found), solved(found, faults=faults)
    jammed, silent = (EPOCHS > 100.0) & (EPOCHS < 160.0), (EPOCHS > 200.0) & (EPOCHS < 245.0)
    np.testing.assert_array_equal(failed["observations.satellites"][jammed], 0)
    np.testing.assert_array_equal(failed["solver.fix.valid"], ~jammed)
    np.testing.assert_array_equal(failed["observations.signals.tracked[1]"], ~jammed & ~silent)
    np.testing.assert_array_equal(
        failed["observations.satellites"][silent], plain["observations.satellites"][silent] - 1
    )
    both = ~jammed & ~silent
    for name in (f"observations.signals.pseudorange[{i + 1}]" for i in range(PLACES)):
        np.testing.assert_array_equal(failed[name], plain[name])
    np.testing.assert_array_equal(failed["observations.satellites"][both], plain["observations.satellites"][both])
    np.testing.assert_allclose(east_north_up(sky, failed)[both], 0.0, atol=5e-3)


def test_a_satellite_that_steps_is_left_out_and_a_clock_that_jumps_changes_no_place(imported, solved):
    """100 m of one satellite; 1 ms of the clock: if only the tag jumped the clock would be 1 ms behind."""
    sky = Sky()
    found = imported(sky.observations(EPOCHS), sky.navigation())
    prn = int(found.epochs.number[0, 2])
    step = [0.0] * 32
    step[prn - 1] = 100.0
    faults = (
        Fault("step", "observations.range_step", "input", value=step, start=50.0, duration=50.0),
        Fault("jump", "observations.clock_jump", "input", value=1e-3, start=140.0),
    )
    result = solved(found, faults=faults)
    stepped, jumped = (EPOCHS > 50.0) & (EPOCHS < 100.0), EPOCHS >= 150.0
    np.testing.assert_array_equal(result["solver.excluded[3]"], stepped)
    np.testing.assert_allclose(east_north_up(sky, result), 0.0, atol=1e-2)
    np.testing.assert_allclose(result["observations.signals.seconds"], SECOND + EPOCHS + 1e-3 * jumped, atol=1e-9)
    expected = sky.clock + sky.drift * EPOCHS + 1e-3 * jumped
    np.testing.assert_allclose(result["solver.clock_bias"], expected, rtol=0, atol=5e-11)


def test_a_clock_that_jumps_takes_the_tag_into_another_week():
    """As gps_signals tells it: 0 to 604800 s, not more and not less."""
    for jump, week, second in ((259200.0, 705, 1.0), (-345602.0, 703, 604799.0)):
        player = interpret(ObservationsReplay, tick_period=1.0, clock_jump=jump)
        player.do_step(0.0, 1.0)
        assert player.get("signals.week") == week
        assert player.get("signals.seconds") == second


@pytest.mark.parametrize(
    ("observed", "sent", "words"),
    [
        ({}, {"weeks": -1024}, "they are 1024 weeks apart, by which weeks are told modulo 1024"),
        ({}, {"toe": 86400.0 + 7200.0}, "at no epoch there are orbits for 4 of the satellites: they are of 2020-06-26"),
        ({}, {"of": [0, 1]}, "has orbits of the satellites 1, 2, and "),
        ({}, {"health": 63}, "4 of the satellites call themselves healthy"),
        ({"doppler": -1.0}, {}, "Doppler with the other sign would agree"),
        ({"doppler": -299792458.0 / 1575.42e6}, {}, "Doppler in m/s, positive where ranges grow, would agree"),
        ({"doppler": 1e3}, {}, "expected -12000 to 12000"),
        ({"tags": -18.0}, {}, "as if they were counted in UTC, which is 18 s behind GPS time. If all is as it should"),
        ({"tags": 18.0}, {}, "as if they were 18 s ahead of GPS time"),
    ],
)
def test_what_cannot_be_so_is_refused(imported, observed, sent, words):
    sky = Sky()
    with pytest.raises(NavfmuError, match=r"seen\.rnx\.gz") as told:
        imported(sky.observations(EPOCHS[:4], **observed), sky.navigation(**sent))
    assert words in str(told.value)


def test_what_is_not_plausible_is_taken_and_told(imported):
    sky = Sky()
    found = imported(sky.observations(EPOCHS[:4], tags=-18.0), sky.navigation(), unchecked=True)
    assert any(sentence.startswith("not plausible, and taken: epochs are") for sentence in found.sentences())


def test_a_receiver_that_tells_no_strength_is_solved_as_another(imported, solved):
    """Files of version 2 often have none; nothing but the mask of the solver, which is off, asks for it."""
    sky = Sky()
    found = imported(sky.observations(EPOCHS[:4]).replace("S1C", "S5X"), sky.navigation())
    assert "there is no S1C: C/N0 is told as 0 dB-Hz" in found.sentences()
    np.testing.assert_allclose(east_north_up(sky, solved(found)), 0.0, atol=5e-3)


def test_range_rates_are_made_of_phases_where_there_is_no_doppler(imported, solved):
    """A standing receiver and one epoch a second: 3 mm/s, as far as digits of millimetres tell. Of the wrong sign it
    would be km/s. Nothing is made across a loss of lock, nor at the ends."""
    sky = Sky()
    seen = sky.observations(np.arange(20.0))
    assert "C1C D1C" in seen

    def phases(line):
        if not line.startswith("G") or line[13] != ".":
            return line
        return f"{line[:19]}{float(line[3:17]) * 1575.42e6 / 299792458.0:14.3f}{line[33:]}"

    lines = [phases(line) for line in seen.replace("C1C D1C", "C1C L1C").splitlines()]
    again = max(k for k, line in enumerate(lines) if line.startswith(lines[-1][:3]) and k < len(lines) - 5)
    lines[again] = lines[again][:33] + "1" + lines[again][34:]
    found = imported("\n".join(lines) + "\n", sky.navigation(), names={"range_rate": "L1C"})
    result = solved(found, tick=0.5)
    velocity = np.stack([result[f"solver.fix.velocity_n[{k}]"] for k in (1, 2, 3)], axis=1)[result["solver.fix.valid"]]
    assert len(velocity) == 18
    assert np.max(np.abs(velocity)) < 3e-3
    assert found.epochs.lacking == 2 * np.count_nonzero(found.epochs.number[5]) + 2


def test_slopes_of_phases_are_those_of_parabolas_at_any_intervals():
    """A backward difference is off by half an interval of acceleration."""
    time = np.array([0.0, 1.0, 1.5, 4.0, 5.0, 200.0, 201.0])
    phase = (3.0 + 2.0 * time - 0.7 * time**2)[:, None]
    lost = np.zeros(phase.shape, bool)
    found = doppler(time, phase, lost)[:, 0]
    np.testing.assert_allclose(found[1:4], -(2.0 - 1.4 * time[1:4]), rtol=1e-12)
    assert np.all(np.isnan(found[[0, 4, 5, 6]]))  # ends, and a gap
    lost[2] = True
    np.testing.assert_array_equal(np.isfinite(doppler(time, phase, lost)[:, 0]), np.arange(7) == 3)
    jumped = phase + 1575420.0 * (time[:, None] > 3.0)  # by a millisecond of the receiver's clock
    np.testing.assert_array_equal(np.isfinite(doppler(time, jumped, np.zeros_like(lost))[:, 0]), np.arange(7) == 1)


def test_signals_that_are_hardly_there_are_told(imported):
    """Of a receiver behind an attenuator four signals of 16 to 20 dB-Hz made positions that were 60 km off."""
    sky = Sky()
    seen = sky.observations(EPOCHS[:2])
    count = seen.count(f"{45.0:14.3f}")
    found = imported(seen.replace(f"{45.0:14.3f}", f"{18.0:14.3f}", 3), sky.navigation())
    (told,) = (sentence for sentence in found.sentences() if "weaker" in sentence)
    assert told.startswith(f"3 of {count} measurements are weaker than 25 dB-Hz")
    assert not any("weaker" in sentence for sentence in imported(seen, sky.navigation()).sentences())


def test_files_that_are_cut_off_or_others(imported):
    sky = Sky()
    seen, sent = sky.observations(EPOCHS[:2]), sky.navigation()
    for observations, navigation, words in (
        (seen[: -len(seen) // 4], sent, "cut off"),
        (seen, made.yuma(1, 2, week=2111), "is a YUMA almanac, whose satellites are off by a kilometre"),
        (seen, made.sem(1, 2), "is a SEM almanac, whose satellites"),  # its week modulo 1024 is none of our trouble
        (seen.replace("D1C", "D2C"), sent, "has no 'D1C' of which range_rate .* with D1, or a phase, L1: it has none"),
        (seen.replace("D1C", "L1C"), sent, "it has L1C, which --column range_rate=L1C takes"),
        (seen.replace("C1C", "C1W"), sent, "it has C1W, which --column pseudorange=C1W takes"),
        (sent, sent, "expected a RINEX observation file"),
    ):
        with pytest.raises(NavfmuError, match=words):
            imported(observations, navigation)


def test_the_command(tmp_path, player, monkeypatch, tmp_path_factory):
    """An FMU, a picture and the ionosphere's parameters; each wrong option is a sentence and nothing is written."""
    for name in ("gps_solver", "gps_replay"):
        built.fmu(name, tmp_path_factory)
    monkeypatch.setattr(shipped, "folders", lambda: [player.parent])
    sky = Sky()
    seen = written(tmp_path, "seen.rnx", sky.observations(EPOCHS[:3]))
    nav = written(tmp_path, "nav.rnx", sky.navigation())
    out, ssv, png = (tmp_path / f"made.{end}" for end in ("fmu", "ssv", "png"))

    def run(*arguments):
        told = CliRunner().invoke(main, ["replay", *map(str, arguments), "--out", str(out)])
        return told.exit_code, " ".join(told.output.split())

    for arguments, words in (
        (("observations", seen), "observations need orbits; expected --nav"),
        (("observations", seen, "--nav", nav, "--unit", "range_rate=m/s"), "--unit is not for observations"),
        (("observations", seen, "--nav", nav, "--column", "pseudorang=C1C"), "did you mean 'pseudorange'"),
        (("observations", seen, "--nav", nav, "--column", "pseudorange=C2W"), "begins with C1"),
        (("observations", seen, "--nav", nav, "--start", "345700"), "all epochs are before --start 345700"),
        (("observations", seen, "--nav", nav, "--start", "1277078418"), "more than a week from the first epoch"),
        (("observations", seen, "--nav", nav, "--start", "nan"), "--start is nan; expected a number of seconds"),
        (("observations", seen, "--nav", nav, "--age", "1"), "--age is not for observations"),
        (("observations", seen, "--nav", nav, "--ionosphere", tmp_path / "a.txt"), "expected .ssv"),
        (("gps", seen, "--nav", nav), "--nav is for observations"),
    ):
        code, told = run(*arguments)
        assert code == 2 and words in told, told
        assert not out.exists()
    code, told = run("observations", seen, "--nav", nav, "--ionosphere", ssv, "--picture", png)
    assert code == 0 and "3 epochs" in told and "ionosphere_alpha for gps_solver" in told, told
    assert out.exists() and png.read_bytes()[1:4] == b"PNG"
    assert b'name="ionosphere_beta[4]"' in ssv.read_bytes() and b"-524290.0" in ssv.read_bytes()


def test_the_system_of_the_page_is_built_and_solves(imported, player, monkeypatch, tmp_path, tmp_path_factory):
    solver = built.fmu("gps_solver", tmp_path_factory)
    monkeypatch.setattr(shipped, "folders", lambda: [player.parent])
    monkeypatch.chdir(tmp_path)
    sky = Sky()
    found = imported(sky.observations(EPOCHS), sky.navigation())
    found.write("observations.fmu")
    (tmp_path / "ionosphere.ssv").write_bytes(found.ionosphere(solver))
    page = (Path(__file__).parents[2] / "docs" / "sensors" / "observations.md").read_text(encoding="utf-8")
    exec(page.partition("```python\n")[2].partition("```")[0], {})
    result = System.load("day.ssp").run(stop=280.0, record=["solver.fix"])
    assert result["solver.fix.sequence"].iloc[-1] == len(EPOCHS) and result["solver.fix.valid"].iloc[-1]
