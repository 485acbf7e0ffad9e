"""Campaigns: a system's variants, under faults, with many seeds, against requirements."""

TYPE_CHECKING = False  # as in typing, without its import
if TYPE_CHECKING:
    from navfmu.campaign.definition import Campaign
    from navfmu.campaign.executor import run_campaign
    from navfmu.campaign.file import load_campaign
    from navfmu.campaign.outcome import Outcome

__all__ = ["Campaign", "Outcome", "load_campaign", "run_campaign"]

_HOMES = {
    "Campaign": "navfmu.campaign.definition",
    "Outcome": "navfmu.campaign.outcome",
    "load_campaign": "navfmu.campaign.file",
    "run_campaign": "navfmu.campaign.executor",
}


def __getattr__(name: str):
    """Import what is asked for on first use: the seeds of a test's mark need nothing else of it."""
    if name not in _HOMES:
        raise AttributeError(f"module 'navfmu.campaign' has no attribute '{name}'")
    import importlib

    return getattr(importlib.import_module(_HOMES[name]), name)
