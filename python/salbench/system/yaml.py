# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks on untrusted YAML before it is parsed, and YAML output of values."""

import json
import re
from collections.abc import Callable

from salbench.system.errors import InputError, quoted

DEEPEST = 20  # levels of nesting
_PAIRS = re.compile(r"\\\\|\\ud[89ab][0-9a-f]{2}\\ud[c-f][0-9a-f]{2}")  # after an even number of backslashes


def flow_text(
    value: object, default: Callable[[object], object] | None = None, sort_keys: bool = False
) -> str:
    """A value as one line of ASCII. JSON is YAML, except for its surrogate pairs for characters beyond
    U+FFFF. Throws TypeError and RecursionError like json.dumps."""

    def one(escapes: re.Match[str]) -> str:
        if escapes[0] == r"\\":
            return escapes[0]
        character = json.loads(f'"{escapes[0]}"')
        return f"\\U{ord(character):08x}"

    return _PAIRS.sub(one, json.dumps(value, default=default, sort_keys=sort_keys))


def plain_text(data: bytes, name: str, most: int) -> str:
    """Text of a file that is safe to load: without aliases, which can multiply, without tags, which create
    objects, and with bounded nesting, since the parser recurses. Throws InputError. name: of the file, for
    messages."""
    import yaml

    if len(data) > most:
        raise InputError(f"{name}: {len(data)} bytes, expected at most {most}")
    depth = 0
    try:
        text = data.decode("utf-8")
        for event in yaml.parse(text, Loader=getattr(yaml, "CBaseLoader", yaml.BaseLoader)):
            where = f"{name}:{event.start_mark.line + 1}"
            depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
            tag = getattr(event, "tag", None)
            if isinstance(event, yaml.AliasEvent):
                raise InputError(f"{where}: an alias, expected plain text and lists")
            if tag and (not tag.startswith("tag:yaml.org,2002:") or "python" in tag):
                raise InputError(f"{where}: the tag {quoted(tag)}, expected plain text and lists")
            if depth > DEEPEST:
                raise InputError(f"{where}: is nested too deeply")
    except UnicodeDecodeError:
        raise InputError(f"{name}: is not UTF-8") from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        problem = getattr(error, "problem", None) or "is not YAML"
        if problem.startswith("mapping values are not allowed"):
            problem += "; put a text with ': ' into quotes"
        raise InputError(f"{name}{f':{mark.line + 1}' if mark else ''}: {problem}") from None
    return text
