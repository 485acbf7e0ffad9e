"""Exact derivatives of functions in plain NumPy: ``jacobian(f, x)``.

An extended Kalman filter that uses it writes no matrix by hand::

    predicted, H = value_and_jacobian(ranges, x, stations)

The derivatives are computed along with the values (forward mode), by the rules of calculus, operation by operation.
They are plain NumPy, too: with floats they are numbers, and while a component is traced they become C, with the same
operations in the same order.
"""

from navfmu.derivatives.jacobian import jacobian, value_and_jacobian

__all__ = ["jacobian", "value_and_jacobian"]
