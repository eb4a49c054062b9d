"""Faults of stamps: clock jumps, wrong units, wrong order, and files whose content differs from their names."""
from catalogue import fault, middle

ALL = ("cam0", "cam1", "imu0")


def map_stamps(recording, sensors, change):
    """Replaces the stamps of the sensors by change(stamp in ns) -> stamp in ns."""
    for sensor in sensors:
        recording.edit_rows(sensor, lambda rows: [
            ",".join([str(change(int(row.split(",")[0])))] + row.split(",")[1:]) for row in rows])


def jump(recording, sensors, index, offset_s):
    from_ns = recording.stamp_ns(index)
    map_stamps(recording, sensors, lambda t: t + int(offset_s * 1e9) if t >= from_ns else t)


def some_jump(rng, sizes):
    return rng.choice([-1, 1]) * rng.choice(sizes)


@fault()
def image_clock_jumps(recording, rng):
    index, offset_s = middle(recording, rng), some_jump(rng, [0.02, 0.1, 0.5, 3.0, 3600.0, 3e8])
    last_ns = recording.stamp_ns(index - 1)
    jump(recording, ("cam0", "cam1"), index, offset_s)
    return {"until": index, "what": f"{offset_s} s", "jump": (last_ns, offset_s)}


@fault()
def imu_clock_jumps(recording, rng):
    index, offset_s = middle(recording, rng), some_jump(rng, [0.02, 0.1, 0.5, 3.0, 3600.0, 3e8])
    jump(recording, ("imu0",), index, offset_s)
    return {"until": index - 5, "what": f"{offset_s} s"}


@fault()
def all_clocks_jump(recording, rng):
    index, offset_s = middle(recording, rng), some_jump(rng, [0.1, 0.5, 3.0, 3600.0, 3e8, 7.9e9])
    last_ns = recording.stamp_ns(index - 1)
    jump(recording, ALL, index, offset_s)
    return {"until": index - 1, "what": f"{offset_s} s", "jump": (last_ns, offset_s)}


@fault()
def images_late(recording, rng):
    offset_s = some_jump(rng, [0.015, 0.05, 0.2, 1.0])
    map_stamps(recording, ("imu0",), lambda t: t + int(offset_s * 1e9))
    return {"until": 0, "what": f"{offset_s} s"}


@fault()
def one_stamp_extreme(recording, rng):
    value = rng.choice([0, -1, 1, 2**63 - 1, -2**63, 2**63, 10**30, 2**62])
    sensor, index = rng.choice(ALL), middle(recording, rng)

    def change(rows):
        return rows[:index] + [",".join([str(value)] + rows[index].split(",")[1:])] + rows[index + 1:]
    recording.edit_rows(sensor, change)
    return {"until": 0 if sensor == "imu0" else index, "what": f"{sensor} {value}"}


@fault(does_harm=False)
def clock_begins_elsewhere(recording, rng):
    begin_ns = rng.choice([-2**63 + 10**9, 2**63 - 10**11, -10**10, 0])
    offset_ns = begin_ns - (recording.stamp_ns(0) - int(3e9))
    map_stamps(recording, ALL, lambda t: t + offset_ns)
    return {"what": str(begin_ns), "offset_ns": offset_ns}


@fault()
def stamps_in_another_unit(recording, rng):
    unit_ns = rng.choice([1000, 1000000])
    map_stamps(recording, ALL, lambda t: t // unit_ns)
    return {"what": f"1 = {unit_ns} ns", "unit_ns": unit_ns}


@fault()
def imu_stamps_in_bursts(recording, rng):
    """Groups the readings in bursts of ten, stamped on arrival, 0.1 ms apart."""
    def burst(rows):
        stamps = [int(row.split(",")[0]) for row in rows]
        return [",".join([str(stamps[min(i - i % 10 + 9, len(rows) - 1)] - (9 - i % 10) * 100000)] + row.split(",")[1:])
                for i, row in enumerate(rows)]
    recording.edit_rows("imu0", burst)
    return {"until": 0}


@fault()
def imu_stamps_coarse(recording, rng):
    map_stamps(recording, ("imu0",), lambda t: t - t % 10_000_000)
    return {"until": 0}


@fault()
def imu_rows_twice(recording, rng):
    recording.edit_rows("imu0", lambda rows: [row for row in rows for _ in range(1 + (rng.random() < 0.3))])
    return {}


@fault()
def imu_rows_in_disorder(recording, rng):
    def shuffle(rows):
        for _ in range(20):
            i = rng.randrange(len(rows) - 8)
            rows[i:i + 8] = rng.sample(rows[i:i + 8], 8)
        return rows
    recording.edit_rows("imu0", shuffle)
    return {}


@fault()
def list_cut_off(recording, rng):
    path = recording.mav / rng.choice(ALL) / "data.csv"
    data = path.read_bytes()
    path.write_bytes(data[:rng.randrange(len(data))])
    return {"what": path.parent.name}


@fault(is_calibration=True)
def list_bytes_flipped(recording, rng):
    path = recording.mav / rng.choice(ALL) / "data.csv"
    data = bytearray(path.read_bytes())
    for _ in range(rng.randrange(1, 200)):
        data[rng.randrange(len(data))] = rng.randrange(256)
    path.write_bytes(bytes(data))
    return {"what": path.parent.name}


@fault()
def file_missing(recording, rng):
    path = recording.mav / rng.choice(ALL) / rng.choice(["data.csv", "sensor.yaml"])
    path.unlink()
    return {"fatal": True, "what": f"{path.parent.name}/{path.name}"}


@fault()
def list_is_folder(recording, rng):
    path = recording.mav / rng.choice(ALL) / rng.choice(["data.csv", "sensor.yaml"])
    path.unlink()
    path.mkdir()
    return {"fatal": True, "what": f"{path.parent.name}/{path.name}"}
