"""Pushes whole streams to an Odometry in the order of their times."""

import heapq

import numpy as np


class _Readings:
    """Arrays of one sensor, of which push_until() pushes those that are not pushed yet."""

    def __init__(self, push, times, *arrays, **named):
        self._push, self._times, self._arrays, self._named, self._next = push, times, arrays, named, 0

    def push_until(self, time_ns):
        end = len(self._times) if time_ns is None else int(self._times.searchsorted(time_ns, side="right"))
        if end > self._next:
            part = slice(self._next, end)
            self._push(self._times[part], *(array[part] for array in self._arrays),
                       **{name: array[part] for name, array in self._named.items()})
            self._next = end


def _pings(odometry, dvl, dvl_beams):
    """The pings of a DVL; beams are put into tables with a row for each ping and a column for each beam."""
    if dvl_beams is None:
        return _Readings(odometry.push_dvl, *dvl)
    beam_times, beams, velocities, ranges = dvl_beams
    times, *rest = dvl if dvl is not None else (np.unique(beam_times),)
    pings = np.searchsorted(times, beam_times)
    if len(beam_times) and (pings.max() >= len(times) or (times[pings] != beam_times).any()):
        raise ValueError("dvl_beams: every time must be one of dvl")
    tables = np.full((2, len(times), max(beams, default=0) + 1), np.nan)
    tables[:, pings, beams] = velocities, ranges
    named = dict(zip(("velocity", "sigma", "is_water_track"), rest))
    return _Readings(odometry.push_dvl, times, beam_velocity=tables[0], beam_range=tables[1], **named)


def _labelled(camera, stream):
    for time_ns, image in stream:
        yield time_ns, camera, image


def _others(odometry, magnetometer, depth, sonar, altimeter, dvl, dvl_beams, currents):
    pairs = [(odometry.push_magnetometer, magnetometer), (odometry.push_depth, depth), (odometry.push_sonar, sonar),
             (odometry.push_altimeter, altimeter)]
    readings = [_Readings(push, *arrays) for push, arrays in pairs if arrays is not None]
    if dvl is not None or dvl_beams is not None:
        readings.append(_pings(odometry, dvl, dvl_beams))
    if currents is not None:
        times, channels = currents
        push = lambda part, **values: odometry.push_currents(part, values)
        readings.append(_Readings(push, times, **channels))
    return readings


def feed(odometry, *, imu, images, magnetometer=None, depth=None, sonar=None, altimeter=None, dvl=None, dvl_beams=None,
         currents=None):
    """Pushes whole streams in the order of their times, and returns the Estimates of odometry.finish().

    imu: (times_ns (N) int64, angular_velocity (N, 3) rad/s, specific_force (N, 3) m/s^2), as Recording.imu(corrected=False)
    gives it: a correction that the rig states is applied here.
    images: for each camera of the rig an iterable of (time_ns, image (height, width) uint8); images that are None are left out.
    magnetometer: (times_ns (N) int64, field (N, 3) T). depth: (times_ns (N) int64, depth (N) m). sonar: (times_ns (N) int64,
    range (N) m, angle (N) rad). altimeter: (times_ns (N) int64, range (N) m). dvl: (times_ns (N) int64, velocity (N, 3) m/s,
    sigma (N) m/s, is_water_track (N) bool). dvl_beams: (times_ns (M) int64, beam (M) int, velocity (M) m/s, range (M) m); with
    dvl, the times are among its times. currents: (times_ns (N) int64, dict of the channels' currents (N) A by their names).
    All are as Recording gives them; times are in order.
    """
    streams = [_Readings(odometry.push_imu, *imu)]
    streams += _others(odometry, magnetometer, depth, sonar, altimeter, dvl, dvl_beams, currents)
    labelled = [_labelled(camera, stream) for camera, stream in enumerate(images)]
    for time_ns, camera, image in heapq.merge(*labelled, key=lambda item: item[:2]):
        for stream in streams:
            stream.push_until(time_ns)
        if image is not None:
            odometry.push_image(camera, time_ns, image)
    for stream in streams:
        stream.push_until(None)
    return odometry.finish()
