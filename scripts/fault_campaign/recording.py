"""A part of a recording in the EuRoC ASL layout with modifiable files: rows are text, images are links until replaced."""
import os
import shutil
import struct
import zlib
from pathlib import Path

CAMERAS = ("cam0", "cam1")


def png(width, height, pixels, bits=8):
    """A grey PNG file from rows of pixels."""
    row_bytes = width * bits // 8
    raw = b"".join(b"\0" + pixels[y * row_bytes:(y + 1) * row_bytes] for y in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, bits, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw, 1)) + chunk(b"IEND", b"")


def flat_png(width, height, grey, bits=8):
    return png(width, height, bytes([grey]) * (width * height * bits // 8), bits)


class Recording:
    def __init__(self, folder):
        self.root = Path(folder)
        self.mav = self.root / "mav0"

    # ---- rows, without header
    def lines(self, sensor):
        return (self.mav / sensor / "data.csv").read_text().splitlines()[1:]

    def edit_rows(self, sensor, edit):
        """Replaces the rows of a sensor by edit(list of rows) -> list of rows."""
        path = self.mav / sensor / "data.csv"
        header, *rows = path.read_text().splitlines()
        path.write_text("\n".join([header] + edit(rows)) + "\n")

    def edit_readings(self, from_ns, to_ns, edit):
        """Replaces IMU values for from_ns <= stamp < to_ns by edit(six numbers, index) -> six numbers or texts."""
        def all_rows(rows):
            out = []
            for index, row in enumerate(rows):
                stamp, *values = row.split(",")
                if from_ns <= int(stamp) < to_ns:
                    values = [v if isinstance(v, str) else f"{v:.10g}" for v in edit([float(v) for v in values], index)]
                out.append(",".join([stamp] + values))
            return out
        self.edit_rows("imu0", all_rows)

    # ---- images
    def frames(self, camera="cam0"):
        return len(self.lines(camera))

    def stamp_ns(self, index):
        return int(self.lines("cam0")[index].split(",")[0])

    def image(self, camera, index):
        return self.mav / camera / "data" / self.lines(camera)[index].split(",")[1].strip()

    def size_px(self):
        width, height = struct.unpack(">II", self.image("cam0", 0).read_bytes()[16:24])
        return width, height

    def replace(self, path, data):
        if path.is_symlink() or path.exists():
            path.unlink()
        path.write_bytes(data)


def cut(data, folder, seconds):
    """Copies the first `seconds` of images to a new folder, with inertial readings from 2 s before to 0.3 s after them."""
    shutil.rmtree(folder, ignore_errors=True)
    source = Path(data).resolve() / "mav0"
    recording = Recording(folder)
    first_ns = None
    for camera in CAMERAS:
        (recording.mav / camera / "data").mkdir(parents=True)
        shutil.copy(source / camera / "sensor.yaml", recording.mav / camera / "sensor.yaml")
        header, *rows = (source / camera / "data.csv").read_text().splitlines()
        first_ns = first_ns or int(rows[0].split(",")[0])
        rows = [row for row in rows if int(row.split(",")[0]) < first_ns + seconds * 1e9]
        for row in rows:
            name = row.split(",")[1].strip()
            os.symlink(source / camera / "data" / name, recording.mav / camera / "data" / name)
        (recording.mav / camera / "data.csv").write_text("\n".join([header] + rows) + "\n")
    (recording.mav / "imu0").mkdir()
    shutil.copy(source / "imu0/sensor.yaml", recording.mav / "imu0/sensor.yaml")
    header, *rows = (source / "imu0/data.csv").read_text().splitlines()
    rows = [row for row in rows if first_ns - 2e9 < int(row.split(",")[0]) < first_ns + (seconds + 0.3) * 1e9]
    (recording.mav / "imu0/data.csv").write_text("\n".join([header] + rows) + "\n")
    return recording
