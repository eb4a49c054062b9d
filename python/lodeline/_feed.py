"""Pushes whole streams to an Odometry in the order of their times."""

import heapq


class _Readings:
    """Arrays of one sensor, of which push_until() pushes those that are not pushed yet."""

    def __init__(self, push, arrays):
        self._push, self._arrays, self._next = push, arrays, 0

    def push_until(self, time_ns):
        times = self._arrays[0]
        end = len(times) if time_ns is None else int(times.searchsorted(time_ns, side="right"))
        if end > self._next:
            self._push(*(array[self._next:end] for array in self._arrays))
            self._next = end


def _labelled(camera, stream):
    for time_ns, image in stream:
        yield time_ns, camera, image


def feed(odometry, *, imu, images, magnetometer=None, depth=None):
    """Pushes whole streams in the order of their times, and returns the Estimates of odometry.finish().

    imu: (times_ns (N) int64, angular_velocity (N, 3) rad/s, specific_force (N, 3) m/s^2), as Recording.imu() gives it.
    images: for each camera of the rig an iterable of (time_ns, image (height, width) uint8); images that are None are left out.
    magnetometer: (times_ns (N) int64, field (N, 3) T). depth: (times_ns (N) int64, depth (N) m). Times are in order.
    """
    streams = [_Readings(odometry.push_imu, imu)]
    if magnetometer is not None:
        streams.append(_Readings(odometry.push_magnetometer, magnetometer))
    if depth is not None:
        streams.append(_Readings(odometry.push_depth, depth))
    labelled = [_labelled(camera, stream) for camera, stream in enumerate(images)]
    for time_ns, camera, image in heapq.merge(*labelled, key=lambda item: item[:2]):
        for stream in streams:
            stream.push_until(time_ns)
        if image is not None:
            odometry.push_image(camera, time_ns, image)
    for stream in streams:
        stream.push_until(None)
    return odometry.finish()
