"""One value travels: keys, provenance and commands are views of the experiment, and what Python gets wrong is told."""

from __future__ import annotations

import json
import shlex
import warnings
from dataclasses import replace

import grimp
import numpy as np
import pytest
from click.testing import CliRunner

from navfmu import Experiment, NavfmuError, NavfmuWarning, System
from navfmu.cli.main import main
from navfmu.engine.monitor import Monitor
from navfmu.faults import Fault
from navfmu.system import provenance
from navfmu.system.result import read
from tests import built
from tests.components import systems

BIAS = Fault("b", "lag.y", "bias", 1.0, 2.0, {"value": 0.5})


@pytest.fixture(scope="module")
def system() -> System:
    return System.load(systems.tracker())


@pytest.fixture(scope="module")
def experiment(system) -> Experiment:
    return system.experiment(stop=5.0, seed=3, faults=[BIAS], record=["lag", "sensor.reading"])


@pytest.mark.parametrize(("name", "text", "same"), [("stop", "0.1 min", 6.0), ("step", "50 ms", 0.05)])
def test_a_time_may_be_a_text(experiment, name, text, same):
    assert getattr(replace(experiment, **{name: text}), name) == same
    assert replace(experiment, record_period="500 ms").key == replace(experiment, record_period=0.5).key
    with pytest.raises(NavfmuError, match=f"{name} is '5 furlongs': 'furlongs' is no unit of time"):
        replace(experiment, **{name: "5 furlongs"})


CHANGES = {
    "stop": 6.0,
    "step": 0.05,
    "algorithm": "jacobi",
    "seed": 4,
    "faults": [replace(BIAS, start=1.1)],
    "record": ["lag"],
    "record_period": 0.5,
    "parameters": {"lag.tau": 2.0},
    "engine": "reference",
    "monitors": [Monitor("m", "lag.y", most=2.0)],
}


@pytest.mark.parametrize("name", CHANGES)
def test_a_key_covers_everything_that_is_done(experiment, name):
    assert replace(experiment, **{name: CHANGES[name]}).key != experiment.key


def test_a_key_covers_the_system_and_the_package(experiment, system, monkeypatch):
    assert replace(experiment).key == experiment.key
    slow = System.load(systems.tracker(), "slow")
    assert replace(experiment, system=slow).key != experiment.key
    before = experiment.key
    monkeypatch.setattr(provenance, "package_hash", lambda: "mended")
    assert replace(experiment).key != before


def test_the_hash_of_the_package_covers_every_module_that_makes_a_recording():
    graph = grimp.build_graph("navfmu", cache_dir=None)
    used = set(graph.find_upstream_modules("navfmu.system.system"))
    used |= {m for name in ("compiled", "reference") for m in graph.find_upstream_modules(f"navfmu.engine.{name}")}
    rooms = {module.split(".")[1] for module in used if "." in module}
    # the toolchain, which engine/library.py hashes itself, and what a system says about its report
    assert rooms - set(provenance.ROOMS) == {"export", "report"}
    assert {m for m in used if m.startswith("navfmu.export.")} == {"navfmu.export.toolchain"}


def test_a_changed_line_in_any_of_these_rooms_changes_the_hash(tmp_path, monkeypatch):
    file = tmp_path / "engine" / "plan.py"
    file.parent.mkdir()
    monkeypatch.setattr(provenance, "_PACKAGE", tmp_path)
    hashes = []
    for text in ("x = 1\n", "x = 2\n"):
        file.write_text(text)
        provenance.package_hash.cache_clear()
        hashes.append(provenance.package_hash())
    provenance.package_hash.cache_clear()
    assert hashes[0] != hashes[1]


def test_a_description_survives_json_and_becomes_the_same_experiment(experiment, system):
    monitors = [Monitor("m", "lag.y", most=2.0, when="time > 1 s", tolerance=0.5), Monitor("n", "lag.y < 3")]
    experiment = replace(experiment, monitors=monitors)
    text = json.dumps(experiment.describe())
    again = Experiment.restored(json.loads(text), system)
    assert again.key == experiment.key and json.dumps(again.describe()) == text
    with pytest.raises(NavfmuError, match="is not the system that was run"):
        Experiment.restored(json.loads(text), System.load(systems.tracker(), "slow"))


