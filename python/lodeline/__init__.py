"""Lodeline: visual-inertial-magnetic odometry for places without GPS and light.

    import lodeline
    result = lodeline.run("dive1", "out")
    print(result.estimates.positions)      # (N, 3), m

Times are int64 nanoseconds. Lengths are in metres, angles in radians, fields in tesla. World W has z up; body B is the IMU.
Poses are (4, 4) matrices world_from_body. Errors are InputError, UsageError and EstimationError.
"""

from ._feed import feed
from ._lodeline import (
    Camera,
    CurrentSensor,
    Dvl,
    Error,
    Estimate,
    Estimates,
    EstimationError,
    Evaluation,
    Finding,
    FindingWarning,
    Images,
    Imu,
    InputError,
    Magnetometer,
    MagnetometerCalibration,
    Odometry,
    PressureSensor,
    Recording,
    Rig,
    Run,
    RunFolder,
    SensorNoise,
    Sonar,
    Trajectory,
    UsageError,
    __version__,
    allan,
    allan_of,
    calibrate_magnetometer,
    calibrate_magnetometer_readings,
    effects,
    evaluate,
    read_depth_profiles,
    read_readings,
    read_rig,
    read_run,
    read_trajectory,
    run,
    scenarios,
    simulate,
)

__all__ = [name for name in dir() if not name.startswith("_")]
