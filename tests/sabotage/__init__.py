"""Systems with faults built in."""
