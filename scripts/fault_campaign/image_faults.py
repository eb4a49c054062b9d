"""Faults of images and of their lists."""
import os

from catalogue import fault, middle
from recording import CAMERAS, flat_png, png


def some_cameras(rng):
    return rng.choice([["cam0"], ["cam1"], list(CAMERAS)])


def spoil_some(recording, rng, share, spoil):
    """Replaces a random share of the images of some cameras by spoil(bytes) -> bytes."""
    for camera in some_cameras(rng):
        for index in range(recording.frames(camera)):
            if rng.random() < share:
                path = recording.image(camera, index)
                recording.replace(path, spoil(path.read_bytes()))
    return {}


def replace_from(recording, first, make):
    """Replaces every image of both cameras from index `first` on by make() -> bytes."""
    for camera in CAMERAS:
        for index in range(first, recording.frames(camera)):
            recording.replace(recording.image(camera, index), make())
    return {"until": first}


@fault()
def images_missing_from_lists(recording, rng):
    for camera in CAMERAS:
        recording.edit_rows(camera, lambda rows: [row for row in rows if rng.random() > 0.3])
    return {}


@fault()
def image_files_missing(recording, rng):
    for camera in some_cameras(rng):
        for index in range(recording.frames(camera)):
            if rng.random() < 0.3:
                recording.image(camera, index).unlink()
    return {}


@fault()
def image_rows_twice(recording, rng):
    for camera in some_cameras(rng):
        recording.edit_rows(camera, lambda rows: [row for row in rows for _ in range(1 + (rng.random() < 0.3))])
    return {}


@fault()
def image_rows_in_disorder(recording, rng):
    def shuffle(rows):
        for _ in range(5):
            i = rng.randrange(len(rows) - 4)
            rows[i:i + 4] = rng.sample(rows[i:i + 4], 4)
        return rows
    for camera in some_cameras(rng):
        recording.edit_rows(camera, shuffle)
    return {}


@fault()
def image_rows_reversed(recording, rng):
    for camera in CAMERAS:
        recording.edit_rows(camera, lambda rows: rows[::-1])
    return {}


@fault()
def image_bytes_flipped(recording, rng):
    def flip(data):
        data = bytearray(data)
        for _ in range(rng.randrange(1, 40)):
            data[rng.randrange(8, len(data))] = rng.randrange(256)
        return bytes(data)
    return spoil_some(recording, rng, 0.3, flip)


@fault()
def images_cut_off(recording, rng):
    return spoil_some(recording, rng, 0.3, lambda data: data[:rng.randrange(len(data))])


@fault()
def image_size_changes(recording, rng):
    first = middle(recording, rng)
    width, height = rng.choice([(640, 470), (376, 240), (1, 1), (4000, 3000)])
    for camera in some_cameras(rng):
        for index in range(first, recording.frames(camera)):
            recording.replace(recording.image(camera, index), flat_png(width, height, 90))
    return {"until": first}


@fault()
def image_size_changes_once(recording, rng):
    index = middle(recording, rng)
    recording.replace(recording.image(rng.choice(CAMERAS), index), flat_png(376, 240, 90))
    return {"until": index}


@fault()
def images_flat_from(recording, rng):
    data = flat_png(*recording.size_px(), rng.choice([0, 128, 255]))
    return replace_from(recording, middle(recording, rng), lambda: data)


@fault()
def images_noise_from(recording, rng):
    width, height = recording.size_px()
    return replace_from(recording, middle(recording, rng), lambda: png(width, height, rng.randbytes(width * height)))


@fault()
def images_frozen_from(recording, rng):
    first = middle(recording, rng)
    for camera in CAMERAS:
        data = recording.image(camera, first).read_bytes()
        for index in range(first, recording.frames(camera)):
            recording.replace(recording.image(camera, index), data)
    return {"until": first}


@fault()
def every_image_twice(recording, rng):
    """Repeats each image with a new stamp, halfway to the next image."""
    def repeat(rows):
        stamps = [int(row.split(",")[0]) for row in rows]
        out = []
        for i, row in enumerate(rows):
            out.append(row)
            if i + 1 < len(rows):
                out.append(f"{(stamps[i] + stamps[i + 1]) // 2},{row.split(',')[1]}")
        return out
    for camera in CAMERAS:
        recording.edit_rows(camera, repeat)
    return {}


@fault()
def cameras_exchanged_from(recording, rng):
    first = middle(recording, rng) if rng.random() < 0.5 else 0
    for index in range(first, min(recording.frames("cam0"), recording.frames("cam1"))):
        left, right = recording.image("cam0", index), recording.image("cam1", index)
        if left.name != right.name or not left.exists() or not right.exists():
            continue
        left_data, right_data = left.read_bytes(), right.read_bytes()
        recording.replace(left, right_data)
        recording.replace(right, left_data)
    return {"until": first}


@fault()
def right_images_late(recording, rng):
    late = rng.randrange(1, 6)

    def delay(rows):
        return [a.split(",")[0] + "," + b.split(",")[1] for a, b in zip(rows[late:], rows)]
    recording.edit_rows("cam1", delay)
    return {"what": f"{late} images"}


@fault()
def image_of_another_moment(recording, rng):
    index = middle(recording, rng)
    other = min(recording.frames() - 1, index + rng.randrange(5, 30))
    recording.replace(recording.image("cam0", index), recording.image("cam0", other).read_bytes())
    return {"until": index}


@fault()
def folder_in_place_of_image(recording, rng):
    path = recording.image("cam0", middle(recording, rng))
    path.unlink()
    path.mkdir()
    return {}


@fault()
def link_to_itself(recording, rng):
    path = recording.image("cam0", middle(recording, rng))
    path.unlink()
    os.symlink(path.name, path)
    return {}
