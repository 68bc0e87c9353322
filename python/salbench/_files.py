# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that are there whole or not at all."""

import contextlib
import os


def replace_file(path: str | os.PathLike[str], data: bytes, *, to_disk: bool = False) -> None:
    """In one step. to_disk: its bytes are on the disk when it gets its name. Throws OSError."""
    temporary = os.path.join(os.path.dirname(path), f".{os.urandom(8).hex()}.unfinished")
    try:
        with open(temporary, "xb") as file:
            file.write(data)
            if to_disk:
                file.flush()
                os.fsync(file.fileno())
        os.replace(temporary, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(temporary)
        raise
