"""Writes and reads bags with the rosbag of ROS itself, for the tests.

    test_bag.py write MAV0 BAG COMPRESSION IMAGES   readings and images of a recording in the EuRoC layout; its
                                                    images as PGM beside the PNG files, for IMAGES = raw
    test_bag.py unclosed MAV0 BAG COMPRESSION       the same (compressed images), as if the recorder had crashed
    test_bag.py kinds BAG                           a message of every kind that a rig may publish
    test_bag.py halves BAG                          an IMU's gyroscope and accelerometer on topics of their own
    test_bag.py damaged BAG                         three images and readings, the headers of the second ones damaged
    test_bag.py rename BAG OTHER OLD=NEW[:odometry] a copy with other names of topics, and poses as nav_msgs/Odometry
    test_bag.py list BAG                            topics, types, numbers of messages, sums over their bytes
"""
import csv
import hashlib
import os
import shutil
import sys

import genpy
import rosbag
from sensor_msgs.msg import (CompressedImage, FluidPressure, Image, Imu, LaserScan, MagneticField, Range)


def rows(mav0, sensor):
    path = os.path.join(mav0, sensor, "data.csv")
    if not os.path.exists(path):
        return
    with open(path) as stream:
        for row in csv.reader(stream):
            if not row[0].startswith("#"):
                yield row


