# SPDX-License-Identifier: GPL-3.0-or-later
"""The YAML files of a submission, and what any text of a stranger has to be before it goes anywhere: `line`. They are never loaded: nodes are
looked at, so that tags make nothing, and aliases, which can multiply, are refused where they stand."""

import datetime
import difflib
import os
import re
import unicodedata
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from salbench import _core
from salbench._errors import NO_LINE, InputError, quoted, wrong_with_line
from salbench._yaml import flow_text, plain_text

LONGEST_TEXT = 1 << 16  # of a YAML file
LIST = "trained_on.txt"  # the file of training shapes, in an archive
LONGEST_LIST = 1 << 20  # bytes
_LONGEST_LINE = 2000  # bytes
FORMAT, OLDER = "salbench submission 2", "salbench submission 1"
MODEL = "model.yaml"  # the entry of a model in a configuration, in an archive
NAME = re.compile(r"[0-9A-Za-z_-]{1,64}", re.ASCII)
MADE_BY = ("files", "command", "function", "built-in")
_SECONDS = re.compile(r"[0-9]{1,12}(\.[0-9]{1,12})?(e[-+]?[0-9]{1,3})?", re.ASCII)
_FILE = re.compile("[0-9a-f]{64} .+")
_VERSION = re.compile(r"[0-9]{1,6}(\.[0-9]{1,6}){2}([-+.][0-9A-Za-z.]{1,20})?")


@dataclass(frozen=True)
class Manifest:
    """submission.yaml: what the archive was made from, as the program knows it. `configuration`, `data`, `model` and `map_digest` are digests."""

    format: str = FORMAT
    program: str = ""
    commit: str = ""
    protocol: str = ""
    configuration: str = ""
    data: str = ""
    maps: int | str = 0
    stages: Sequence[str] = ()
    # Written where there is something to say: those of FORMAT, but for the first, are not in OLDER.
    trained_on: str = ""  # digest of the list of training shapes
    made_by: str = ""  # of MADE_BY
    model: str = ""  # of model.yaml, its entry in a configuration
    function: str = ""  # its name, and what its maps are found by
    files: Sequence[str] = ()  # "DIGEST NAME" of code and weights
    map_digest: str = ""
    ground_truth: str = ""  # the recipe, where it was made by one
    learned: str = ""  # "cross-validated, 5 folds by class"
    seconds: Sequence[str] = ()  # of one map: median and 95th percentile
    timed: str = ""  # what they are of

    def text(self) -> str:
        written = {key: value for key, value in vars(self).items() if value or key in _ALWAYS}
        return "".join(f"{key}: {flow_text(list(value) if isinstance(value, tuple) else value)}\n" for key, value in written.items())


_ALWAYS = ("format", "program", "commit", "protocol", "configuration", "data", "maps", "stages")


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


def is_date(text: str) -> bool:
    """True for one such as 2026-11-23."""
    try:
        return str(datetime.date.fromisoformat(text)) == text
    except ValueError:  # 2026-02-30
        return False


def shown(name: str) -> str:
    """The name of a file, as a line: U+FFFD for what is none."""
    text = os.fsencode(name).decode("utf-8", "replace")
    return "".join("\N{REPLACEMENT CHARACTER}" if unicodedata.category(c) in NO_LINE else c for c in text)


def read_manifest(text: bytes, name: str) -> Manifest:
    """Throws InputError."""
    manifest = Manifest(**{"format": "", **values_of(text, name, list(Manifest.__dataclass_fields__), ("stages", "files", "seconds"))})
    if manifest.format not in (FORMAT, OLDER):
        raise InputError(f"{name}: format is {quoted(manifest.format)}, expected {FORMAT} or {OLDER}")
    if manifest.program and not _VERSION.fullmatch(manifest.program):
        raise InputError(f"{name}: program is {quoted(manifest.program)}, expected a version of salbench, such as {_core.version}")
    if manifest.made_by not in ("", *MADE_BY):
        raise InputError(f"{name}: made_by is {quoted(manifest.made_by)}, expected one of {', '.join(MADE_BY)}")
    if manifest.seconds and (len(manifest.seconds) != 2 or not all(map(_SECONDS.fullmatch, manifest.seconds))):
        raise InputError(f"{name}: seconds are {quoted(str(manifest.seconds))}, expected the median and the 95th percentile, such as [0.5, 2]")
    if wrong := next((line for line in manifest.files if not _FILE.fullmatch(line)), ""):
        raise InputError(f"{name}: files has {quoted(wrong)}, expected a SHA-256 and the name of a file")
    return manifest


def values_of(data: bytes, name: str, known: Sequence[str], lists: Sequence[str]) -> dict[str, Any]:
    """The texts of a mapping, and lists of texts where a key may have one: each is a line."""
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
        if is_list and key.value not in lists:
            raise InputError(f"{name}: {key.value} is a list, expected one line of text")
        lines = [line("" if part.tag.endswith(":null") else part.value, f"{name}: {key.value}") for part in parts]
        values[key.value] = lines if is_list else lines[0]
    return values
