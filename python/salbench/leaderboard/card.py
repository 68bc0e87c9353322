# SPDX-License-Identifier: GPL-3.0-or-later
"""card.yaml: what the authors of a model declare of it. What a run knows by itself stands in submission.yaml (texts.Manifest)."""

import re
from dataclasses import dataclass
from typing import Any

from salbench import _core
from salbench._errors import InputError, quoted
from salbench.leaderboard.texts import NAME, is_date, values_of

REQUIRED = ("name", "citation", "licence", "training_data", "test_overlap")
# What readers of a ranking ask for, with why; a card of version 1.0 has none of it.
ASKED_FOR = {
    "version": "release or commit of the model: another one may have other maps",
    "parameters": "how many numbers were trained, 0 for none: size is the first thing that models are compared by",
    "code": "an address, or closed: whether others can run it",
    "weights": "an address, closed, or none: whether others can run it without training",
    "training_set": "an address, closed, or none: whether others can train it again",
    "device": "processor or GPU that the seconds were measured on: without it they mean nothing",
    "memory": "peak memory, such as 2.1 GB on the GPU: whether it fits other machines",
    "contact": "whom a maintainer asks",
}
MOST_SEEDS = 9  # further trainings
_LISTS = ("test_overlap", "trained_on", "files", "seeds", "reproduced_by")
_WEB = re.compile(r"https?://\S+")
_IMAGE = re.compile(r"[\w./:@-]{1,400}@sha256:[0-9a-f]{64}", re.ASCII)


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
    parameters: str = ""  # digits
    code: str = ""  # an address, "closed" or "none"; so weights and training_set
    weights: str = ""
    training_set: str = ""
    container: str = ""  # an image by its digest
    files: tuple[str, ...] = ()  # code and weights beside the card, whose digests a submission has
    seeds: tuple[str, ...] = ()  # further trainings of the model: folders of maps beside the card, or models of the configuration
    device: str = ""
    memory: str = ""
    timed: str = ""  # what the seconds are of, where the run cannot know
    contact: str = ""
    reproduced_by: tuple[str, ...] = ()

    @property
    def overlap(self) -> str:
        return ", ".join(self.test_overlap) or "none"

    @property
    def has_open_weights(self) -> bool:
        """That there are none says the same of a model that has no need of any."""
        return is_web(self.weights) or self.weights == "none"

    @property
    def unsaid(self) -> dict[str, str]:
        """What it says nothing of, by key, with why readers ask for it."""
        return {key: why for key, why in ASKED_FOR.items() if not getattr(self, key)}


def is_web(address: str) -> bool:
    """True for what a link may lead to: no `javascript:` and the like."""
    return _WEB.fullmatch(address) is not None


def read_card(text: bytes, name: str) -> Card:
    """Throws InputError for every key that is missing, or the first that is wrong. name: of the file, for messages."""
    values = values_of(text, name, list(Card.__dataclass_fields__), _LISTS)
    missing = [key for key in REQUIRED if not values.get(key)]
    if missing:
        raise InputError(f"{name}: lacks {', '.join(missing)}")
    wrong = _core.wrong_with_model_name(values["name"])
    if wrong:
        raise InputError(f"{name}: name {quoted(values['name'])} {wrong}")
    _check_texts(values, name)
    overlap = values.pop("test_overlap")
    if isinstance(overlap, str) and overlap != "none":
        raise InputError(f"{name}: test_overlap is {quoted(overlap)}; write none, or a list of the items of this data set that the model was trained "
                      "or tuned on, such as [12, 52]")
    trained_on = _trained_on(values.pop("trained_on", ""), name)
    lists = {key: _list(values.pop(key, "")) for key in ("files", "seeds", "reproduced_by")}
    _check_names(lists, name)
    return Card(**{**values, **lists}, test_overlap=() if overlap == "none" else tuple(overlap), trained_on=trained_on)


def _check_texts(values: dict[str, Any], name: str) -> None:
    date = values.get("date")
    if date and not is_date(date):
        raise InputError(f"{name}: date is {quoted(date)}, expected one such as 2026-11-23")
    parameters = values.get("parameters")
    if parameters and not re.fullmatch("[0-9]{1,15}", parameters):
        raise InputError(f"{name}: parameters is {quoted(parameters)}, expected how many there are, in digits, such as 1200000; 0 for none")
    for key, others in (("code", ("closed",)), ("weights", ("closed", "none")), ("training_set", ("closed", "none"))):
        given = values.get(key)
        if given and given not in others and not is_web(given):
            raise InputError(f"{name}: {key} is {quoted(given)}, expected an address that begins with https://, or {' or '.join(others)}")
    container = values.get("container")
    if container and container != "none" and not _IMAGE.fullmatch(container):
        raise InputError(f"{name}: container is {quoted(container)}, expected an image by its digest, such as "
                         "ghcr.io/somebody/model@sha256:... (podman image inspect --format '{{.Digest}}' IMAGE)")


def _check_names(lists: dict[str, tuple[str, ...]], name: str) -> None:
    for file in lists["files"]:
        if file.startswith("/") or any(part in ("", ".", "..") for part in file.split("/")):
            raise InputError(f"{name}: files has {quoted(file)}, expected a file below the folder of the card")
    for seed in lists["seeds"]:
        if not NAME.fullmatch(seed):
            raise InputError(f"{name}: seeds has {quoted(seed)}, expected names of letters, digits, '-' and '_', at most 64, such as [1, 2, 3]")
    if len(lists["seeds"]) > MOST_SEEDS:
        raise InputError(f"{name}: seeds has {len(lists['seeds'])} names, expected at most {MOST_SEEDS}")
    for key in ("files", "seeds"):
        if len(set(lists[key])) < len(lists[key]):
            raise InputError(f"{name}: {key} has a name twice")


def _list(given: str | list[str]) -> tuple[str, ...]:
    return tuple(given) if isinstance(given, list) else (given,) if given not in ("", "none") else ()


def _trained_on(given: str | list[str], name: str) -> tuple[str, ...]:
    """What the key says, if it can be used."""
    if isinstance(given, list) and len(given) == 3 and all(given):
        return tuple(given)
    if isinstance(given, list) or given in (".", "..") or "/" in given:
        raise InputError(f"{name}: trained_on is {quoted(str(given))}; name a file beside the card with the names of the training shapes, or write "
                      "[LAYOUT, SPLIT, DIGEST] for a split of this data set, with data_set: splits of run.yaml")
    return _list(given)
