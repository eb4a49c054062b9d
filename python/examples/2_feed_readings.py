"""Pushes readings to the odometry as drivers would, and takes estimates meanwhile: 2_feed_readings.py DATA [SECONDS]"""

import sys

import lodeline
import numpy as np


def main(data, seconds="1e9"):
    recording = lodeline.Recording(data)
    imu_times, rates, forces = recording.imu()
    magnetometer_times, fields = recording.magnetometer()
    cameras = [recording.images(camera) for camera in range(len(recording.rig.cameras))]

    odometry = lodeline.Odometry(recording.rig)
    pushed_imu = pushed_magnetometer = 0
    first = None
    for images in zip(*cameras):
        time_ns = images[0][0]
        first = time_ns if first is None else first
        if (time_ns - first) * 1e-9 > float(seconds):
            break
        # Readings up to the time of the images, then the images.
        end = np.searchsorted(imu_times, time_ns, side="right")
        odometry.push_imu(imu_times[pushed_imu:end], rates[pushed_imu:end], forces[pushed_imu:end])
        pushed_imu = end
        end = np.searchsorted(magnetometer_times, time_ns, side="right")
        odometry.push_magnetometer(magnetometer_times[pushed_magnetometer:end], fields[pushed_magnetometer:end])
        pushed_magnetometer = end
        for camera, (camera_time_ns, image) in enumerate(images):
            if image is not None:
                odometry.push_image(camera, camera_time_ns, image)
        for estimate in odometry.take():
            if estimate.has_pose:
                print(f"{estimate.time_ns} ns: {estimate.position} m")

    estimates = odometry.finish()
    print(f"{len(estimates)} poses")


if __name__ == "__main__":
    main(*sys.argv[1:])