def test_the_command_repeats_what_python_did_faults_included(system, tmp_path):
    faults = [
        BIAS,
        Fault("n", "sensor.reading.length", "noise", 0.5, parameters={"sigma": 0.1, "period": 0.2, "stream": 7}),
        Fault(
            "i", "lag.bias", "input", 2.0, 1.0, {"value": -1.5}, fmea="F7", description='a "quoted" text, with commas'
        ),
    ]
    frame = system.run(
        stop=5.0, step=0.05, seed=9, faults=["stuck", *faults], algorithm="jacobi", record=["lag", "*.length"],
        parameters={"lag.tau": "2 s", "truth.amplitude": np.float64(3.5)}, record_period=0.25,
    )  # fmt: skip
    words = shlex.split(frame.attrs["provenance"]["command"])
    out = tmp_path / "again.parquet"
    done = CliRunner().invoke(main, [*words[1:], "--out", str(out)])
    assert done.exit_code == 0, done.output
    again = read(out)
    assert again.equals(frame)
    assert again.attrs["provenance"] | {"command": ""} == frame.attrs["provenance"] | {"command": ""} | {
        "parameters": {"lag.tau": "2 s", "truth.amplitude": "3.5"}
    }


WRONG = {
    "a fault as a table": ({"faults": [{"id": "x"}]}, "expected the name of a fault file, or a navfmu.Fault such as"),
    "a number as a signal": ({"record": [1]}, "record: 1 is not the name of a signal"),
    "an argument that is misspelt": ({"fault": BIAS}, "an experiment has no 'fault'; did you mean 'faults'"),
    "parameters as a list": ({"parameters": ["lag.tau"]}, "expected values by name"),
    "parameters by component": ({"parameters": {"lag": {"tau": 2.0}}}, "for each name: {'lag.tau': 2.0}"),
    "a component as a parameter": ({"parameters": {"lag": 2.0}}, "parameter 'lag' names none; expected component.par"),
    "a number as a parameter": ({"parameters": {1: 2.0}}, "parameter 1 names none; expected component.parameter"),
    "a number as progress": ({"progress": 5}, "progress is 5, expected a function that is called with"),
    "an empty name of a fault file": ({"faults": ""}, "faults: the name of the file is empty"),
    "a seed that is a truth": ({"seed": True}, "the seed is True, expected a whole number"),
    "an engine that there is not": ({"engine": "compield"}, "unknown engine 'compield'; did you mean 'compiled'"),
    "a number as faults": ({"faults": 5}, "faults: 5 is no list of faults"),
    "a number as record": ({"record": 5}, "record: 5 is no list of names of signals"),
    "nothing to record": ({"record": []}, "the list of signals is empty"),
    "two faults of one name": ({"faults": [BIAS, BIAS]}, "two faults have the id 'b'"),
}


@pytest.mark.parametrize("name", WRONG)
def test_python_answers_in_a_sentence(system, name):
    given, sentence = WRONG[name]
    with pytest.raises(NavfmuError, match=sentence):
        system.run(stop=1.0, **given)


def test_one_fault_needs_no_list(system):
    alone = system.run(stop=3.0, faults=BIAS, record="lag.y")
    assert alone.equals(system.run(stop=3.0, faults=[BIAS], record=["lag.y"]))


def test_notes_reach_python_as_warnings_and_the_result():
    ring = System.load(systems.ring())
    with pytest.warns(NavfmuWarning, match="the system has cycles; one communication step late: m5.y -> m0.u"):
        frame = ring.run()
    assert any("cycles" in note for note in frame.attrs["notes"])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ring.run(algorithm="jacobi")


def test_lost_samples_and_what_has_no_effect_are_notes(system):
    with pytest.warns(NavfmuWarning, match="were lost"):
        frame = system.run(stop=5.0, step=1.0, record=["lag.y"])
    done = CliRunner().invoke(main, ["run", str(systems.tracker()), "--stop", "5", "--step", "1"])
    assert done.exit_code == 0 and "were lost" in done.stderr and any("were lost" in n for n in frame.attrs["notes"])


def test_the_order_of_parameters_that_overlap_is_part_of_the_key(system):
    """An element after its array wins, before it is lost: two results, so two keys."""
    from navfmu.campaign.runs import _laid_over

    first, then = {"sensor.sigma": 0.1}, {"lag.tau": 2.0}
    assert system.experiment(parameters=first | then).key != system.experiment(parameters=then | first).key
    assert list(_laid_over({"a.b": 1, "a.b[1]": 2}, {"a.b": 3})) == ["a.b[1]", "a.b"]


FILE = '[[fault]]\nid = "one"\ntarget = "lag.y"\ntype = "bias"\nvalue = 1.0\nstart = 1.0\n'
FILE += '[[fault]]\nid = "two"\ntarget = "lag.y"\ntype = "stuck"\nstart = 2.0\nduration = 1.0\n'
INLINE = Fault("in", "lag.y", "stuck", start=np.float64(0.5), duration=np.float32(0.5), value=[np.float64(0.25)])


