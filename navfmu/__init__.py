"""navfmu: navigation components as FMUs, systems of them, and the master that runs them and injects failures."""

TYPE_CHECKING = False  # as in typing, without its import: Ctrl-C is answered as soon as the command line begins
if TYPE_CHECKING:
    from navfmu.errors import NavfmuError, NavfmuWarning
    from navfmu.faults.fault import Fault
    from navfmu.system.experiment import Experiment
    from navfmu.system.system import System

__all__ = ["Experiment", "Fault", "NavfmuError", "NavfmuWarning", "System", "__version__"]
__version__ = "0.1.0"

_HOMES = {
    "Experiment": "navfmu.system.experiment",
    "Fault": "navfmu.faults.fault",
    "NavfmuError": "navfmu.errors",
    "NavfmuWarning": "navfmu.errors",
    "System": "navfmu.system.system",
}


def __getattr__(name: str):
    """Import what is asked for on first use, so that ``import navfmu`` stays cheap."""
    if name not in _HOMES:
        raise AttributeError(f"module 'navfmu' has no attribute '{name}'")
    import importlib

    return getattr(importlib.import_module(_HOMES[name]), name)
