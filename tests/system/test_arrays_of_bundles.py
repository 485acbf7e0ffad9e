"""Arrays of bundles in a system: connected as a whole, each with losses and failures of its own."""

import numpy as np
import pytest

from navfmu import Fault, System
from navfmu.errors import NavfmuError
from navfmu.export.build import build
from navfmu.sabotage.saboteur import saboteurs
from navfmu.ssp.writer import SystemSource
from navfmu.testing.target import usual_type
from tests.export.arrays import Beacons, Receiver

STOP, H = 2.0, 0.1
DROPPED = range(11, 16)  # ticks from 1.0 s on, for 0.5 s: what leaves at 1.0 s is new at the tick at 1.1 s


@pytest.fixture(scope="module")
def fmus(tmp_path_factory):
    folder = tmp_path_factory.mktemp("beacons")
    build([Beacons, Receiver], folder, pictures=False)
    return folder


@pytest.fixture(scope="module")
def system(fmus):
    source = SystemSource("heard", fmus=fmus, stop_time=STOP, step=H)
    source.component("beacons", "beacons.fmu").component("receiver", "receiver.fmu")
    source.connect("beacons.beacon", "receiver.beacon")
    source.parameters("beacons", {"u": [1.0, 2.0, 3.0]})
    return System.load(source.pack(fmus / "heard.ssp"))


def of_each(frame, name):
    return [frame[name.format(i)].iloc[-1] for i in (1, 2, 3)]


def test_an_array_is_connected_bundle_by_bundle(system):
    assert len(system.links) == 3 * (1 + 2 + 3)
    frame = system.run(record=["receiver", "beacons.beacon[2]"])
    assert of_each(frame, "receiver.held[{}]") == [1.0, 2.0, 3.0]
    assert frame["beacons.beacon[2].parts[2]"].iloc[-1] == -1.0
    assert [name for name in frame if name.startswith("beacons.")] == [
        f"beacons.beacon[2].{member}"
        for member in ("range", "parts[1]", "parts[2]", "valid", "sequence", "time_of_validity")
    ]


@pytest.mark.filterwarnings("ignore:.*samples of 'receiver")
@pytest.mark.parametrize("algorithm", ["jacobi", "gauss_seidel"])
@pytest.mark.parametrize(
    ("target", "hit"),
    [
        ("beacons.beacon[2]", (2,)),
        ("receiver.beacon[3]", (3,)),
        ("beacons.beacon", (1, 2, 3)),
        ("receiver.beacon", (1, 2, 3)),
    ],
)
def test_one_or_all_of_an_array_drop_out(system, target, hit, algorithm):
    """A dropout of the array's second bundle must not hold the others' numbers, nor the receiver's count of losses."""
    fault = Fault("out", target, "dropout", 1.0, 0.5)
    frame = system.run(algorithm=algorithm, faults=[fault])
    sound = system.run(algorithm=algorithm)
    missed = [len(DROPPED) if i in hit else 0 for i in (1, 2, 3)]
    heard, lost = of_each(frame, "receiver.updates[{}]"), of_each(frame, "receiver.beacon[{}].lost")
    assert np.subtract(of_each(sound, "receiver.updates[{}]"), heard).tolist() == missed
    assert lost == missed
    assert usual_type(system, target) == "dropout"


@pytest.mark.filterwarnings("ignore:.*samples of 'receiver")
def test_each_bundle_counts_its_own_losses(system):
    """The second beacon is silent for a while: it loses nothing where the step is longer than the period."""
    silent = Fault("silent", "beacons.on[2]", "input", 0.0, 1.0, value=False)
    frame = system.run(step=0.5, faults=[silent])
    assert of_each(frame, "receiver.beacon[{}].lost") == [16, 8, 16]
    assert of_each(frame, "receiver.updates[{}]") == [4, 2, 4]


def test_names_reach_one_bundle(system):
    frame = system.run()
    assert frame["beacons.beacon[3].range"].max() == 3.0
    with pytest.raises(NavfmuError, match=r"no variable 'beacon\[4\]\.range'; indices go from 'beacon\[1\]\.range' to"):
        system.run(record=["beacons.beacon[4].range"])
    with pytest.raises(NavfmuError, match=r"bundles of 'beacons': 'beacon\[1\]', 'beacon\[2\]', 'beacon\[3\]'"):
        system.run(faults=[Fault("out", "beacons.beacon[4]", "dropout", 1.0)])
    with pytest.raises(NavfmuError, match=r"'beacon' is a bundle"):
        system.run(parameters={"receiver.beacon": 1.0})


def test_a_member_of_all_bundles_is_an_array(system, fmus):
    """It is connected, recorded, asked and made wrong like any other array."""
    source = SystemSource("shown", fmus=fmus, stop_time=STOP, step=H)
    source.component("first", "beacons.fmu").component("second", "beacons.fmu")
    source.connect("first.beacon.range", "second.u").parameters("first", {"u": [4.0, 5.0, 6.0]})
    shown = System.load(source.pack(fmus / "shown.ssp")).run()
    assert of_each(shown, "second.beacon[{}].range") == [4.0, 5.0, 6.0]
    wrong = Fault(
        "wrong", "beacons.beacon.range", "bias", value=[1.0, 2.0, 3.0], when="max(beacons.beacon.range) > 2 m"
    )
    frame = system.run(faults=[wrong], record=["receiver.beacon.range"])
    assert list(frame) == [f"receiver.beacon[{i}].range" for i in (1, 2, 3)]
    assert of_each(frame, "receiver.beacon[{}].range") == [2.0, 4.0, 6.0]


def test_a_saboteur_takes_the_other_members_of_the_bundle_that_fails_and_of_no_other(system):
    faults = [Fault("late", "beacons.beacon[2].range", "delay", delay=0.2)]
    experiment = system.experiment(stop=STOP, step=H, faults=faults)
    (one,) = saboteurs(experiment.plan(), system.links, 5, False)
    assert sorted(one.outputs.values()) == sorted(
        f"beacon[2].{member}" for member in ("range", "parts[1]", "parts[2]", "valid", "sequence", "time_of_validity")
    )
    assert ("true.beacon[2].parts", (2,)) in [(v.name, v.shape) for v in one.model.variables]
