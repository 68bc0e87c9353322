# SPDX-License-Identifier: GPL-3.0-or-later
"""A process that serves (_serving.py): reads items of archives, and files of strangers. Requests have `do`:

item     layout, root, item (of a listing)     image of the one form
shape    layout, root, items of one shape      the same with all views; in OUT.error, a line each, problems of those that are left out (NAME, tab,
                                              why), and of what was recorded (tab, JSON of `Told`)
facts    layout, root, item                    JSON: what `salbench inspect` tells of it
signature layout, root, item                   what it is compared with other shapes by, as float64
rewrite  path                                  image of the one form, from a file that another program wrote
values   path                                  float64: the only data set of numbers, or that called "saliency"
maps     path                                  JSON: names of all data sets of numbers
map      path, name                            float64: one number per point
"""

from __future__ import annotations

import json
import os
from dataclasses import asdict, dataclass, replace
from typing import Any

from salbench import _limits, _serving, _wire
from salbench._errors import StorageError, UnreadableError
from salbench._serving import is_of_the_system, message
from salbench.datasets.records import InputError, Item


@dataclass
class Told:
    """Of the recording of a shape."""

    recorded: int  # people who are in it
    remarks: list[str]  # on rows that cannot be used
    problems: list[str]  # of files that cannot be read


def item(request: dict[str, Any]) -> bytes:
    from salbench.datasets import one_form, sets

    asked = replace(Item.from_json(request["item"]), problem="")  # of its ground truth, which the program says; maps need the shape alone
    form = sets.read(request["layout"], request["root"], asked, request.get("licence", ""))
    form.about["remarks"] = "\n".join([*form.problems, *form.remarks])
    return one_form.image(form)


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
                _core.shape_facts(form, os.fsencode(view.shape_name), os.fsencode(sets.shape_file(view)))
        except (ValueError, OSError) as error:
            if is_of_the_system(error) or isinstance(error, UnreadableError):
                raise
            problems.append(f"{view.name}\t{message(error)}")
            continue
        if whole is None:
            whole = form
        else:
            whole.truths = (*whole.truths, *form.truths)
            whole.about["source_files"] = _lines(whole.about["source_files"], form.about["source_files"])
    if whole is not None and (whole.recording or whole.problems):
        problems.append("\t" + json.dumps(asdict(Told(len(whole.recording.people) if whole.recording else 0, whole.remarks, whole.problems))))
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


ANSWERS: _serving.Answers = {
    "item": item, "shape": shape, "facts": facts, "signature": signature, "rewrite": rewrite, "values": values, "maps": maps, "map": one_map,
}


def _seconds(request: dict[str, Any]) -> int:
    """What the files of a request may take."""
    paths = {request["path"]} if "path" in request else set()
    for row in [request["item"]] if "item" in request else request.get("items", []):
        one = Item.from_json(row)
        paths |= {file.path for file in one.files} | {one.how.get("form", "")}
    return _limits.seconds_for(paths)


def limits_of(request: dict[str, Any]) -> tuple[int, int | None]:
    of_map = request["do"] in ("values", "map", "maps")
    return (_limits.SECONDS_OF_A_MAP, _limits.BYTES_OF_A_MAP) if of_map else (_seconds(request), None)


def main(parent: int | None = None) -> int:
    """Serves until standard input, or the parent, ends."""
    return _serving.main(ANSWERS, limits_of, parent)


def _lines(*texts: str) -> str:
    return "".join(sorted({line for text in texts for line in text.splitlines(keepends=True)}, key=lambda line: line[34:]))
