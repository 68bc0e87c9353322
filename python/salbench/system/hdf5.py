# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads HDF5 files of other programs. The declared size of a data set is compared with its storage before
memory is allocated; links are not followed.

Damaged bytes can still crash the library, so these functions belong in a separate process (workers.py).
"""

import contextlib
import os
from collections.abc import Iterator
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from salbench.system.errors import InputError, UnreadableError
from salbench.system.files import MAX_ITEM_BYTES, read_file
from salbench.system.npy import doubles_of

_MAX_INFLATION = 1032  # maximum expansion of deflate
_MAX_RANK = 8
_SIGNATURE = b"\x89HDF\r\n\x1a\n"


class Hdf5File:
    """Numeric data sets in the bytes of a file, by their paths from the root group."""

    def __init__(self, path: str, data: bytes | None = None) -> None:
        self.path = path
        data = read_file(path) if data is None else data
        self._bytes = len(data)
        if _SIGNATURE not in data:
            raise InputError(f"{path}: not an HDF5 file")
        with self._or("not a readable HDF5 file"):
            self._file = h5py.File(h5py.h5f.open_file_image(data))

    def fail(self, name: str, what: str) -> InputError:
        return InputError(f'{self.path}: data set "{name}": {what}')

    @contextlib.contextmanager
    def _or(self, what: str, step: str = "") -> Iterator[None]:
        """Converts any exception of the library for damaged bytes to an InputError."""
        try:
            yield
        except InputError:
            raise
        except MemoryError:
            raise UnreadableError(
                f"{self.path}: {what.partition(':')[0]}: no memory for its values; leave it out, or work on"
                " fewer items at a time"
            ) from None
        except Exception as error:
            raise InputError(
                f"{self.path}: {what} ({step}{' '.join(str(error).split()) or type(error).__name__})"
            ) from None

    def attribute(self, name: str) -> Any:
        """Returns a text or a number; None if missing. Attributes of other types are an error."""
        with self._or(f"attribute '{name}' cannot be read"):
            if name not in self._file.attrs:
                return None
            claimed = self._file.attrs.get_id(name)
            if claimed.shape != () or claimed.get_type().get_class() not in (
                h5py.h5t.STRING,
                h5py.h5t.INTEGER,
                h5py.h5t.FLOAT,
            ):
                raise InputError(f"{self.path}: attribute '{name}' is not a single text or number")
            value = self._file.attrs[name]
        if isinstance(value, (bytes, np.bytes_)):
            return bytes(value).decode("utf-8", "replace")
        return value if isinstance(value, str) else value.item()

    def names(self) -> list[str]:
        """Paths of all numeric data sets, sorted."""
        found: list[str] = []

        def visit(name: bytes, info: Any) -> None:
            if info.type == h5py.h5o.TYPE_DATASET:
                found.append(os.fsdecode(name))

        with self._or("not a readable HDF5 file", "listing its objects: "):
            h5py.h5o.visit(self._file.id, visit, info=True)
            return sorted(
                name
                for name in found
                if self._opened(name).id.get_type().get_class() in (h5py.h5t.INTEGER, h5py.h5t.FLOAT)
            )

    def members(self, group: str) -> list[str]:
        """Names in a group of this file; empty if missing."""
        with self._or(f"group '{group}' cannot be read"):
            return (
                sorted(found)
                if self._is_here(group) and isinstance(found := self._file[group], h5py.Group)
                else []
            )

    def has(self, name: str) -> bool:
        with self._or(f'data set "{name}": cannot be opened'):
            return self._is_here(name) and isinstance(self._file[name], h5py.Dataset)

    def read(self, name: str) -> NDArray[Any]:
        """Reads the values."""
        with self._or(
            f'data set "{name}": its values cannot be read: damaged, or packed by an unknown filter'
        ):
            found = self._opened(name)
            self._check_type(name, found)
            self._check_storage(name, found)
            values = found[()]
        return np.ascontiguousarray(values, values.dtype.newbyteorder("="))

    def _opened(self, name: str) -> Any:
        if not self._is_here(name):
            raise InputError(f'{self.path}: has no data set "{name}"')
        return self._file[os.fsencode(name)]

    def _is_here(self, name: str) -> bool:
        """True for an object of this file, without soft or external links on its path."""
        group = self._file
        for part in name.split("/"):
            link = group.get(os.fsencode(part), getlink=True)
            if link is None:
                return False
            if not isinstance(link, h5py.HardLink):
                raise InputError(
                    f'{self.path}: "{name}" is a link, which is not followed: store the values in the file'
                )
            group = group[os.fsencode(part)]
            if not isinstance(group, h5py.Group):
                break
        return True

    def _check_type(self, name: str, found: Any) -> None:
        stored = found.id.get_type()
        if stored.get_class() not in (h5py.h5t.INTEGER, h5py.h5t.FLOAT):
            raise self.fail(name, "it does not hold numbers")
        if (size := stored.get_size()) > 8:
            raise self.fail(
                name,
                f"its numbers of {size} bytes are wider than float64 and int64: write them as one of these",
            )
        if found.shape is None:
            raise self.fail(name, "it has no values")
        if len(found.shape) > _MAX_RANK:
            raise self.fail(name, f"it has {len(found.shape)} dimensions, expected at most {_MAX_RANK}")

    def _check_storage(self, name: str, found: Any) -> None:
        """Checks that the storage matches the declared size, which otherwise allows any allocation."""
        if found.is_virtual or found.external:
            raise self.fail(name, "its values are in other files: store them in this one")
        size = found.id.get_type().get_size()
        claimed = size * int(np.prod(found.shape, dtype=object))
        if claimed == 0:
            return
        stored = min(found.id.get_storage_size(), self._bytes)
        plausible = stored == claimed
        if found.chunks is not None:
            chunk = size * int(np.prod(found.chunks, dtype=object))
            plausible = stored > 0 and max(claimed, chunk) // _MAX_INFLATION <= stored
        if not plausible:
            raise self.fail(name, f"it claims {claimed} bytes of values, and {stored} are stored")
        if claimed > MAX_ITEM_BYTES:
            raise self.fail(name, f"{claimed} bytes: at most {MAX_ITEM_BYTES} can be read")


def point_values(file: Hdf5File, name: str) -> NDArray[np.float64]:
    """Reads a data set with one value per point: n numbers, n x 1 or 1 x n, each equal to a double."""
    values = file.read(name)
    if values.size != max(values.shape, default=1):
        raise file.fail(
            name, f"its shape is ({', '.join(map(str, values.shape))}), expected one value per point"
        )
    try:
        return doubles_of(values.ravel())
    except InputError as error:
        raise file.fail(name, str(error)) from None


def only_values(path: str) -> NDArray[np.float64]:
    """Reads the only numeric data set, or the one called "saliency"."""
    file = Hdf5File(path)
    names = file.names()
    if "saliency" not in names and len(names) != 1:
        raise InputError(
            f"{path}: it has {len(names)} data sets of numbers, expected one, or one called 'saliency'"
        )
    return point_values(file, "saliency" if "saliency" in names else names[0])


def names_in(path: str) -> list[str]:
    """Paths of all numeric data sets."""
    return Hdf5File(path).names()


def map_in(path: str, name: str) -> NDArray[np.float64]:
    return point_values(Hdf5File(path), name)