def stamp(ns):
    return genpy.Time(int(ns) // 10**9, int(ns) % 10**9)


def imu(row):
    message = Imu()
    w, f = message.angular_velocity, message.linear_acceleration
    w.x, w.y, w.z, f.x, f.y, f.z = map(float, row[1:7])
    return message


def field(row):
    message = MagneticField()
    m = message.magnetic_field
    m.x, m.y, m.z = map(float, row[1:4])
    return message


def raw_image(path):
    with open(path[:-4] + ".pgm", "rb") as stream:
        magic, size, depth, pixels = stream.read().split(b"\n", 3)
    assert magic == b"P5" and depth == b"255"
    width, height = map(int, size.split())
    return Image(height=height, width=width, encoding="mono8", step=width, data=pixels)


def file_image(path):
    with open(path, "rb") as stream:
        return CompressedImage(format="png", data=stream.read())


def messages(mav0, images):
    for row in rows(mav0, "imu0"):
        yield int(row[0]), "/imu/data", imu(row)
    for row in rows(mav0, "mag0"):
        yield int(row[0]), "/imu/mag", field(row)
    for name, camera in (("left", "cam0"), ("right", "cam1")):
        for row in rows(mav0, camera):
            path = os.path.join(mav0, camera, "data", row[1])
            if images == "raw":
                yield int(row[0]), "/%s/image_raw" % name, raw_image(path)
            else:
                yield int(row[0]), "/%s/image_raw/compressed" % name, file_image(path)


def fill(bag, mav0, images):
    for ns, topic, message in sorted(messages(mav0, images), key=lambda entry: entry[0]):
        message.header.stamp = stamp(ns)
        # Reception time a little after the measurement, as on a real rig.
        bag.write(topic, message, stamp(ns + 2_000_000))


def write(mav0, path, compression, images):
    with rosbag.Bag(path, "w", compression=compression, chunk_threshold=100_000) as bag:
        fill(bag, mav0, images)


def unclosed(mav0, path, compression):
    bag = rosbag.Bag(path + ".tmp", "w", compression=compression, chunk_threshold=100_000)
    fill(bag, mav0, "compressed")
    bag.flush()
    shutil.copy(path + ".tmp", path)
    bag.close()
    os.remove(path + ".tmp")


def kinds(path):
    with rosbag.Bag(path, "w") as bag:
        def put(topic, message, ns):
            message.header.stamp = stamp(ns)
            bag.write(topic, message, stamp(ns))

        second = 10**9
        put("/imu", imu(["", 1, 2, 3, 4, 5, 6]), second)
        put("/imu", imu(["", "nan", 2, 3, 4, 5, 6]), 2 * second)
        put("/mag", field(["", 2e-5, -1e-5, 4e-5]), second)
        put("/depth", FluidPressure(fluid_pressure=101325 + 1025 * 9.80665 * 7.25), second)
        put("/altimeter", Range(min_range=0.1, max_range=50, range=3.1), second)
        put("/altimeter", Range(min_range=0.1, max_range=50, range=60), 2 * second)
        put("/sonar", LaserScan(angle_min=0.5, angle_increment=0.25, time_increment=0.125, range_min=0.1,
                                range_max=20, ranges=[1.5, float("inf"), 2.5]), second)
        # Two rows of three pixels: blue, green, red of distinct size, 16 bits, mosaics of one colour.
        colour = bytes([10, 100, 200] * 6)
        grey16 = b"".join(v.to_bytes(2, "little") for v in (0, 255, 256, 0x1234, 0xfffe, 0xffff))
        big16 = b"".join(v.to_bytes(2, "big") for v in (0, 255, 256, 0x1234, 0xfffe, 0xffff))
        put("/i/bgr8", Image(height=2, width=3, encoding="bgr8", step=9, data=colour), second)
        put("/i/rgb8", Image(height=2, width=3, encoding="rgb8", step=9, data=colour), second)
        put("/i/mono16", Image(height=2, width=3, encoding="mono16", step=6, data=grey16), second)
        put("/i/mono16_big", Image(height=2, width=3, encoding="mono16", step=6, is_bigendian=1, data=big16), second)
        put("/i/padded", Image(height=2, width=3, encoding="mono8", step=4, data=bytes(range(8))), second)
        # Red 200, green 100, blue 50.
        mosaic = bytes(([200, 100] * 4 + [100, 50] * 4) * 4)
        put("/i/bayer_rggb8", Image(height=8, width=8, encoding="bayer_rggb8", step=8, data=mosaic), second)
        mosaic = bytes(([50, 100] * 4 + [100, 200] * 4) * 4)
        put("/i/bayer_bggr8", Image(height=8, width=8, encoding="bayer_bggr8", step=8, data=mosaic), second)
        mosaic = bytes(([100, 200] * 4 + [50, 100] * 4) * 4)
        put("/i/bayer_grbg8", Image(height=8, width=8, encoding="bayer_grbg8", step=8, data=mosaic), second)
        mosaic = bytes(([100, 50] * 4 + [200, 100] * 4) * 4)
        put("/i/bayer_gbrg8", Image(height=8, width=8, encoding="bayer_gbrg8", step=8, data=mosaic), second)
        put("/i/short", Image(height=2, width=3, encoding="mono8", step=3, data=bytes(5)), second)
        put("/i/strange", Image(height=2, width=3, encoding="hsv", step=9, data=colour), second)


def halves(path):
    with rosbag.Bag(path, "w") as bag:
        for i in range(100):
            ns = 10**9 + i * 5_000_000
            gyro = imu(["", 0.5, 0, 0, 0, 0, 0])
            gyro.header.stamp = stamp(ns)
            bag.write("/camera/gyro/sample", gyro, stamp(ns))
            if i % 2 == 0:
                accel = imu(["", 0, 0, 0, 0, 0, 9.8])
                accel.header.stamp = stamp(ns + 1_700_000)
                bag.write("/camera/accel/sample", accel, stamp(ns + 1_700_000))


def damaged(path):
    name = b"name_of_frame"
    with rosbag.Bag(path, "w") as bag:
        for i in range(3):
            time = stamp(10**9 * (i + 1))
            grey = Image(height=2, width=3, encoding="mono8", step=3, data=bytes(6))
            reading = imu(["", 1, 2, 3, 4, 5, 6])
            for topic, message in (("/i/grey", grey), ("/imu", reading)):
                message.header.stamp = time
                message.header.frame_id = name.decode() if i == 1 else "f"
                bag.write(topic, message, time)
            for topic, message in (("/mag", field(["", 2e-5, -1e-5, 4e-5])), ("/depth", FluidPressure()),
                                   ("/sonar", LaserScan())):
                message.header.stamp = time
                bag.write(topic, message, time)
    with open(path, "rb") as stream:
        content = stream.read()
    length = len(name).to_bytes(4, "little")
    with open(path, "wb") as stream:
        stream.write(content.replace(length + name, (2 << 30).to_bytes(4, "little") + name))


def list_topics(path):
    with rosbag.Bag(path) as bag:
        sums = {}
        for topic, message, _ in bag.read_messages(raw=True):
            kind, data = message[0], message[1]
            count, digest = sums.setdefault((topic, kind), [0, hashlib.md5()])
            digest.update(data)
            sums[(topic, kind)][0] = count + 1
        for (topic, kind), (count, digest) in sorted(sums.items()):
            print(topic, kind, count, digest.hexdigest())


def rename(source, path, *names):
    """Copies a bag with other names of topics, OLD=NEW. With OLD=NEW:odometry, poses become nav_msgs/Odometry."""
    from nav_msgs.msg import Odometry
    new = dict(name.split("=") for name in names)
    with rosbag.Bag(source) as bag, rosbag.Bag(path, "w") as out:
        for topic, message, time in bag.read_messages():
            name, _, kind = new.get(topic, topic).partition(":")
            if kind == "odometry":
                odometry = Odometry()
                odometry.header = message.header
                odometry.child_frame_id = "body"
                odometry.pose.pose = message.pose
                message = odometry
            out.write(name, message, time)


if __name__ == "__main__":
    {"write": write, "unclosed": unclosed, "damaged": damaged, "halves": halves, "kinds": kinds, "list": list_topics, "rename": rename}[sys.argv[1]](*sys.argv[2:])