@pytest.mark.parametrize("way", ["some", "edited", "inline first", "inline last", "all", "array of texts"])
def test_a_command_repeats_whatever_became_of_the_faults_of_a_file(system, way, tmp_path):
    file = tmp_path / "ff.toml"
    file.write_text(FILE)
    loaded = system.faults(str(file))
    edited = replace(loaded[0], parameters={"value": 5.0})
    faults = {
        "some": loaded[:1], "edited": [edited, loaded[1]], "inline first": [INLINE, str(file)],
        "inline last": [str(file), INLINE], "all": [str(file)], "array of texts": [INLINE],
    }[way]  # fmt: skip
    given = {"stop": 4.0, "seed": 2, "faults": faults, "record": ["lag.y", "estimator"]}
    frame = system.run(**given)
    words = shlex.split(frame.attrs["provenance"]["command"])
    assert ("--faults" in words) == (way in ("inline last", "all"))
    done = CliRunner().invoke(main, [*words[1:], "--out", str(tmp_path / "again.parquet")])
    assert done.exit_code == 0, done.output
    assert read(tmp_path / "again.parquet").equals(frame)


def test_a_list_of_texts_is_written_as_it_is_read(system):
    from navfmu.fmi.values import expand
    from navfmu.system.experiment import _word

    text = _word(["1 m", 2.5, True])
    assert text == "[1 m, 2.5, true]"
    description = system.fmus["lag"].description
    assert expand(description, {"tau": _word(["2 s"])}, "x") == {"tau": 2.0}


CONTRADICTIONS = {
    "an array, then an element": (
        {"imu.gyro_null_shift": [1e-6, 2e-6, 3e-6], "imu.gyro_null_shift[2]": 5e-6},
        ["'imu.gyro_null_shift' and 'imu.gyro_null_shift[2]' set 'imu.gyro_null_shift[2]' to different values: the "
         "last one holds"],
    ),
    "an element, then the array": (
        {"imu.gyro_null_shift[2]": 5e-6, "imu.gyro_null_shift": 0.0},
        ["'imu.gyro_null_shift[2]' and 'imu.gyro_null_shift' set 'imu.gyro_null_shift[2]' to different values: the "
         "last one holds"],
    ),
    "the same value twice": ({"imu.gyro_null_shift": 5e-6, "imu.gyro_null_shift[2]": "5e-6 rad/s"}, []),
    "a seed": ({"imu.seed": 3}, ["the seed of 'imu' is 3, as its parameter says, not that of the run"]),
    "the same seed": ({"imu.seed": 9}, []),
}  # fmt: skip


@pytest.mark.parametrize("name", CONTRADICTIONS)
def test_which_of_two_settings_holds_is_told(name, tmp_path_factory):
    parameters, notes = CONTRADICTIONS[name]
    imu = System.load(built.fmu("imu", tmp_path_factory))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        frame = imu.run(stop=0.1, step=0.01, seed=9, parameters=parameters)
    assert frame.attrs["notes"] == notes
    words = [word for name, value in parameters.items() for word in ("--set", f"{name}={value}")]
    words = ["run", str(imu.structure.origin), "--stop", "0.1", "--step", "0.01", "--seed", "9", *words]
    done = CliRunner().invoke(main, words)
    assert done.exit_code == 0 and done.stderr == "".join(f"note: {note}\n" for note in notes)


def test_a_seed_of_a_parameter_needs_no_note_where_the_run_has_none(tmp_path_factory):
    imu = System.load(built.fmu("imu", tmp_path_factory))
    assert imu.experiment(stop=0.1, step=0.01, parameters={"imu.seed": 3}).notes == []


def test_two_sensors_of_one_stream_are_told_to_have_the_same_noise(tmp_path_factory):
    """They differ by nothing: an average of two gains nothing, and a difference shows no error."""
    from navfmu.ssp import SystemSource

    source = SystemSource("two_units")
    for name in ("left", "right"):
        source.component(name, built.fmu("imu", tmp_path_factory))
    system = System.load(source.pack(tmp_path_factory.mktemp("two") / "two.ssp"))
    alike, apart = (system.experiment(stop=0.1, step=0.01, seed=9, parameters=p) for p in ({}, {"right.stream": 7}))
    assert [note for note in apart.notes if "noise" in note] == []
    (note,) = (note for note in alike.notes if "noise" in note)
    assert note.startswith("'left' and 'right' have the same noise, as they have the same seed 9 and the same stream ")
