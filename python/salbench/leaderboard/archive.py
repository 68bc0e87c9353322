# SPDX-License-Identifier: GPL-3.0-or-later
"""ZIP archives: ours, whose bytes follow from what is in them, and anybody's, which are trusted nowhere.

zipfile lists the entries. They are compared with the archive and unpacked here, since it takes entries that overlap, names that differ from
those of the directory, and contents that are longer than declared.
"""

import io
import stat
import struct
import zipfile
import zlib
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

_LONGEST_NAME = 255
_HEADER = struct.Struct("<4s5H3I2H")  # before an entry: signature, version, flags, method, time, date, CRC, sizes, lengths of name and extra field
_ENCRYPTED, _SIZES_FOLLOW = 0x2041, 0x8  # bits of the flags
_ZIP64 = 0xFFFFFFFF  # the size is in the extra field


class Refused(Exception):
    """Why a submission is refused: one line, without the name of its file."""


@dataclass(frozen=True)
class Limits:
    entries: int
    bytes: int  # of all entries, unpacked


def quoted(text: str) -> str:
    """A word of a stranger within a message."""
    return '"' + "".join(c if " " <= c <= "~" else "?" for c in text[:32]) + ('..."' if len(text) > 32 else '"')


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


def read_zip(data: bytes, limits: Limits) -> dict[str, bytes]:
    """The files in an archive, by name, in its order. Throws Refused."""
    try:
        archive = zipfile.ZipFile(io.BytesIO(data))
    except (zipfile.BadZipFile, NotImplementedError, ValueError, OverflowError, struct.error) as error:
        raise Refused(f"cannot be read as a ZIP archive: {error}") from None
    entries = archive.infolist()
    if len(entries) > limits.entries:
        raise Refused(f"has {len(entries)} entries, expected at most {limits.entries}")
    if sum(entry.file_size for entry in entries) > limits.bytes:
        raise Refused(f"unpacks to more than {limits.bytes} bytes, the most that its shapes need")
    names = [_checked_name(entry) for entry in entries]
    twice = [name for name, n in Counter(names).items() if n > 1]
    if twice:
        raise Refused(f"the entry {quoted(twice[0])} is there twice")
    places = [_place(data, entry, name) for entry, name in zip(entries, names)]
    ordered = sorted(places)
    for (_, end), (begin, _) in zip(ordered, [*ordered[1:], (archive.start_dir, 0)]):
        if end > begin:
            raise Refused("cannot be read as a ZIP archive: entries overlap")
    return {name: _unpacked(data[end - entry.compress_size:end], entry, name)
            for entry, name, (_, end) in zip(entries, names, places) if not name.endswith("/")}


def _raw_name(entry: zipfile.ZipInfo) -> bytes:
    return entry.orig_filename.encode("utf-8" if entry.flag_bits & 0x800 else "cp437")


def _checked_name(entry: zipfile.ZipInfo) -> str:
    name = _raw_name(entry).decode("utf-8", "surrogateescape")

    def refuse(what: str) -> None:
        raise Refused(f"the entry {quoted(name)} {what}")

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


def _place(data: bytes, entry: zipfile.ZipInfo, name: str) -> tuple[int, int]:
    """Where the entry begins, with its header, and where it ends. The header must say what the directory says."""
    damaged = Refused(f"the entry {quoted(name)} is damaged: its header is not what the directory says")
    begin = entry.header_offset
    if not 0 <= begin <= len(data) - _HEADER.size:
        raise damaged
    signature, _, flags, method, _, _, crc, packed, size, name_length, extra_length = _HEADER.unpack_from(data, begin)
    end_of_name = begin + _HEADER.size + name_length
    is_same = (signature == b"PK\3\4" and method == entry.compress_type and not flags & _ENCRYPTED
               and data[begin + _HEADER.size:end_of_name] == _raw_name(entry))
    if not flags & _SIZES_FOLLOW:
        is_same &= crc == entry.CRC and packed in (entry.compress_size, _ZIP64) and size in (entry.file_size, _ZIP64)
    if not is_same:
        raise damaged
    return begin, end_of_name + extra_length + entry.compress_size


def _unpacked(packed: bytes, entry: zipfile.ZipInfo, name: str) -> bytes:
    """As many bytes as the entry declares, with its checksum."""
    content, rest = packed, b""
    if entry.compress_type == zipfile.ZIP_DEFLATED:
        stream = zlib.decompressobj(-zlib.MAX_WBITS)
        try:
            content = stream.decompress(packed, entry.file_size + 1)  # what comes beyond is never unpacked
        except zlib.error as error:
            raise Refused(f"the entry {quoted(name)} is damaged: {error}") from None
        rest = stream.unused_data
    if len(content) > entry.file_size:
        raise Refused(f"the entry {quoted(name)} unpacks to more than it declares")
    if len(content) < entry.file_size:
        raise Refused(f"the entry {quoted(name)} is cut short: {len(content)} of {entry.file_size} bytes")
    if rest or zlib.crc32(content) != entry.CRC:
        raise Refused(f"the entry {quoted(name)} is damaged: its checksum is another")
    return content
