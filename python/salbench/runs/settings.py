# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of a run for the compiled part. Arguments and configurations are converted early: paths are
checked here, and a configuration in memory becomes text, so that errors name a line or a key."""

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from salbench import _core
from salbench.shapes.reference import reference_of
from salbench.system.errors import InputError
from salbench.system.files import path_of, require_folder
from salbench.system.names import names_of
from salbench.system.yaml import flow_text

if TYPE_CHECKING:
    from salbench.models.function import Function, Model, Predict


@dataclass(frozen=True)
class Settings:
    """None: the configuration's value, or the default."""

    # Configuration file, its name, or run.yaml of a run, whose items, reference and maps are the defaults
    path: str | None = None
    yaml: str | None = None  # in place of a path
    models: str | None = None  # YAML, in place of those of the configuration
    kept: str | None = None  # models of the configuration to keep, such as "LS,PS"; "": people and chance
    # folders of maps by model, as for `salbench run --maps`
    maps: Mapping[str, str] = field(default_factory=dict)
    matched: bool = False  # values of these maps are already histogram-matched
    data: str | None = None
    dataset: Any = None  # salbench.datasets.Dataset, in place of layout and folder
    cache: str | None = None
    out: str | None = None
    items: bytes | list[bytes] | None = None
    split: str | None = None  # "": all items, whatever the configuration says
    shard: str | None = None  # "2/4"
    reference: Any = None  # "items", or a density over 100 bins
    pictures: str = ""  # minimum: "cached", "computed"
    cached_alone: bool = False  # computes only shapes and their rendering
    keep_going: bool = False
    # the caller's models, by name
    functions: "Mapping[str, Predict | Model]" = field(default_factory=dict)

    @property
    def own_models(self) -> "list[Function]":
        """The functions as the compiled part takes them."""
        from salbench.models.function import Function

        return [Function.of(name, given) for name, given in self.functions.items()]

    def protocol(self) -> dict[str, Any]:
        """The sections of the configuration, with their defaults."""
        import yaml

        made: dict[str, Any] = yaml.safe_load(
            _core.protocol(self.path or "") if self.yaml is None else _core.protocol(self.yaml, "config")
        )
        return made


def settings_of(
    config: Any,
    data: Any,
    models: Any,
    cache: Any,
    out: Any,
    items: Any,
    split: str | None,
    reference: Any,
    keep_going: bool = False,
) -> Settings:
    """Settings from arguments of `run`."""
    from salbench.datasets import Dataset
    from salbench.datasets.dataset import Dataset as Shapes
    from salbench.models.function import Model

    if isinstance(data, Shapes):
        made_of = f"data={data._root!r}, its folder" if data._root else "the data set that it was made from"
        raise ValueError(f"data: give {made_of}, in place of {data!r:.100}")
    dataset, data = (data, data.root or ".") if isinstance(data, Dataset) else (None, data)
    data, cache, out = (
        given if given is None else path_of(given, name)
        for name, given in (("data", data), ("cache", cache), ("out", out))
    )
    if data is not None:
        require_folder(data)
    if models is not None and not isinstance(models, Mapping):
        raise ValueError(f"models must be a dict by name, such as {_models_of(models)}, not {models!r:.100}")
    functions = {
        name: given for name, given in (models or {}).items() if callable(given) or isinstance(given, Model)
    }
    others = (
        None
        if models is None
        else {name: {} if given is None else given for name, given in models.items() if name not in functions}
    )
    settings = Settings(
        path=None if isinstance(config, Mapping) else _name_of(config),
        yaml=_text_of(config, "config") if isinstance(config, Mapping) else None,
        models=None if others is None else _text_of(others, "models"),
        functions=functions,
        data=data,
        dataset=dataset,
        cache=cache,
        out=out,
        split=split,
        keep_going=bool(keep_going),
        reference=reference_of(reference),
        items=(
            items
            if items is None
            else (
                os.fsencode(items)
                if isinstance(items, str)
                else [os.fsencode(name) for name in names_of(items)]
            )
        ),
    )
    if items is not None and not settings.items:
        raise ValueError("items is empty: name some, or leave it out to run all")
    return settings


def _models_of(given: Any) -> str:
    """Message that guesses the intention of a caller who gave names, or one function, in place of a dict."""
    names = [given] if isinstance(given, str) or not isinstance(given, Iterable) else list(given)
    entries = [
        f"{getattr(name, '__name__', name)!r}: {'{}' if isinstance(name, str) else 'function'}"
        for name in names[:3]
    ]
    return "{" + (", ".join(entries) or "'LS': {}") + "}"


def can_be_listed(layout: str, configured: str) -> bool:
    """False for the layout of a data set of functions; `configured` is a layout, "automatic" or a file."""
    from salbench.datasets import sets

    return layout in sets.LAYOUTS or sets.is_file(configured)


def _text_of(config: Mapping[str, Any], name: str) -> str:
    """Text of a configuration in memory. name: of the argument."""
    import numpy

    def plain(value: Any) -> Any:
        if isinstance(value, os.PathLike):
            return os.fspath(value)
        if isinstance(value, (numpy.generic, numpy.ndarray)):
            return value.tolist()
        raise InputError(f"{name}: a {type(value).__name__} is neither a text, a number, a list nor a dict")

    try:
        return flow_text(config, default=plain)
    except RecursionError:
        raise InputError(f"{name}: is nested too deeply") from None
    except TypeError as error:  # for a key
        raise InputError(f"{name}: {error}") from None


def _name_of(config: object) -> str:
    """Display name of a configuration: its file, or its name in the program."""
    if config is None:
        return "shrec07"
    if not isinstance(config, (str, os.PathLike)):
        raise ValueError(f"config must be a file, a name or a dict, not {config!r:.100}")
    return path_of(config, "config")
