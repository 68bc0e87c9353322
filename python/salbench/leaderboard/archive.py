# SPDX-License-Identifier: GPL-3.0-or-later
"""ZIP archives: writes reproducible ones, and reads untrusted ones with the standard library's zipfile. Every
size is bounded before a byte is unpacked. A refusal is an InputError: one line, without the file name."""

import io
import stat
import struct
import zipfile
import zlib
from collections.abc import Iterable

from salbench.system.errors import InputError, quoted

_LONGEST_ROW = 1024  # bytes of the directory per entry
_DAMAGE = (
    zipfile.BadZipFile,
    NotImplementedError,
    RuntimeError,
    EOFError,
    OSError,
    OverflowError,
    ValueError,
    struct.error,
    zlib.error,
)


def zip_of(entries: Iterable[tuple[str, bytes]]) -> bytes:
    """Returns an archive of these entries in their order, uncompressed and dated 1980: the same entries make
    the same bytes."""
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w") as archive:
        for name, content in entries:
            info = zipfile.ZipInfo(name)
            info.create_system, info.create_version, info.extract_version = 3, 63, 10
            info.external_attr = (stat.S_IFREG | 0o644) << 16
            archive.writestr(info, content)
    return made.getvalue()


def read_zip(data: bytes, most_entries: int, most_bytes: int, only: str = "") -> dict[str, bytes]:
    """Unpacks the files of an archive: name -> content, in its order. most_bytes: bound for all files. only:
    the single file to unpack. Throws InputError."""
    file = io.BytesIO(data)
    try:
        end = zipfile._EndRecData(file)  # type: ignore[attr-defined]  # zipfile makes an object per row of the directory: bound its size first
        if end and end[zipfile._ECD_SIZE] > most_entries * _LONGEST_ROW:  # type: ignore[attr-defined]
            raise InputError(f"has a directory of {end[zipfile._ECD_SIZE]} bytes, expected at most {most_entries} entries")  # type: ignore[attr-defined]
        with zipfile.ZipFile(file) as archive:
            entries = [entry for entry in archive.infolist() if not entry.filename.endswith("/")]
            if len(entries) > most_entries:
                raise InputError(f"has {len(entries)} entries, expected at most {most_entries}")
            entries = [entry for entry in entries if only in ("", entry.filename)]
            if sum(entry.file_size for entry in entries) > most_bytes:
                raise InputError(f"unpacks to more than {most_bytes} bytes, the most that its shapes need")
            # overlapping entries unpack the same bytes again and again
            if sum(entry.compress_size for entry in entries) > len(data):
                raise InputError("has entries that overlap")
            files = {entry.filename: _unpacked(archive, entry) for entry in entries}
    except InputError:
        raise
    except _DAMAGE as error:
        raise InputError(f"cannot be read as a ZIP archive: {str(error) or type(error).__name__}") from None
    if len(files) < len(entries):
        raise InputError("has an entry twice")
    return files


def _unpacked(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> bytes:
    """Content of an entry, at most one byte more than declared. Methods other than deflate could take
    unbounded memory."""
    if stat.S_IFMT(entry.external_attr >> 16) not in (0, stat.S_IFREG):
        raise InputError(f"the entry {quoted(entry.filename)} is a link or a device")
    if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise InputError(
            f"the entry {quoted(entry.filename)} is compressed by method {entry.compress_type}, expected none"
            " or deflate"
        )
    with archive.open(entry) as file:
        content = file.read(entry.file_size + 1)
    if len(content) != entry.file_size:
        raise InputError(
            f"the entry {quoted(entry.filename)} is cut short: {len(content)} of {entry.file_size} bytes"
        )
    return content
