"""System Structure and Parameterization (SSP 1.0): systems of FMUs as documents."""

from navfmu.ssp.writer import SystemSource

__all__ = ["SystemSource"]
