"""Faults of inertial readings: impossible values, wrong units, saturation, gaps."""
from catalogue import fault, middle

END_NS = 2**63
UNITS = [(57.29578, 1.0), (1.0, 0.101972), (57.29578, 0.101972), (1.0, 101.97)]


def scaled(values, gyroscope, accelerometer):
    return [v * gyroscope for v in values[:3]] + [v * accelerometer for v in values[3:]]


@fault()
def readings_no_numbers(recording, rng):
    words = ["nan", "inf", "-inf", "NaN"]

    def spoil(values, _):
        if rng.random() > 0.1:
            return values
        return [rng.choice(words) if rng.random() < 0.3 else v for v in values]
    recording.edit_readings(0, END_NS, spoil)
    return {}


@fault()
def readings_huge(recording, rng):
    size = rng.choice([1e3, 1e6, 1e30, 1e300])

    def spoil(values, _):
        if rng.random() > 0.01:
            return values
        return [size * rng.choice([-1, 1]) if rng.random() < 0.5 else v for v in values]
    recording.edit_readings(0, END_NS, spoil)
    return {"what": f"{size:g}"}


@fault()
def reading_spikes(recording, rng):
    def spoil(values, _):
        if rng.random() > 0.02:
            return values
        return [v + rng.choice([-1, 1]) * rng.choice([5.0, 50.0]) if rng.random() < 0.3 else v for v in values]
    recording.edit_readings(0, END_NS, spoil)
    return {}


@fault()
def readings_missing(recording, rng):
    index, gap_s = middle(recording, rng), rng.choice([0.05, 0.2, 0.5, 1.0, 2.0])
    from_ns = recording.stamp_ns(index)
    recording.edit_rows("imu0", lambda rows: [
        row for row in rows if not from_ns <= int(row.split(",")[0]) < from_ns + gap_s * 1e9])
    return {"until": index, "what": f"{gap_s} s"}


@fault()
def readings_end_early(recording, rng):
    index = middle(recording, rng)
    end_ns = recording.stamp_ns(index)
    recording.edit_rows("imu0", lambda rows: [row for row in rows if int(row.split(",")[0]) < end_ns])
    return {"until": index - 1}


@fault()
def readings_stuck(recording, rng):
    index, seconds = middle(recording, rng), rng.choice([0.3, 1.0, 10.0])
    from_ns, held = recording.stamp_ns(index), []

    def hold(values, _):
        held[:] = held or values
        return list(held)
    recording.edit_readings(from_ns, from_ns + int(seconds * 1e9), hold)
    return {"until": index, "what": f"{seconds} s"}


@fault()
def readings_held(recording, rng):
    """Repeats each reading several times, as for a sensor slower than its driver."""
    times, held = rng.choice([2, 4, 8]), []

    def hold(values, index):
        held[:] = values if index % times == 0 or not held else held
        return list(held)
    recording.edit_readings(0, END_NS, hold)
    return {"until": 0, "what": f"{times} times"}


@fault()
def readings_saturated(recording, rng):
    gyroscope, accelerometer = rng.choice([(0.3, 1e9), (1e9, 9.0), (0.2, 8.0)])
    recording.edit_readings(0, END_NS, lambda v, _: [max(-gyroscope, min(gyroscope, x)) for x in v[:3]]
                            + [max(-accelerometer, min(accelerometer, x)) for x in v[3:]])
    return {"what": f"{gyroscope} rad/s {accelerometer} m/s2"}


@fault()
def units_change(recording, rng):
    index, units = middle(recording, rng), rng.choice(UNITS)
    recording.edit_readings(recording.stamp_ns(index), END_NS, lambda v, _: scaled(v, *units))
    return {"until": index, "what": f"x{units[0]} x{units[1]}"}


@fault()
def units_wrong(recording, rng):
    units = rng.choice(UNITS)
    recording.edit_readings(0, END_NS, lambda v, _: scaled(v, *units))
    return {"until": 0, "what": f"x{units[0]} x{units[1]}"}


@fault()
def axis_changes_sign(recording, rng):
    index, axis = middle(recording, rng), rng.randrange(6)
    recording.edit_readings(recording.stamp_ns(index), END_NS,
                            lambda v, _: [-x if i == axis else x for i, x in enumerate(v)])
    return {"until": index, "what": f"axis {axis}"}


@fault()
def bias_steps(recording, rng):
    index = middle(recording, rng)
    step = [rng.uniform(-0.2, 0.2) for _ in range(3)] + [rng.uniform(-1.0, 1.0) for _ in range(3)]
    recording.edit_readings(recording.stamp_ns(index), END_NS, lambda v, _: [x + s for x, s in zip(v, step)])
    return {"until": index}


@fault()
def sensor_silent(recording, rng):
    """Sets all readings of the gyroscope, the accelerometer or both to zero."""
    factors = rng.choice([(0.0, 1.0), (1.0, 0.0), (0.0, 0.0)])
    recording.edit_readings(0, END_NS, lambda v, _: scaled(v, *factors))
    return {"until": 0, "what": f"x{factors[0]:g} x{factors[1]:g}"}


@fault()
def noise_density_wrong(recording, rng):
    factor = rng.choice([1e-6, 1e-3, 0.1])
    path = recording.mav / "imu0/sensor.yaml"
    lines = []
    for line in path.read_text().splitlines():
        if "noise_density" in line or "random_walk" in line:
            key, rest = line.split(":", 1)
            line = f"{key}: {float(rest.split('#')[0]) * factor:.6g}"
        lines.append(line)
    path.write_text("\n".join(lines) + "\n")
    return {"until": 0, "what": f"x{factor:g}"}
