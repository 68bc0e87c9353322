# SPDX-License-Identifier: GPL-3.0-or-later
"""ZIP archives: ours, whose bytes follow from what is in them, and anybody's, which are trusted nowhere: every size is bounded before a byte is
unpacked. Why an archive is refused is an InputError: one line, without the name of the file."""

import io
import stat
import struct
import zipfile
import zlib
from collections import Counter
from collections.abc import Container, Iterable
from typing import NoReturn

from salbench._errors import InputError, quoted

_LONGEST_ROW = 1024  # of the directory


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


def read_zip(data: bytes, most_entries: int, most_bytes: int, only: Container[str] | None = None) -> dict[str, bytes]:
    """The files in an archive, by name, in its order; of these, `only` some. most_entries: of the archive; most_bytes: of the files that are read,
    unpacked. Throws InputError. A name is text: no file gets it."""
    try:
        with zipfile.ZipFile(_bounded(data, most_entries)) as archive:
            entries = [entry for entry in archive.infolist() if not entry.filename.endswith("/")]
            if len(entries) > most_entries:
                raise InputError(f"has {len(entries)} entries, expected at most {most_entries}")
            entries = [entry for entry in entries if only is None or entry.filename in only]
            if sum(entry.file_size for entry in entries) > most_bytes:
                raise InputError(f"unpacks to more than {most_bytes} bytes, the most that its shapes need")
            twice = [name for name, n in Counter(entry.filename for entry in entries).items() if n > 1]
            if twice:
                raise InputError(f"the entry {quoted(twice[0])} is there twice")
            return {entry.filename: _unpacked(archive, entry) for entry in entries}
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


def _unpacked(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> bytes:
    """As many bytes as the entry declares, with its checksum. zipfile unpacks no more if it is asked for no more, and compares the name before
    the content."""
    def refuse(what: str) -> NoReturn:
        raise InputError(f"the entry {quoted(entry.filename)} {what}") from None

    if stat.S_IFMT(entry.external_attr >> 16) not in (0, stat.S_IFREG):
        refuse("is a link or a device")
    if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        refuse(f"is compressed by method {entry.compress_type}, expected none or deflate")
    try:
        with archive.open(entry) as file:
            content = file.read(entry.file_size + 1)
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError, EOFError, OSError, ValueError, struct.error, zlib.error) as error:
        refuse(f"is damaged: {str(error) or type(error).__name__}")
    if len(content) != entry.file_size:
        refuse(f"is cut short: {len(content)} of {entry.file_size} bytes")
    return content
