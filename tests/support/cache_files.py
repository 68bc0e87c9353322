# SPDX-License-Identifier: GPL-3.0-or-later
"""Segments of a cache, for tests that look at their files or damage an artefact in them."""

import pathlib

import h5py


def segments(cache):
    return sorted(pathlib.Path(cache).glob("??/*.h5")) + sorted(pathlib.Path(cache).glob("set/*.h5"))


def count_artefacts(cache):
    count = 0
    for path in segments(cache):
        with h5py.File(path) as file:
            count += sum(len(file[stage]) for stage in file)
    return count


def amount(cache, stage):
    """Artefacts of a stage, and the bytes of their arrays as they are stored."""
    sizes = []
    count = 0
    for path in segments(cache):
        with h5py.File(path) as file:
            for artefact in file[stage].values() if stage in file else ():
                count += 1
                artefact.visititems(lambda _, data: sizes.append(data.id.get_storage_size() if isinstance(data, h5py.Dataset) else 0))
    return count, sum(sizes)


def segment_with(cache, stage, item):
    for path in segments(cache):
        with h5py.File(path) as file:
            if f"{stage}/{item}" in file:
                return path
    raise LookupError(f"no segment has {stage} of {item}")


def damage(cache, stage, item):
    """Turns over a byte of the largest array of an artefact that is not packed; the file."""
    path = segment_with(cache, stage, item)
    with h5py.File(path) as file:
        values = max((data[()].tobytes() for data in file[f"{stage}/{item}"].values() if data.chunks is None), key=len)
    content = bytearray(path.read_bytes())
    at = content.find(values)
    assert content.count(values) == 1, "the array is not the only one with these values"
    content[at + len(values) // 2] ^= 1
    path.write_bytes(content)
    return path
