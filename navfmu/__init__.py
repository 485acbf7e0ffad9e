"""navfmu: navigation components as FMUs, systems of them, and the master that runs them and injects failures."""

from typing import TYPE_CHECKING, Any

from navfmu.errors import NavfmuError, NavfmuWarning

if TYPE_CHECKING:
    from navfmu.system.experiment import Experiment
    from navfmu.system.system import System

__all__ = ["Experiment", "NavfmuError", "NavfmuWarning", "System", "__version__"]
__version__ = "0.1.0"


def __getattr__(name: str) -> Any:
    """Import what is heavy on first use, so that ``import navfmu`` stays cheap."""
    if name == "System":
        from navfmu.system.system import System

        return System
    if name == "Experiment":
        from navfmu.system.experiment import Experiment

        return Experiment
    raise AttributeError(f"module 'navfmu' has no attribute '{name}'")
