# SPDX-License-Identifier: GPL-3.0-or-later
"""YAML with lines: a mapping whose errors name file, line and key. PyYAML's nodes, so that nothing makes an object of a tag; levels are
counted before, and mappings that lists lead to afterwards, so that no document recurses or explodes through its aliases."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import fields
from typing import Any, NoReturn

from salbench.datasets._layout import Pattern, number_text
from salbench.datasets._patterns import wrong_with_mesh_pattern, wrong_with_truth_pattern
from salbench.datasets._text import finite_number
from salbench.datasets.records import InputError

MAX_BYTES = 1 << 20  # of a description; those at hand have 1 kB
MAX_DEPTH = 32
MAX_MAPPINGS = 10_000  # that lists may lead to, through aliases or not


def one_line(text: str) -> str:
    """Keys and values of YAML may hold line ends and control characters, and a message is one line."""
    return re.sub(r"[\x00-\x1f\x7f]", "?", text)


def _fail(file: str, line: int, what: str) -> NoReturn:
    raise InputError(f"{file}:{line}: {one_line(what)}")


def _parse(text: str, file: str) -> Any:
    """The node of the first document; None if there is none. What stands behind it is another's."""
    import yaml

    if len(text) > MAX_BYTES:
        _fail(file, 1, f"the description has {len(text)} characters: at most {MAX_BYTES} can be read")
    loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    depth = 1
    try:
        for event in yaml.parse(text, Loader=loader):
            depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
            if depth > MAX_DEPTH:
                _fail(file, event.start_mark.line + 1, f"more than {MAX_DEPTH} levels of mappings and lists")
            if isinstance(event, yaml.DocumentEndEvent):
                break
        return next(iter(yaml.compose_all(text, Loader=loader)), None)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        _fail(file, mark.line + 1 if mark else 1, f"not valid YAML: {error.problem or error.context or error}")
    except (yaml.YAMLError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        _fail(file, 1, f"not valid YAML: {error}")


def _kind_of(node: Any) -> str:
    """scalar, sequence, mapping, or null."""
    return "null" if node is None or (node.id == "scalar" and node.tag == "tag:yaml.org,2002:null") else str(node.id)


def _line_of(node: Any) -> int:
    return int(node.start_mark.line) + 1


_TYPES = ("str", "float", "int", "bool", "Words", "Pattern")  # as dataclasses have them under annotations of the future


class Section:
    """One mapping of a file."""

    def __init__(self, node: Any, file: str, path: str = "", line: int = 1, budget: Iterator[int] | None = None) -> None:
        self.file, self.path = file, path
        self._line = line if node is None else _line_of(node)
        self._budget = iter(range(MAX_MAPPINGS)) if budget is None else budget
        self._entries: dict[str, tuple[int, Any]] = {}
        what = path or "the file"
        if next(self._budget, None) is None:
            _fail(file, self._line, f"more than {MAX_MAPPINGS} mappings in lists: fewer aliases will do")
        if _kind_of(node) == "null":
            return
        if _kind_of(node) != "mapping":
            _fail(file, self._line, f"{what} must be a mapping of keys to values")
        for key, value in node.value:
            if _kind_of(key) not in ("scalar", "null"):
                _fail(file, self._line, f"{what} has a key that is not a plain word")
            name = "" if _kind_of(key) == "null" else key.value
            if name in self._entries:
                _fail(file, _line_of(key), f"the key '{name}' is given twice")
            self._entries[name] = _line_of(key), value

    @classmethod
    def of_text(cls, text: str, file: str) -> Section:
        return cls(_parse(text, file), file)

    def _full(self, key: str) -> str:
        return f"{self.path}.{key}" if self.path and key else self.path or key

    def where(self, key: str) -> str:
        return f"{self.file}:{self._entries.get(key, (self._line,))[0]}"

    def fail(self, key: str, what: str) -> NoReturn:
        raise InputError(f"{self.where(key)}: {one_line(f'{self._full(key)} {what}')}")

    def keys(self) -> list[str]:
        return [*self._entries]

    def __contains__(self, key: str) -> bool:
        return key in self._entries

    def _node(self, key: str) -> Any:
        return self._entries[key][1] if key in self._entries else None

    def child(self, key: str) -> Section:
        """A mapping; `key:` alone is an empty one."""
        return Section(self._node(key), self.file, self._full(key), self._line, self._budget)

    def has_mapping(self, key: str) -> bool:
        return key in self and _kind_of(self._node(key)) in ("mapping", "null")

    def list(self, key: str) -> list[Section]:
        """Mappings of a list, or a single one."""
        if key not in self:
            return []
        node = self._node(key)
        if _kind_of(node) == "mapping":
            return [self.child(key)]
        if _kind_of(node) != "sequence":
            self.fail(key, "must be a list of mappings")
        return [Section(element, self.file, f"{self._full(key)}[{k}]", budget=self._budget) for k, element in enumerate(node.value)]

    def text(self, key: str) -> str | None:
        """A scalar as written; None if the key is absent."""
        if key not in self:
            return None
        node = self._node(key)
        if _kind_of(node) != "scalar":
            self.fail(key, "must be one value")
        return str(node.value)

    def words(self, key: str) -> tuple[str, ...]:
        """A list of scalars, or a single one."""
        if key not in self:
            return ()
        node = self._node(key)
        if _kind_of(node) == "scalar":
            return (node.value,)
        if _kind_of(node) != "sequence" or any(_kind_of(word) != "scalar" for word in node.value):
            self.fail(key, "must be a list of names, such as [a, b]")
        return tuple(word.value for word in node.value)

    def _read(self, key: str, read: Callable[[str], Any], expected: str) -> Any:
        text = self.text(key) or ""
        value = read(text)
        if value is None:
            self.fail(key, f"is '{text}', not {expected}")
        return value

    def number(self, key: str, above_0: bool = False) -> float:
        value = float(self._read(key, finite_number, "a finite number"))
        if above_0 and value <= 0:
            self.fail(key, f"must be a number above 0, not {number_text(value)}")
        return value

    def pattern(self, key: str, parts: Iterable[str] | None = None) -> Pattern:
        """Of meshes, or of files of items that may have these placeholders."""
        text = self.text(key) or ""
        if wrong := wrong_with_mesh_pattern(text) if parts is None else wrong_with_truth_pattern(text, [*parts]):
            self.fail(key, f"'{text}' {wrong}")
        return Pattern.at(text, self.where(key))

    def options(self, kind: type[Any], *others: str) -> dict[str, Any]:
        """Fields of a dataclass, each by the key that is called as it is, or as its metadata say; some have a section of their own. Its
        type and metadata say what is expected. Fields of other types are not read. others: keys that are not fields."""
        known = {(entry.metadata.get("section", ""), key): entry for entry in fields(kind)
                 if str(entry.type) in _TYPES and (key := entry.metadata.get("key", entry.name)) is not None}
        self.reject_unknown([*dict.fromkeys(section or key for section, key in known), *others])
        found: dict[str, Any] = {}
        for section in dict.fromkeys(section for section, _ in known):
            where = self.child(section) if section else self
            if section:
                where.reject_unknown(key for of, key in known if of == section)
            found |= {entry.name: where._option(key, entry) for (of, key), entry in known.items() if of == section and key in where}
        return found

    def _option(self, key: str, entry: Any) -> Any:
        kind, told = entry.type, entry.metadata
        if names := told.get("one_of"):
            return self._read(key, names.get, f"one of {', '.join(names)}")
        if kind == "float":
            return self.number(key, told.get("above_0", False))
        if kind == "int":
            return self._read(key, lambda text: int(text) if re.fullmatch(r"-?[0-9]{1,9}", text) else None, "a whole number")
        if kind == "bool":
            return self._read(key, {"true": True, "false": False}.get, "true or false")
        if kind == "Pattern":
            return self.pattern(key, told.get("parts"))
        return self.words(key) if kind == "Words" else self.text(key)

    def reject_unknown(self, known: Iterable[str]) -> None:
        names = list(known)
        for key in self._entries:
            if key not in names:
                self.fail(key, "is not a known key; " + did_you_mean(key, names, f"known are: {', '.join(names)}"))


def did_you_mean(word: str, known: Iterable[str], otherwise: str = "") -> str:
    """As the program says it: compiled, and so imported only where something is wrong."""
    from salbench import _core

    return _core.did_you_mean(os.fsencode(word), list(known), otherwise)
