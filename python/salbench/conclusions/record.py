# SPDX-License-Identifier: GPL-3.0-or-later
"""Reader of run.yaml, the record of a run. Scalars are texts, so that a model named NO stays one, and fields
are checked against the kinds that the program writes, since users may edit the file."""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from salbench.conclusions.units import UNITS
from salbench.system.errors import InputError, quoted


class Scalar(NamedTuple):
    words: str
    fits: Callable[[str], bool] = lambda text: True


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def one_of(*words: str) -> Scalar:
    return Scalar(f"one of {', '.join(words)}", words.__contains__)


TEXT, NUMBER = Scalar("a text"), Scalar("a number", _is_number)
COUNT = Scalar("a whole number", lambda text: text.isascii() and text.isdigit() and len(text) <= 20)

# Kinds: {} by field, "*" for any other field; [] a list of any length; () a list of this length. Any field
# may be absent or empty.
_KINDS: dict[str, Any] = {
    **dict.fromkeys(("program", "results", "host", "libraries", "shard", "scores_digest", "reference"), TEXT),
    **dict.fromkeys(("threads", "seconds", "peak_memory_mb", "artefacts_computed"), NUMBER),
    "hdf5_seconds": {"*": NUMBER},
    "data_set": {"participants": (COUNT, COUNT), "meshes": COUNT, "clouds": COUNT, "files": COUNT, "*": TEXT},
    "ground_truth": {"*": {"*": TEXT}},
    "evaluated": {"*": TEXT},  # or a list of these
    "copies": [[TEXT]],
    "metrics": {"*": {"better": one_of("higher", "lower"), "*": TEXT}},
    "stages": {"*": {"version": COUNT, "why": {"*": COUNT}}},
    "nodes": [{"stage": TEXT, "of": TEXT, "scope": TEXT, "*": NUMBER}],
    "cache_bytes": {"*": NUMBER},
    "remarks": [{"*": TEXT}],
    "failed": [{"*": TEXT}],
    "configuration": {
        "protocol": TEXT,
        "seed": COUNT,
        "cache": TEXT,
        "dataset": {"participants": TEXT},
        "statistics": {"unit": one_of(*UNITS), "leading": TEXT},
        "models": {"*": dict.fromkeys(("trained", "command", "function", "description"), TEXT)},
    },
}


def checked(found: Any) -> dict[str, Any]:
    """Checks the parsed file; empty for a run that did not end. Throws InputError with the name of a field of
    the wrong kind."""
    if not isinstance(found, dict):
        return {}
    one = found.get("evaluated")
    record: dict[str, Any] = _checked(
        found, _KINDS | {"evaluated": [_KINDS["evaluated"]]} if isinstance(one, list) else _KINDS, ""
    )
    return record


def chief_metric(of_run: Mapping[str, Any]) -> str:
    """Metric that the run's protocol ranks by; empty if it names none."""
    name: str = of_run.get("configuration", {}).get("statistics", {}).get("leading", "")
    return name


def _checked(value: Any, kind: Any, name: str) -> Any:
    """Returns the value, with {} and [] for empty ones."""
    if isinstance(kind, Scalar):
        return (
            value
            if isinstance(value, str) and (not value or kind.fits(value))
            else _fail(value, kind.words, name)
        )
    if value == "":
        return {} if isinstance(kind, dict) else []
    if isinstance(kind, dict):
        if not isinstance(value, dict):
            _fail(value, "a mapping of names to values", name)
        kinds = {key: kind.get(key, kind.get("*")) for key in value}
        return {
            key: (
                inner if kinds[key] is None else _checked(inner, kinds[key], f"{name}.{key}" if name else key)
            )
            for key, inner in value.items()
        }
    if not isinstance(value, list) or isinstance(kind, tuple) and len(value) != len(kind):
        _fail(value, f"a list of {len(kind)}" if isinstance(kind, tuple) else "a list", name)
    return [_checked(inner, kind[at % len(kind)], f"{name}[{at}]") for at, inner in enumerate(value)]


def _fail(value: Any, words: str, name: str) -> Any:
    found = quoted(value) if isinstance(value, str) else "a mapping" if isinstance(value, dict) else "a list"
    raise InputError(f"{name} is {found}, not {words}")
