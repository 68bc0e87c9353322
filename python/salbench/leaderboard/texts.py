# SPDX-License-Identifier: GPL-3.0-or-later
"""The YAML files of a submission. They are never loaded: nodes are looked at, so that tags make nothing, and aliases, which can multiply, are
refused where they stand."""

import difflib
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from salbench import _core
from salbench.leaderboard.archive import Refused, quoted

LONGEST_TEXT = 1 << 16  # of a YAML file
_LONGEST_VALUE = 2000  # of a key
_DEEPEST = 20
FORMAT = "salbench submission 1"
FREE = ("date", "url")  # keys of a card that may be left out


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

    def text(self) -> str:
        def written(value: Any) -> str:
            if isinstance(value, str):
                return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
            return str(value) if isinstance(value, int) else f"[{', '.join(map(written, value))}]"

        return "".join(f"{key}: {written(value)}\n" for key, value in vars(self).items())


def read_card(text: bytes, name: str) -> Card:
    """Throws Refused for every key that is missing, or the first that is wrong. name: of the file, for messages."""
    fields = list(Card.__dataclass_fields__)
    values = _values(text, name, fields)
    for key, value in values.items():
        if key != "test_overlap":
            _require_line(value, f"{name}: {key}")
    missing = [key for key in fields if not values.get(key) and key not in FREE]
    if missing:
        raise Refused(f"{name}: lacks {', '.join(missing)}")
    wrong = _core.wrong_with_model_name(str(values["name"]))
    if wrong:
        raise Refused(f"{name}: name {quoted(str(values['name']))} {wrong}")
    date = values.get("date")
    if date and not re.fullmatch("[0-9]{4}-[0-9]{2}-[0-9]{2}", str(date)):
        raise Refused(f"{name}: date is {quoted(str(date))}, expected one such as 2026-11-23")
    overlap = values.pop("test_overlap")
    if isinstance(overlap, str) and overlap != "none":
        raise Refused(f"{name}: test_overlap is {quoted(overlap)}; write none, or a list of the items of this data set that the model was trained "
                      "or tuned on, such as [12, 52]")
    return Card(**{key: str(value) for key, value in values.items()}, test_overlap=() if overlap == "none" else tuple(overlap))


def read_manifest(text: bytes, name: str) -> Manifest:
    values: dict[str, Any] = {"format": "", **_values(text, name, list(Manifest.__dataclass_fields__))}
    return Manifest(**values)


def require_plain(text: bytes, name: str) -> None:
    """Throws Refused for YAML with aliases or tags, or without end."""
    _look(_composed(text, name), name)


def _require_line(value: Any, what: str) -> None:
    if not isinstance(value, str):
        raise Refused(f"{what} is a list, expected one line of text")
    if any(c < " " or c == "\x7f" for c in value):
        raise Refused(f"{what} has a control character, expected one line of text")
    if len(value.encode("utf-8", "surrogateescape")) > _LONGEST_VALUE:
        raise Refused(f"{what} has {len(value.encode('utf-8', 'surrogateescape'))} bytes, expected at most {_LONGEST_VALUE}")


def _composed(text: bytes, name: str) -> Any:
    import yaml

    if len(text) > LONGEST_TEXT:
        raise Refused(f"{name}: {len(text)} bytes, expected at most {LONGEST_TEXT}")
    try:
        return yaml.compose(text.decode("utf-8"), Loader=yaml.SafeLoader)
    except UnicodeDecodeError:
        raise Refused(f"{name}: is not UTF-8") from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        raise Refused(f"{name}{f':{mark.line + 1}' if mark else ''}: {getattr(error, 'problem', None) or 'is not YAML'}") from None
    except RecursionError:
        raise Refused(f"{name}: is nested too deeply") from None


def _look(node: Any, name: str, seen: set[int] | None = None, depth: int = 0) -> None:
    """All nodes: each stands in one place, and is what YAML has by itself."""
    import yaml

    seen = set() if seen is None else seen
    if node is None:
        return
    where = f"{name}:{node.start_mark.line + 1}"
    if id(node) in seen:
        raise Refused(f"{where}: an alias, expected plain text and lists")
    if not node.tag.startswith("tag:yaml.org,2002:") or "python" in node.tag:
        raise Refused(f"{where}: the tag {quoted(node.tag)}, expected plain text and lists")
    if depth > _DEEPEST:
        raise Refused(f"{where}: is nested too deeply")
    seen.add(id(node))
    if isinstance(node, yaml.MappingNode):
        twice = [key for key, n in Counter(str(key.value) for key, _ in node.value).items() if n > 1]
        if twice:
            raise Refused(f"{where}: {quoted(twice[0])} is there twice")
    if not isinstance(node, yaml.ScalarNode):
        for child in node.value:
            for one in child if isinstance(child, tuple) else [child]:
                _look(one, name, seen, depth + 1)


def _values(text: bytes, name: str, known: Sequence[str]) -> dict[str, Any]:
    """The texts and lists of texts of a mapping."""
    import yaml

    root = _composed(text, name)
    _look(root, name)
    if not isinstance(root, yaml.MappingNode):
        raise Refused(f"{name}: expected lines such as `{known[0]}: ...`")
    values: dict[str, Any] = {}
    for key, value in root.value:
        where = f"{name}:{key.start_mark.line + 1}"
        if key.value not in known:
            near = difflib.get_close_matches(str(key.value), known, 1)
            raise Refused(f"{where}: {quoted(str(key.value))} is not a known key{f'; did you mean {near[0]!r}?' if near else ''}")
        parts = value.value if isinstance(value, yaml.SequenceNode) else [value]
        if not all(isinstance(part, yaml.ScalarNode) for part in parts):
            raise Refused(f"{where}: {key.value} has an inner list or mapping, expected text, or a list of texts")
        texts = ["" if part.tag.endswith(":null") else part.value for part in parts]
        values[key.value] = texts if parts is value.value else texts[0]
    return values


def limit_bytes(points: Mapping[str, int]) -> int:
    """What a submission for shapes of so many points can need, unpacked."""
    header, row = 1024, 4096
    return 4 * LONGEST_TEXT + sum(8 * n + header + row for n in points.values())
