# SPDX-License-Identifier: GPL-3.0-or-later
"""ZIP archives: ours, whose bytes follow from what is in them, and anybody's, which are trusted nowhere: every size is bounded before a byte is
unpacked. Why an archive is refused is an InputError: one line, without the name of the file."""

import io
import stat
import struct
import zipfile
import zlib
from collections import Counter
from collections.abc import Iterable

from salbench._errors import InputError, quoted

_LONGEST_NAME = 255
_HEADER = 30  # bytes before an entry, without its name
_LONGEST_ROW = 1024  # of the directory
_ENCRYPTED = 0x2041  # bits of the flags


def zip_of(entries: Iterable[tuple[str, bytes]]) -> bytes:
    """An archive of these entries in their order, stored as they are and dated 1980: the same entries make the same bytes."""
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w") as archive:
        for name, content in entries:
            info = zipfile.ZipInfo(name)
            info.create_system, info.create_version, info.extract_version = 3, 63, 10
            info.external_attr = (stat.S_IFREG | 0o644) << 16
            archive.writestr(info, content)
    return made.getvalue()


def read_zip(data: bytes, most_entries: int, most_bytes: int) -> dict[str, bytes]:
    """The files in an archive, by name, in its order. most_bytes: of all of them, unpacked. Throws InputError."""
    try:
        with zipfile.ZipFile(_bounded(data, most_entries)) as archive:
            entries = [(_checked_name(entry), entry) for entry in archive.infolist()]
            if len(entries) > most_entries:
                raise InputError(f"has {len(entries)} entries, expected at most {most_entries}")
            if sum(entry.file_size for _, entry in entries) > most_bytes:
                raise InputError(f"unpacks to more than {most_bytes} bytes, the most that its shapes need")
            twice = [name for name, n in Counter(name for name, _ in entries).items() if n > 1]
            if twice:
                raise InputError(f"the entry {quoted(twice[0])} is there twice")
            ordered = sorted((entry.header_offset, entry.header_offset + _HEADER + len(_raw_name(entry)) + entry.compress_size) for _, entry in entries)
            for (_, end), (begin, _) in zip(ordered, [*ordered[1:], (archive.start_dir, 0)]):
                if end > begin:
                    raise InputError("cannot be read as a ZIP archive: entries overlap, or lie beyond its end")
            return {name: _unpacked(archive, entry, name) for name, entry in entries if not name.endswith("/")}
    except InputError:
        raise
    except (zipfile.BadZipFile, NotImplementedError, ValueError, OverflowError, struct.error) as error:
        raise InputError(f"cannot be read as a ZIP archive: {error}") from None


def _bounded(data: bytes, most_entries: int) -> io.BytesIO:
    """The archive; zipfile makes an object of each row of the directory, so that its size is looked at before."""
    file = io.BytesIO(data)
    end = zipfile._EndRecData(file)  # type: ignore[attr-defined]  # as zipfile finds it
    if end and end[zipfile._ECD_SIZE] > most_entries * _LONGEST_ROW:  # type: ignore[attr-defined]
        raise InputError(f"has a directory of {end[zipfile._ECD_SIZE]} bytes, expected at most {most_entries} entries")  # type: ignore[attr-defined]
    return file


def _raw_name(entry: zipfile.ZipInfo) -> bytes:
    return entry.orig_filename.encode("utf-8" if entry.flag_bits & 0x800 else "cp437")


def _checked_name(entry: zipfile.ZipInfo) -> str:
    name = _raw_name(entry).decode("utf-8", "surrogateescape")

    def refuse(what: str) -> None:
        raise InputError(f"the entry {quoted(name)} {what}")

    path = name[:-1] if name.endswith("/") and entry.file_size == 0 else name
    if not 0 < len(_raw_name(entry)) <= _LONGEST_NAME:
        refuse(f"has no name of 1 to {_LONGEST_NAME} bytes")
    if any(c < " " or c in "\x7f\\:" for c in name):
        refuse("has a character in its name that no file of a submission has")
    if any(part in ("", ".", "..") for part in path.split("/")):
        refuse("has a path that leaves the folder")
    kind = stat.S_IFMT(entry.external_attr >> 16)
    if entry.create_system == 3 and kind not in (0, stat.S_IFREG, stat.S_IFDIR):
        refuse("is a link or a device")
    if entry.flag_bits & _ENCRYPTED:
        refuse("is encrypted")
    if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        refuse(f"is compressed by method {entry.compress_type}, expected none or deflate")
    return name


def _unpacked(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, name: str) -> bytes:
    """As many bytes as the entry declares, with its checksum. zipfile unpacks no more if it is asked for no more, and compares the name before
    the content."""
    try:
        with archive.open(entry) as file:
            content = file.read(entry.file_size + 1)
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError, EOFError, OSError, ValueError, struct.error, zlib.error) as error:
        raise InputError(f"the entry {quoted(name)} is damaged: {type(error).__name__ if not str(error) else error}") from None
    if len(content) != entry.file_size:
        raise InputError(f"the entry {quoted(name)} is cut short: {len(content)} of {entry.file_size} bytes")
    return content
