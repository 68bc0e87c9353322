# SPDX-License-Identifier: GPL-3.0-or-later
"""What is run, as the compiled part takes it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Settings:
    """What is None is the configuration's, or the usual."""

    path: str | None = None  # of the configuration, its name, or run.yaml of a run, whose items, reference and maps count unless others are given
    yaml: str | None = None  # in place of a path
    models: str | None = None  # YAML, in place of those of the configuration
    kept: str | None = None  # those of the configuration that stay, such as "LS,PS"; "": people and chance
    maps: Mapping[str, str] = field(default_factory=dict)  # folders of maps by model, as `salbench run --maps` takes them
    matched: bool = False  # values of these maps are histogram-matched already
    data: str | None = None
    dataset: Any = None  # salbench.datasets.Dataset, in place of that of layout and folder
    cache: str | None = None
    out: str | None = None
    items: bytes | list[bytes] | None = None
    split: str | None = None  # "": all items, whatever the configuration takes
    shard: str | None = None  # "2/4"
    reference: Any = None  # a file, "items", or an array
    pictures: str = ""  # at least these: "cached", "computed"
    cached_alone: bool = False  # nothing is computed but shapes and how they look
    keep_going: bool = False
