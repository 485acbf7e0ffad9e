"""The pytest plugin: systems of FMUs in tests. Nothing that takes time is imported until a test asks for a system."""
