"""Speed, as ratios measured in one run: one script for each claim, each also a command.

    python -m benchmarks.ring       six first-order lags in a ring: master against master, the FMUs cost nothing
    python -m benchmarks.flight     the backup navigator's flight, ten FMUs at 100 Hz
    python -m benchmarks.faults     the same flight with twenty faults against none
    python -m benchmarks.imu_twin   the native IMU against its PythonFMU twin
    python -m benchmarks.sensors    a sample of each sensor, in a loop in C
    python -m benchmarks.startup    navfmu run --help against bare Python
    python -m benchmarks.exporter   filters of up to 42 states out of the exporter, against loops written by hand in C
    python -m benchmarks.kernels    a scalar measurement by each form of the covariance: operations and time
    python -m benchmarks            all of them, a table and benchmarks.json

All but the last need the FMUs of build_fmus.py. Contenders take turns, round after round, so that a disturbance of the
machine hits all of them; a result is the median over the rounds.
"""

NAMES = ("ring", "flight", "faults", "imu_twin", "sensors", "startup", "exporter", "kernels")
