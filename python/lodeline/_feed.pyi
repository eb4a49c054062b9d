from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ._lodeline import Estimates, Odometry

_Times = NDArray[np.int64]
_Floats = NDArray[np.float64]

def feed(
    odometry: Odometry,
    *,
    imu: tuple[_Times, _Floats, _Floats],
    images: Sequence[Iterable[tuple[int, NDArray[np.uint8] | None]]],
    magnetometer: tuple[_Times, _Floats] | None = None,
    depth: tuple[_Times, _Floats] | None = None,
    sonar: tuple[_Times, _Floats, _Floats] | None = None,
    altimeter: tuple[_Times, _Floats] | None = None,
    dvl: tuple[_Times, _Floats, _Floats, NDArray[np.bool_]] | None = None,
    dvl_beams: tuple[_Times, NDArray[np.int32], _Floats, _Floats] | None = None,
    currents: tuple[_Times, Mapping[str, _Floats]] | None = None,
) -> Estimates: ...
