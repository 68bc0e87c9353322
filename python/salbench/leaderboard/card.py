# SPDX-License-Identifier: GPL-3.0-or-later
"""Reader of card.yaml, the authors' statements on a model. Facts recorded by the run are in submission.yaml
(texts.Manifest)."""

import datetime
import json
import re
from dataclasses import dataclass
from typing import Any

from salbench import _core
from salbench.leaderboard.texts import Forms, require, values_of
from salbench.system.errors import InputError, quoted

REQUIRED = ("name", "citation", "licence", "training_data", "test_overlap")
# Optional keys that readers of a ranking ask for, with reasons; cards of version 1.0 lack them.
ASKED_FOR = {
    "version": "release or commit of the model: another one may have other maps",
    "parameters": (
        "how many numbers were trained, 0 for none: size is the first thing that models are compared by"
    ),
    "code": "an address, or closed: whether others can run it",
    "weights": "an address, closed, or none: whether others can run it without training",
    "training_set": "an address, closed, or none: whether others can train it again",
    "device": "processor or GPU that the seconds were measured on: without it they mean nothing",
    "memory": "peak memory, such as 2.1 GB on the GPU: whether it fits other machines",
    "contact": "whom a maintainer asks",
}
MOST_SEEDS = 9  # further trainings
_LISTS = ("test_overlap", "trained_on", "seeds", "reproduced_by")
# ignored keys of earlier cards; submission.yaml has the digests of a command's files
_UNUSED = ("files",)
_WEB = r"https?://\S+"
_FORMS: Forms = {
    "date": ("[0-9]{4}-[0-9]{2}-[0-9]{2}", "one such as 2026-11-23"),
    "parameters": ("[0-9]{1,15}", "how many there are, in digits, such as 1200000; 0 for none"),
    "code": (f"{_WEB}|closed", "an address that begins with https://, or closed"),
    "weights": (f"{_WEB}|closed|none", "an address that begins with https://, or closed or none"),
    "training_set": (f"{_WEB}|closed|none", "an address that begins with https://, or closed or none"),
    "container": (
        "none|[0-9A-Za-z_./:@-]{1,400}@sha256:[0-9a-f]{64}",
        (
            "an image by its digest, such as ghcr.io/somebody/model@sha256:... "
            "(podman image inspect --format '{{.Digest}}' IMAGE)"
        ),
    ),
    "seeds": ("[0-9A-Za-z_-]{1,64}", "names of letters, digits, '-' and '_', at most 64, such as [1, 2, 3]"),
}


@dataclass(frozen=True)
class Card:
    name: str = ""  # in tables
    citation: str = ""
    licence: str = ""
    training_data: str = ""
    test_overlap: tuple[str, ...] = ()  # items of the data set that the model was trained or tuned on
    date: str = ""
    url: str = ""
    trained_on: tuple[str, ...] = ()  # a file of names; or layout, split, and digest of the splits
    version: str = ""
    parameters: str = ""  # as digits
    code: str = ""  # an address, "closed" or "none"; same for weights and training_set
    weights: str = ""
    training_set: str = ""
    container: str = ""  # an image with its digest
    # further trainings of the model: folders of maps beside the card, or models of the configuration
    seeds: tuple[str, ...] = ()
    device: str = ""
    memory: str = ""
    timed: str = ""  # meaning of the seconds, if the run cannot know it
    contact: str = ""
    reproduced_by: tuple[str, ...] = ()

    @property
    def overlap(self) -> str:
        return ", ".join(self.test_overlap) or "none"

    @property
    def has_open_weights(self) -> bool:
        """True for open weights, and for models that need none."""
        return is_web(self.weights) or self.weights == "none"

    @property
    def unsaid(self) -> dict[str, str]:
        """Missing keys, with the reasons why readers ask for them."""
        return {key: why for key, why in ASKED_FOR.items() if not getattr(self, key)}


def is_web(address: str) -> bool:
    """True for safe link targets: not `javascript:` and the like."""
    return re.fullmatch(_WEB, address) is not None


def read_card(text: bytes, name: str) -> Card:
    """Reads a card. Throws InputError that lists every missing key, or names the first wrong one. name: of
    the file, for messages."""
    values = read_values(text, name)
    if values.get("test_overlap") == []:
        values["test_overlap"] = "none"
    missing = [key for key in REQUIRED if not values.get(key)]
    if missing:
        raise InputError(f"{name}: lacks {', '.join(missing)}")
    if wrong := _core.wrong_with_model_name(values["name"]):
        raise InputError(f"{name}: name {quoted(values['name'])} {wrong}")
    require(values, _FORMS, name)
    try:
        datetime.date.fromisoformat(values.get("date") or "2026-11-23")
    except ValueError:  # such as 2026-02-30
        raise InputError(f"{name}: date is {quoted(values['date'])}, which is no day") from None
    overlap = values["test_overlap"]
    if isinstance(overlap, str) and overlap != "none":
        raise InputError(
            f"{name}: test_overlap is {quoted(overlap)}; write none, or a list of the items of this data set"
            " that the model was trained or tuned on, such as [12, 52]"
        )
    _check_trained_on(values.get("trained_on", ""), name)
    texts = {key: value for key, value in values.items() if key not in _UNUSED}
    card = Card(**{**texts, **{key: _tuple(values.get(key, "")) for key in _LISTS}})
    if len(card.seeds) > MOST_SEEDS or len(set(card.seeds)) < len(card.seeds):
        raise InputError(
            f"{name}: seeds has {len(card.seeds)} names, expected at most {MOST_SEEDS}, each once"
        )
    return card


def read_values(text: bytes, name: str) -> dict[str, Any]:
    """Texts and lists of texts of a card, by key, unchecked. Throws InputError."""
    return values_of(text, name, [*Card.__dataclass_fields__, *_UNUSED], [*_LISTS, *_UNUSED])


def with_line(text: bytes, name: str, reproduced_by: str) -> bytes:
    """Adds a line to a card on who reproduced the maps. Throws InputError for a card that a leaderboard would
    refuse."""
    values = read_values(text, name)
    values["reproduced_by"] = [*_tuple(values.get("reproduced_by", "")), reproduced_by]
    made = "".join(
        f"{key}: {json.dumps(value, ensure_ascii=False)}\n" for key, value in values.items()
    ).encode(errors="surrogatepass")
    read_card(made, name)
    return made


def _tuple(given: str | list[str]) -> tuple[str, ...]:
    return tuple(given) if isinstance(given, list) else (given,) if given not in ("", "none") else ()


def _check_trained_on(given: str | list[str], name: str) -> None:
    is_known = (
        len(given) == 3 and all(given)
        if isinstance(given, list)
        else given not in (".", "..") and "/" not in given
    )
    if not is_known:
        raise InputError(
            f"{name}: trained_on is {quoted(str(given))}; name a file beside the card with the names of the"
            " training shapes, or write [LAYOUT, SPLIT, DIGEST] for a split of this data set, with data_set:"
            " splits of run.yaml"
        )
