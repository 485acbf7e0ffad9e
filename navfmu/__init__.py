"""navfmu: navigation components as FMUs, systems of them, and the master that runs them and injects failures."""
