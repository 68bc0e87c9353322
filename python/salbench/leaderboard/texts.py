# SPDX-License-Identifier: GPL-3.0-or-later
"""The YAML files of a submission, and what any text of a stranger has to be before it goes anywhere: `line`. They are never loaded: nodes are
looked at, so that tags make nothing, and aliases, which can multiply, are refused where they stand."""

import datetime
import difflib
import json
import os
import re
import unicodedata
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from salbench import _core
from salbench._errors import NO_LINE, InputError, quoted, wrong_with_line
from salbench._yaml import plain_text

LONGEST_TEXT = 1 << 16  # of a YAML file
LIST = "trained_on.txt"  # the file of training shapes, in an archive
LONGEST_LIST = 1 << 20  # bytes
_LONGEST_LINE = 2000  # bytes
FORMAT = "salbench submission 1"
FREE = ("date", "url", "trained_on")  # keys of a card that may be left out
_LISTS = ("test_overlap", "trained_on", "stages")  # keys whose value may be one
_VERSION = re.compile(r"[0-9]{1,6}(\.[0-9]{1,6}){2}([-+.][0-9A-Za-z.]{1,20})?")


@dataclass(frozen=True)
class Card:
    """card.yaml: what the authors declare of a model."""

    name: str = ""  # in tables
    citation: str = ""
    licence: str = ""
    training_data: str = ""
    test_overlap: tuple[str, ...] = ()  # items of the data set that the model was trained or tuned on
    date: str = ""
    url: str = ""
    trained_on: tuple[str, ...] = ()  # a file of names; or layout, split, and digest of the splits

    @property
    def overlap(self) -> str:
        return ", ".join(self.test_overlap) or "none"


@dataclass(frozen=True)
class Manifest:
    """submission.yaml: what the archive was made from. `configuration` and `data` are digests."""

    format: str = FORMAT
    program: str = ""
    commit: str = ""
    protocol: str = ""
    configuration: str = ""
    data: str = ""
    maps: int | str = 0
    stages: Sequence[str] = ()
    trained_on: str = ""  # digest of the list of training shapes; not written where there is none

    def text(self) -> str:
        return "".join(f"{key}: {json.dumps(value)}\n" for key, value in vars(self).items() if value or key != "trained_on")


def line(text: Any, what: str) -> str:
    """The text, if it is one line of Unicode of a bounded length. Throws InputError."""
    if not isinstance(text, str):
        raise InputError(f"{what} is a list, expected one line of text")
    wrong = wrong_with_line(text)
    if wrong:
        raise InputError(f"{what} has {wrong}, expected one line of text")
    if len(text.encode()) > _LONGEST_LINE:
        raise InputError(f"{what} has {len(text.encode())} bytes, expected at most {_LONGEST_LINE}")
    return text


def shown(name: str) -> str:
    """The name of a file, as a line: U+FFFD for what is none."""
    text = os.fsencode(name).decode("utf-8", "replace")
    return "".join("\N{REPLACEMENT CHARACTER}" if unicodedata.category(c) in NO_LINE else c for c in text)


def read_card(text: bytes, name: str) -> Card:
    """Throws InputError for every key that is missing, or the first that is wrong. name: of the file, for messages."""
    fields = list(Card.__dataclass_fields__)
    values = _values(text, name, fields)
    missing = [key for key in fields if not values.get(key) and key not in FREE]
    if missing:
        raise InputError(f"{name}: lacks {', '.join(missing)}")
    wrong = _core.wrong_with_model_name(values["name"])
    if wrong:
        raise InputError(f"{name}: name {quoted(values['name'])} {wrong}")
    date = values.get("date")
    if date and not _is_date(date):
        raise InputError(f"{name}: date is {quoted(date)}, expected one such as 2026-11-23")
    overlap = values.pop("test_overlap")
    if isinstance(overlap, str) and overlap != "none":
        raise InputError(f"{name}: test_overlap is {quoted(overlap)}; write none, or a list of the items of this data set that the model was trained "
                      "or tuned on, such as [12, 52]")
    trained_on = values.pop("trained_on", "")
    return Card(**values, test_overlap=() if overlap == "none" else tuple(overlap), trained_on=_trained_on(trained_on, name))


def _trained_on(given: str | list[str], name: str) -> tuple[str, ...]:
    """What the key says, if it can be used."""
    if isinstance(given, list) and len(given) == 3 and all(given):
        return tuple(given)
    if isinstance(given, list) or given in (".", "..") or "/" in given:
        raise InputError(f"{name}: trained_on is {quoted(str(given))}; name a file beside the card with the names of the training shapes, or write "
                      "[LAYOUT, SPLIT, DIGEST] for a split of this data set, with data_set: splits of run.yaml")
    return (given,) if given not in ("", "none") else ()


def _is_date(text: str) -> bool:
    try:
        return re.fullmatch("[0-9]{4}-[0-9]{2}-[0-9]{2}", text) is not None and bool(datetime.date.fromisoformat(text))
    except ValueError:  # 2026-02-30
        return False


def read_manifest(text: bytes, name: str) -> Manifest:
    """Throws InputError."""
    manifest = Manifest(**{"format": "", **_values(text, name, list(Manifest.__dataclass_fields__))})
    if manifest.program and not _VERSION.fullmatch(manifest.program):
        raise InputError(f"{name}: program is {quoted(manifest.program)}, expected a version of salbench, such as {_core.version}")
    return manifest


def _values(data: bytes, name: str, known: Sequence[str]) -> dict[str, Any]:
    """The texts and lists of texts of a mapping: each is a line."""
    import yaml

    try:
        root = yaml.compose(plain_text(data, name, LONGEST_TEXT), Loader=yaml.SafeLoader)
    except yaml.YAMLError as error:  # two documents, or one anchor twice
        raise InputError(f"{name}: {getattr(error, 'problem', None) or 'is not YAML'}") from None
    if not isinstance(root, yaml.MappingNode):
        raise InputError(f"{name}: expected lines such as `{known[0]}: ...`")
    twice = [key for key, n in Counter(str(key.value) for key, _ in root.value).items() if n > 1]
    if twice:
        raise InputError(f"{name}:{root.start_mark.line + 1}: {quoted(twice[0])} is there twice")
    values: dict[str, Any] = {}
    for key, value in root.value:
        where = f"{name}:{key.start_mark.line + 1}"
        if key.value not in known:
            near = difflib.get_close_matches(str(key.value), known, 1)
            raise InputError(f"{where}: {quoted(str(key.value))} is not a known key{f'; did you mean {near[0]!r}?' if near else ''}")
        is_list = isinstance(value, yaml.SequenceNode)
        parts = value.value if is_list else [value]
        if not all(isinstance(part, yaml.ScalarNode) for part in parts):
            raise InputError(f"{where}: {key.value} has an inner list or mapping, expected text, or a list of texts")
        if is_list and key.value not in _LISTS:
            raise InputError(f"{name}: {key.value} is a list, expected one line of text")
        lines = [line("" if part.tag.endswith(":null") else part.value, f"{name}: {key.value}") for part in parts]
        values[key.value] = lines if is_list else lines[0]
    return values
