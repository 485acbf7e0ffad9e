"""A system of FMUs that can be run, the experiment that runs it, and the result."""
