"""Components that call a program which is reached from Python only: FMUs as PythonFMU, not as C."""
