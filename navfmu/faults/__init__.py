"""Failures as data: a file of faults beside the system, and what each fault does to a value on its way."""

from navfmu.faults.fault import Fault
from navfmu.faults.file import load_faults, parse_fault
from navfmu.faults.types import TYPES, FaultType

__all__ = ["TYPES", "Fault", "FaultType", "load_faults", "parse_fault"]
