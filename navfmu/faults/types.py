"""The types of faults: on what each acts, what it takes, and what it does. Everything else asks this table."""

from __future__ import annotations

from dataclasses import dataclass

OUTPUT, CONNECTED, INPUT, PARAMETER = "output", "connected input", "unconnected input", "tunable parameter"
COMPONENT = "component"
SIGNALS = (OUTPUT, CONNECTED)
ANY = ("Real", "Integer", "Boolean")


@dataclass(frozen=True)
class Parameter:
    """What a fault takes, by a name; ``sort`` says what it may be (``checks.SORTS``, and units in the engine)."""

    name: str
    sort: str
    words: str
    required: bool = True


@dataclass(frozen=True)
class FaultType:
    """What a type of fault acts on and which parameters it takes."""

    name: str
    places: tuple[str, ...]  # what it acts on
    values: tuple[str, ...]  # FMI types of that
    parameters: tuple[Parameter, ...]
    effect: str  # in words
    bundles: str = ""  # "members": a bundle stands for all its members; "only": nothing else does; "": none
    draws: str = ""  # the parameter with which it takes numbers at random

    @property
    def required(self) -> tuple[str, ...]:
        """Parameters that must be given."""
        return tuple(parameter.name for parameter in self.parameters if parameter.required)

    @property
    def optional(self) -> tuple[str, ...]:
        """Parameters that may be given."""
        return tuple(parameter.name for parameter in self.parameters if not parameter.required)

    @property
    def target(self) -> str:
        """What it acts on, in words: "Real output or connected input"."""
        if self.bundles == "only":
            return "bundle"
        of = "Real " if self.values == ("Real",) else ""
        return of + " or ".join(self.places)

    @property
    def targets(self) -> str:
        """The same in the plural: "Real outputs and connected inputs"."""
        of = "Real " if self.values == ("Real",) else ""
        return "bundles" if self.bundles == "only" else of + " and ".join(f"{place}s" for place in self.places)

    def parameter(self, name: str) -> Parameter:
        """Its parameter of a name."""
        return next(parameter for parameter in self.parameters if parameter.name == name)

    def supports(self, place: str, value: str) -> bool:
        """Whether it acts on a variable: what that is in the system, and its FMI type."""
        return place in self.places and value in self.values


STREAM = Parameter("stream", "stream", "number of the random stream; default: made from the id", required=False)


def _signal(
    name: str,
    effect: str,
    *parameters: Parameter,
    values: tuple[str, ...] = ("Real",),
    bundles: str = "",
    draws: str = "",
) -> FaultType:
    return FaultType(name, SIGNALS, values, parameters, effect, bundles, draws)


TYPES: dict[str, FaultType] = {
    entry.name: entry
    for entry in (
        _signal("bias", "v + value", Parameter("value", "difference", "what is added")),
        _signal("scale", "v * factor", Parameter("factor", "factor", "what it is multiplied by")),
        _signal("flip", "-v"),
        _signal("drift", "v + rate * (t - start)", Parameter("rate", "rate", "change per s")),
        _signal(
            "unit",
            "the number of v in that unit, as if it were in the right one",
            Parameter("unit", "unit", 'unit in which the number is sent, such as "ft"'),
        ),
        _signal(
            "saturate",
            "v, but at least low and at most high",
            Parameter("low", "value", "least value", required=False),
            Parameter("high", "value", "greatest value", required=False),
        ),
        _signal(
            "quantise",
            "the multiple of step that is nearest to v",
            Parameter("step", "resolution", "distance of two values that can be told apart"),
        ),
        _signal(
            "stuck",
            "the value, or the last one that left before the start",
            Parameter("value", "value", "the value at which it stays; default: the last one", required=False),
            values=ANY,
            bundles="members",
        ),
        _signal(
            "delay",
            "the v of delay (and jitter) ago; one jitter for all elements",
            Parameter("delay", "delay", "how late it comes"),
            Parameter("jitter", "delay", "up to how much later, uniformly at random", required=False),
            Parameter("period", "time", "time between two jitters; default: each communication point", required=False),
            STREAM,
            values=ANY,
            bundles="members",
            draws="jitter",
        ),
        _signal(
            "slow",
            "a v taken anew every period, held between",
            Parameter("period", "time", "time between two values"),
            values=ANY,
            bundles="members",
        ),
        _signal("dropout", "valid is false; sequence number and values are held", values=ANY, bundles="only"),
        _signal(
            "noise",
            "v + sigma z, a new normal number z every period",
            Parameter("sigma", "spread", "standard deviation"),
            Parameter("period", "time", "time between two numbers"),
            STREAM,
            draws="sigma",
        ),
        _signal(
            "spike",
            "v + value for one step at the start, and again after each every",
            Parameter("value", "difference", "what is added"),
            Parameter("every", "time", "time from one to the next; default: there is one only", required=False),
        ),
        _signal(
            "garbage",
            "a number between low and high, a new one every period",
            Parameter("low", "value", "least number"),
            Parameter("high", "value", "greatest number"),
            Parameter("period", "time", "time between two numbers"),
            STREAM,
            draws="period",
        ),
        _signal(
            "nan",
            "no number, or an infinite one",
            Parameter("value", "not finite", '"nan", "inf" or "-inf"; default: "nan"', required=False),
            bundles="members",
        ),
        _signal(
            "swap",
            "the elements in another order",
            Parameter("order", "order", "for each element the place of the one that it gets: [2, 1, 3]"),
        ),
        FaultType(
            "input",
            (INPUT,),
            ANY,
            (Parameter("value", "setting", "the value that it gets; a Boolean input: true", required=False),),
            "the input has the value, afterwards its start value again",
        ),
        FaultType(
            "parameter",
            (PARAMETER,),
            ANY,
            (Parameter("value", "setting", "the value that it gets"),),
            "the parameter has the value, afterwards its start value again",
        ),
        FaultType(
            "lost_step",
            (COMPONENT,),
            (),
            (),
            "its steps are lost and its outputs held; afterwards one long step makes up for all of them",
        ),
    )
}  # fmt: skip


@dataclass(frozen=True)
class Timing:
    """An entry that says when a fault acts. With it goes one of what it ``needs`` and none of what it ``excludes``."""

    parameter: Parameter
    needs: tuple[str, ...] = ()
    excludes: tuple[str, ...] = ()


def _timing(name: str, sort: str, words: str, needs: str = "", excludes: str = "") -> Timing:
    return Timing(Parameter(name, sort, words, required=False), tuple(needs.split()), tuple(excludes.split()))


TIMING = (
    _timing("on", "time", "how long it acts at a time", needs="off"),
    _timing("off", "time", "how long it pauses in between", needs="on"),
    _timing("mttf", "time", "mean time to a failure at random, and from its end to the next"),
    _timing("mttr", "time", "mean time to its end; default: it stays", needs="mttf"),
    _timing("shape", "positive", "of a Weibull distribution; default 1: exponential", needs="mttf"),
    _timing("cause", "text", "faults of one cause fail at the same random times", needs="mttf"),
    _timing("when", "expression", "it begins once this has become true, and only once", excludes="during on mttf"),
    _timing("during", "expression", "it acts only while this is true: a phase of flight"),
    _timing("hold", "delay", "how long the condition must have been true before; default 0", needs="when during"),
)
