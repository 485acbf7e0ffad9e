"""Campaigns: a system's variants, under faults, with many seeds, against requirements."""

from navfmu.campaign.definition import Campaign
from navfmu.campaign.file import load_campaign
from navfmu.campaign.outcome import Outcome
from navfmu.campaign.run import run_campaign

__all__ = ["Campaign", "Outcome", "load_campaign", "run_campaign"]
