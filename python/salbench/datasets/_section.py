# SPDX-License-Identifier: GPL-3.0-or-later
"""YAML with lines: a mapping whose errors name file, line and key. It is built from PyYAML's events, so that no document recurses,
explodes through its aliases, or makes an object of a tag."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any, NoReturn

from salbench.datasets._text import finite_number
from salbench.datasets.records import InputError

MAX_BYTES = 1 << 20  # of a description; those at hand have 1 kB
MAX_DEPTH = 32
MAX_MAPPINGS = 10_000  # that lists may lead to, through aliases or not


@dataclass
class Node:
    """A scalar has text, a sequence items, a mapping pairs; `null` is a scalar without any."""

    kind: str  # "scalar", "null", "sequence", "mapping"
    line: int
    text: str = ""
    items: list[Node] = field(default_factory=list)  # of a mapping key, value, key, value ...

    def pairs(self) -> Iterator[tuple[Node, Node]]:
        return zip(self.items[::2], self.items[1::2])


def one_line(text: str) -> str:
    """Keys and values of YAML may hold line ends and control characters, and a message is one line."""
    return re.sub(r"[\x00-\x1f\x7f]", "?", text)


def _fail(file: str, line: int, what: str) -> NoReturn:
    raise InputError(f"{file}:{line}: {one_line(what)}")


def _parse(text: str, file: str) -> Node:
    import yaml

    if len(text) > MAX_BYTES:
        _fail(file, 1, f"the description has {len(text)} characters: at most {MAX_BYTES} can be read")
    loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    anchors: dict[str, Node] = {}
    document = Node("sequence", 1)
    open_nodes = [document]
    try:
        for event in yaml.parse(text, Loader=loader):
            line = event.start_mark.line + 1
            if isinstance(event, yaml.CollectionEndEvent):
                open_nodes.pop()
            if isinstance(event, yaml.DocumentStartEvent) and document.items:
                break  # what stands behind the first document is another's
            if not isinstance(event, yaml.NodeEvent):
                continue
            if isinstance(event, yaml.AliasEvent):
                if event.anchor not in anchors:
                    _fail(file, line, f"not valid YAML: the alias '{event.anchor}' has no anchor")
                open_nodes[-1].items.append(anchors[event.anchor])
                continue
            if isinstance(event, yaml.ScalarEvent):
                plain = event.style in (None, "")
                null = plain and event.value in ("", "~", "null", "Null", "NULL")
                node = Node("null" if null else "scalar", line, "" if null else event.value)
            else:
                node = Node("mapping" if isinstance(event, yaml.MappingStartEvent) else "sequence", line)
            open_nodes[-1].items.append(node)
            if node.kind in ("mapping", "sequence"):
                open_nodes.append(node)
                if len(open_nodes) > MAX_DEPTH:
                    _fail(file, line, f"more than {MAX_DEPTH} levels of mappings and lists")
            if event.anchor:
                anchors[event.anchor] = node
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        _fail(file, mark.line + 1 if mark else 1, f"not valid YAML: {error.problem or error.context or error}")
    except (yaml.YAMLError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        _fail(file, 1, f"not valid YAML: {error}")
    return document.items[0] if document.items else Node("null", 1)


class Section:
    """One mapping of a file."""

    def __init__(self, node: Node, file: str, path: str = "", budget: list[int] | None = None) -> None:
        self.file, self.path = file, path
        self._budget = [MAX_MAPPINGS] if budget is None else budget
        self._entries: dict[str, tuple[int, Node]] = {}
        self._line = node.line
        what = path or "the file"
        self._budget[0] -= 1
        if self._budget[0] < 0:
            _fail(file, node.line, f"more than {MAX_MAPPINGS} mappings in lists: fewer aliases will do")
        if node.kind == "null":
            return
        if node.kind != "mapping":
            _fail(file, node.line, f"{what} must be a mapping of keys to values")
        for key, value in node.pairs():
            if key.kind not in ("scalar", "null"):
                _fail(file, node.line, f"{what} has a key that is not a plain word")
            if key.text in self._entries:
                _fail(file, key.line, f"the key '{key.text}' is given twice")
            self._entries[key.text] = key.line, value

    @classmethod
    def of_text(cls, text: str, file: str) -> Section:
        return cls(_parse(text, file), file)

    def _full(self, key: str) -> str:
        return f"{self.path}.{key}" if self.path else key

    def where(self, key: str) -> str:
        return f"{self.file}:{self._entries.get(key, (self._line,))[0]}"

    def fail(self, key: str, what: str) -> NoReturn:
        raise InputError(f"{self.where(key)}: {one_line(f'{self._full(key)} {what}')}")

    def keys(self) -> list[str]:
        return list(self._entries)

    def __contains__(self, key: str) -> bool:
        return key in self._entries

    def _node(self, key: str) -> Node:
        return self._entries[key][1] if key in self._entries else Node("null", self._line)

    def child(self, key: str) -> Section:
        """A mapping; `key:` alone is an empty one."""
        return Section(self._node(key), self.file, self._full(key), self._budget)

    def has_mapping(self, key: str) -> bool:
        return key in self and self._node(key).kind in ("mapping", "null")

    def list(self, key: str) -> list[Section]:
        """Mappings of a list, or a single one."""
        if key not in self:
            return []
        node = self._node(key)
        if node.kind == "mapping":
            return [self.child(key)]
        if node.kind != "sequence":
            self.fail(key, "must be a list of mappings")
        return [Section(element, self.file, f"{self._full(key)}[{k}]", self._budget) for k, element in enumerate(node.items)]

    def text(self, key: str) -> str | None:
        """A scalar as written; None if the key is absent."""
        if key not in self:
            return None
        node = self._node(key)
        if node.kind != "scalar":
            self.fail(key, "must be one value")
        return node.text

    def words(self, key: str) -> tuple[str, ...]:
        """A list of scalars, or a single one."""
        if key not in self:
            return ()
        node = self._node(key)
        if node.kind == "scalar":
            return (node.text,)
        if node.kind != "sequence" or any(word.kind != "scalar" for word in node.items):
            self.fail(key, "must be a list of names, such as [a, b]")
        return tuple(word.text for word in node.items)

    def _read(self, key: str, read: Callable[[str], Any], default: Any, expected: str) -> Any:
        text = self.text(key)
        if text is None:
            return default
        value = read(text)
        if value is None:
            self.fail(key, f"is '{text}', not {expected}")
        return value

    def number(self, key: str, default: float) -> float:
        return float(self._read(key, finite_number, default, "a finite number"))

    def whole(self, key: str, default: int) -> int:
        return int(self._read(key, lambda text: int(text) if re.fullmatch(r"-?[0-9]{1,9}", text) else None, default, "a whole number"))

    def flag(self, key: str, default: bool) -> bool:
        return bool(self._read(key, {"true": True, "false": False}.get, default, "true or false"))

    def choice(self, key: str, names: tuple[str, ...], default: str) -> str:
        return str(self._read(key, lambda text: text if text in names else None, default, f"one of {', '.join(names)}"))

    def reject_unknown(self, known: Iterable[str]) -> None:
        names = list(known)
        for key in self._entries:
            if key not in names:
                self.fail(key, "is not a known key; " + did_you_mean(key, names, f"known are: {', '.join(names)}"))


def did_you_mean(word: str, known: Iterable[str], otherwise: str = "") -> str:
    """As the program says it: compiled, and so imported only where something is wrong."""
    from salbench import _core

    return _core.did_you_mean(os.fsencode(word), list(known), otherwise)
