# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of the YAML files of a submission. Values stay texts, as the authors wrote them, each one line of
bounded length; tags and aliases are refused."""

import difflib
import os
import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from salbench import _core
from salbench.system.errors import NO_LINE, InputError, quoted, wrong_with_line
from salbench.system.yaml import flow_text, plain_text

LONGEST_TEXT = 1 << 16  # bytes of a YAML file
LIST = "trained_on.txt"  # list of training shapes, in an archive
LONGEST_LIST = 1 << 20  # bytes
_LONGEST_LINE = 2000  # bytes
FORMAT, OLDER = "salbench submission 2", "salbench submission 1"
MODEL = "model.yaml"  # entry of a model in a configuration, in an archive
MADE_BY = ("files", "command", "function", "built-in")
_NULL = ("~", "null", "Null", "NULL")
# keys that are written even if empty
_ALWAYS = ("format", "program", "commit", "protocol", "configuration", "data", "maps", "stages")
Forms = Mapping[str, tuple[str, str]]  # by key: pattern of a text, and its description


@dataclass(frozen=True)
class Manifest:
    """submission.yaml: the program's record of an archive. `configuration`, `data`, `model` and `map_digest`
    are digests."""

    format: str = FORMAT
    program: str = ""
    commit: str = ""
    protocol: str = ""
    configuration: str = ""
    data: str = ""
    maps: int | str = 0
    stages: Sequence[str] = ()
    trained_on: str = ""  # digest of the list of training shapes
    # Keys that OLDER does not have.
    made_by: str = ""  # one of MADE_BY
    model: str = ""  # digest of model.yaml, its entry in a configuration
    function: str = ""  # name and identity of a function
    files: Sequence[str] = ()  # "DIGEST NAME" for code and weights
    map_digest: str = ""
    ground_truth: str = ""  # the recipe, if the ground truth was made by one
    learned: str = ""  # "cross-validated, 5 folds by class"
    seconds: Sequence[str] = ()  # per map: median and 95th percentile
    timed: str = ""  # meaning of the seconds

    def text(self) -> str:
        written = {key: value for key, value in vars(self).items() if value or key in _ALWAYS}
        return "".join(f"{key}: {flow_text(value)}\n" for key, value in written.items())


_FORMS: Forms = {
    "format": (f"{FORMAT}|{OLDER}", f"{FORMAT} or {OLDER}"),
    "program": (
        r"[0-9]{1,6}(\.[0-9]{1,6}){2}([-+.][0-9A-Za-z.]{1,20})?",
        f"a version of salbench, such as {_core.version}",
    ),
    "made_by": ("|".join(MADE_BY), f"one of {', '.join(MADE_BY)}"),
    "seconds": (
        r"[0-9]{1,12}(\.[0-9]{1,12})?(e[-+]?[0-9]{1,3})?",
        "the median and the 95th percentile, such as [0.5, 2]",
    ),
    "files": ("[0-9a-f]{64} .+", "a SHA-256 and the name of a file"),
}


def read_manifest(text: bytes) -> Manifest:
    """Reads submission.yaml. Throws InputError."""
    name = "submission.yaml"
    values = values_of(text, name, list(Manifest.__dataclass_fields__), ("stages", "files", "seconds"))
    require(values, _FORMS, name)
    if not values.get("format"):
        raise InputError(f"{name}: has no format, expected {FORMAT} or {OLDER}")
    if values.get("seconds") and len(values["seconds"]) != 2:
        raise InputError(
            f"{name}: seconds has {len(values['seconds'])} numbers, expected {_FORMS['seconds'][1]}"
        )
    return Manifest(**values)


def loaded(data: bytes, name: str) -> Any:
    """Parses a file into texts, lists and mappings. Throws InputError."""
    import yaml

    try:
        return yaml.load(plain_text(data, name, LONGEST_TEXT), yaml.BaseLoader)
    except yaml.YAMLError as error:  # two documents, for example
        raise InputError(f"{name}: {getattr(error, 'problem', None) or 'is not YAML'}") from None


def values_of(data: bytes, name: str, known: Sequence[str], lists: Sequence[str]) -> dict[str, Any]:
    """Texts of a mapping with known keys; keys in `lists` may have a list of texts. Throws InputError."""
    values = loaded(data, name)
    if not isinstance(values, dict):
        raise InputError(f"{name}: expected lines such as `{known[0]}: ...`")
    for key, value in values.items():
        if key not in known:
            near = difflib.get_close_matches(key, known, 1)
            raise InputError(
                f"{name}: {quoted(key)} is not a known key{f'; did you mean {near[0]!r}?' if near else ''}"
            )
        is_list = isinstance(value, list) and key in lists
        values[key] = (
            [line(part, f"{name}: {key}") for part in value] if is_list else line(value, f"{name}: {key}")
        )
    return values


def line(text: Any, what: str) -> str:
    """Checks that a text is one line of Unicode of bounded length, which may have a line end, as after YAML's
    `>`; "" for YAML's null. Throws InputError."""
    if not isinstance(text, str):
        raise InputError(f"{what} has a list or mapping, expected one line of text")
    text = text.rstrip("\n")
    if "\n" in text:
        raise InputError(f"{what} has several lines: write it in one")
    if wrong := wrong_with_line(text):
        raise InputError(f"{what} has {wrong}, expected one line of text")
    if len(text.encode()) > _LONGEST_LINE:
        raise InputError(f"{what} has {len(text.encode())} bytes, expected at most {_LONGEST_LINE}")
    return "" if text in _NULL else text


def require(values: Mapping[str, Any], forms: Forms, name: str) -> None:
    """Throws InputError for the first text that does not match its pattern; empty ones pass."""
    for key, (pattern, expected) in forms.items():
        given = values.get(key, "")
        for text in given if isinstance(given, list) else [given]:
            if text and not re.fullmatch(pattern, text):
                raise InputError(
                    f"{name}: {key} {'has' if isinstance(given, list) else 'is'} {quoted(text)}, expected"
                    f" {expected}"
                )


def shown(name: str) -> str:
    """File name as one line, with U+FFFD for undecodable bytes."""
    text = os.fsencode(name).decode("utf-8", "replace")
    return "".join("\N{REPLACEMENT CHARACTER}" if unicodedata.category(c) in NO_LINE else c for c in text)


def plain(text: str) -> str:
    """Cell of a CSV file: an apostrophe protects text that spreadsheets would take for a formula."""
    return f"'{text}" if text.startswith(("=", "+", "-", "@")) else text
