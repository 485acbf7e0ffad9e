"""Campaigns: a system's variants, under faults, with many seeds, against requirements."""

from navfmu.campaign.definition import Campaign
from navfmu.campaign.executor import run_campaign
from navfmu.campaign.file import load_campaign
from navfmu.campaign.outcome import Outcome

__all__ = ["Campaign", "Outcome", "load_campaign", "run_campaign"]
