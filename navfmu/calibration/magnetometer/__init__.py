"""Errors of a magnetometer triad from the field it measured while it was turned, thesis section 3.11."""
