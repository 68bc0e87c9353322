# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench _import`, a served command: reads items of archives, and files of strangers, in a process that may crash.

A line of standard input is `REQUEST<TAB>OUT`, a request being a line of JSON. The answer is written to the file OUT, or what is wrong with
the input, one line, to OUT.error; then OUT is printed on a line of its own. Where the system keeps it from reading or writing, there is neither
file, and a line before OUT says why. Requests have `do`:

item     layout, root, item (of a listing)     image of the one form
shape    layout, root, items of one shape      the same with all views; problems of those that are left out in OUT.error, a line each
facts    layout, root, item                    JSON: what `salbench inspect` tells of it
signature layout, root, item                   what it is compared with other shapes by, as float64
rewrite  path                                  image of the one form, from a file that another program wrote
values   path                                  float64: the only data set of numbers, or that called "saliency"
maps     path                                  JSON: names of all data sets of numbers
map      path, name                            float64: one number per point
"""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Callable
from dataclasses import replace
from typing import Any, BinaryIO

from salbench import _limits
from salbench._errors import StorageError, UnreadableError
from salbench._files import ADVICE, LACKING
from salbench._limits import ERROR
from salbench._processes import end_with_parent, leave_interrupts_to_parent
from salbench.datasets import _wire
from salbench.datasets.records import InputError, Item


def item(request: dict[str, Any]) -> bytes:
    from salbench.datasets import one_form, sets

    asked = replace(Item.from_json(request["item"]), problem="")  # of its ground truth, which the program says; maps need the shape alone
    return one_form.image(sets.read(request["layout"], request["root"], asked, request.get("licence", "")))


def shape(request: dict[str, Any]) -> tuple[bytes | None, list[str]]:
    """What is wrong with a file here is taken out of the set that is written. So a file that cannot be had is none of them."""
    try:
        return _views_together(request)
    except (MemoryError, UnreadableError) as error:
        raise StorageError(message(error)) from None


def _views_together(request: dict[str, Any]) -> tuple[bytes | None, list[str]]:
    from salbench import _core
    from salbench.datasets import one_form, sets

    whole, problems = None, []
    for row in request["items"]:
        view = Item.from_json(row)
        try:
            if view.view and not one_form.is_name(view.view):
                raise InputError(f"{view.name}: a view cannot be called '{view.view}': rename its files")
            form = sets.read(request["layout"], request["root"], view, request.get("licence", ""))
            if whole is None:
                _core.shape_facts(form, os.fsencode(view.shape or view.name), os.fsencode(sets.shape_file(view)))
        except (ValueError, OSError) as error:
            if _is_of_the_system(error) or isinstance(error, UnreadableError):
                raise
            problems.append(f"{view.name}\t{message(error)}")
            continue
        if whole is None:
            whole = form
        else:
            whole.truths = (*whole.truths, *form.truths)
            whole.about["source_files"] = _lines(whole.about["source_files"], form.about["source_files"])
    return None if whole is None else one_form.image(whole), problems


def facts(request: dict[str, Any]) -> bytes:
    from salbench.datasets._facts import facts_of

    return _wire.dumps(facts_of(request["layout"], request["root"], Item.from_json(request["item"])))


def signature(request: dict[str, Any]) -> bytes:
    from salbench.datasets import copies, sets

    asked = replace(Item.from_json(request["item"]), problem="", truth=False)
    return copies.signature(sets.read(request["layout"], request["root"], asked)).tobytes()


def rewrite(request: dict[str, Any]) -> bytes:
    from salbench.datasets import one_form

    return one_form.image(one_form.read_foreign(request["path"]))


def values(request: dict[str, Any]) -> bytes:
    from salbench.datasets import _hdf5

    return _hdf5.only_values(request["path"]).tobytes()


def maps(request: dict[str, Any]) -> bytes:
    from salbench.datasets import _hdf5

    return _wire.dumps(_hdf5.Hdf5File(request["path"]).names())


def one_map(request: dict[str, Any]) -> bytes:
    from salbench.datasets import _hdf5

    return _hdf5.point_values(_hdf5.Hdf5File(request["path"]), request["name"]).tobytes()


ANSWERS: dict[str, Callable[[dict[str, Any]], bytes | tuple[bytes | None, list[str]]]] = {
    "item": item, "shape": shape, "facts": facts, "signature": signature, "rewrite": rewrite, "values": values, "maps": maps, "map": one_map,
}


def _is_of_the_system(error: Exception) -> bool:
    """True of what says nothing about the input: a library that cannot be loaded, say, or a limit on open files."""
    return isinstance(error, (StorageError, ImportError)) or (isinstance(error, OSError) and error.errno in LACKING)


def message(error: BaseException) -> str:
    """One line."""
    if isinstance(error, MemoryError):
        return "no memory for it; close other programs, leave it out, or work on fewer items at a time"
    if isinstance(error, ImportError):
        return f"a library cannot be loaded: {error}"
    if isinstance(error, OSError) and error.filename is not None:
        return f"{os.fsdecode(error.filename)}: cannot be read: {error.strerror}"
    if isinstance(error, (ValueError, OSError)):
        return " ".join(str(error).splitlines())
    return f"a defect of salbench, please report it: {type(error).__name__}: {error}"


def _seconds(request: dict[str, Any]) -> int:
    """What the files of a request may take."""
    paths = {request["path"]} if "path" in request else set()
    for row in [request["item"]] if "item" in request else request.get("items", []):
        one = Item.from_json(row)
        paths |= {file.path for file in one.files} | {one.how.get("form", "")}
    return _limits.SECONDS + _limits.SECONDS_PER_MB * (sum(os.path.getsize(path) for path in paths if os.path.isfile(path)) // 1_000_000)


def answer(text: bytes, out: bytes) -> str:
    """Writes OUT or OUT.error, or both. Otherwise what the system lacks for it: one line."""
    made: bytes | None = None
    problems: list[str] = []
    try:
        request = _wire.loads(text)
        of_map = request["do"] in ("values", "map", "maps")
        _limits.limit(*((_limits.SECONDS_OF_A_MAP, _limits.BYTES_OF_A_MAP) if of_map else (_seconds(request),)))
        answered = ANSWERS[request["do"]](request)
        made, problems = answered if isinstance(answered, tuple) else (answered, [])
    except Exception as error:  # the file of one item must not end the process that reads the others
        if _is_of_the_system(error):
            return message(error)
        problems = [message(error)]
    files = {out: made, out + ERROR.encode(): "\n".join(problems).encode("utf-8", "surrogateescape") or None}
    try:
        for path, data in files.items():
            if data is not None:
                with open(path, "wb") as file:
                    file.write(data)
    except OSError as error:
        for path in files:
            with contextlib.suppress(OSError):
                os.unlink(path)
        advice = ADVICE.get(error.errno or 0, "; set TMPDIR to another")
        return f"{os.fsdecode(os.path.dirname(out))}: cannot be written: {error.strerror}{advice}"
    return ""


def main(parent: int | None = None) -> int:
    """Serves until standard input, or the parent, ends."""
    leave_interrupts_to_parent()
    end_with_parent(parent)
    _limits.no_core()
    _log_to_stderr()
    said = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a library prints is no answer
    serve(sys.stdin.buffer, said)
    return 0


def serve(lines: BinaryIO, said: BinaryIO) -> None:
    for line in lines:
        request, _, out = line.rstrip(b"\n").rpartition(b"\t")
        lacking = answer(request, out)
        if lacking:
            said.write(" ".join(lacking.split("\n")).encode("utf-8", "surrogateescape") + b"\n")
        said.write(out + b"\n")
        said.flush()


def _log_to_stderr() -> None:
    import logging

    handler = logging.StreamHandler()
    handler.setFormatter(logging.Formatter("warning: %(message)s"))
    logging.getLogger("salbench").addHandler(handler)


def _lines(*texts: str) -> str:
    return "".join(sorted({line for text in texts for line in text.splitlines(keepends=True)}, key=lambda line: line[34:]))
