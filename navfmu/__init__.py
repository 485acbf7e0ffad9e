"""navfmu: navigation components as FMUs, systems of them, and the master that runs them and injects failures."""

from typing import TYPE_CHECKING, Any

from navfmu.errors import NavfmuError

if TYPE_CHECKING:
    from navfmu.system.system import System

__all__ = ["NavfmuError", "System", "__version__"]
__version__ = "0.1.0"


def __getattr__(name: str) -> Any:
    """Import ``System`` on first use, so that ``import navfmu`` stays cheap."""
    if name == "System":
        from navfmu.system.system import System

        return System
    raise AttributeError(f"module 'navfmu' has no attribute '{name}'")
