# SPDX-License-Identifier: GPL-3.0-or-later
"""What objects are made of: plain content, attributes, state that lies deeper; without looking into the parts."""

import collections
import copyreg
import dataclasses
import functools
import gc
import importlib
import importlib.machinery
import inspect
import struct
import sys
import types
import typing
import weakref
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from salbench._names import Origin, Unwalkable

ATOMS: dict[type, Callable[[Any], Any]] = {
    type(None): lambda value: b"", type(...): lambda value: b"", type(NotImplemented): lambda value: b"",
    bool: lambda value: b"1" if value else b"0", bytes: lambda value: value,
    int: lambda value: value.to_bytes(value.bit_length() // 8 + 1, "little", signed=True),
    float: lambda value: struct.pack("<d", value), complex: lambda value: struct.pack("<dd", value.real, value.imag),
    str: lambda value: value.encode("utf-8", "surrogatepass"),
}
ATOM_TAGS = {kind: kind.__name__.encode() for kind in ATOMS}

# Equal ones may be one object or several, as the compiler likes: they get no number.
UNNUMBERED = {tuple, frozenset, types.CodeType, Origin}

# Whoever calls these may read anything.
OPAQUE = {id(value): name for name, value in {
    "eval()": eval, "exec()": exec, "globals()": globals, "__import__()": __import__, "sys.modules": sys.modules,
    "importlib.import_module()": importlib.import_module, "sys._getframe()": sys._getframe,
    "inspect.currentframe()": inspect.currentframe, "inspect.stack()": inspect.stack, "gc.get_objects()": gc.get_objects,
}.items()}

# Objects that are made of these attributes.
ATTRIBUTES: dict[type, tuple[str, ...]] = {
    types.MethodType: ("__func__", "__self__"), staticmethod: ("__func__",), classmethod: ("__func__",),
    property: ("fget", "fset", "fdel"), functools.cached_property: ("func",), functools.singledispatchmethod: ("dispatcher", "func"),
    dataclasses.Field: ("name", "default", "default_factory", "metadata"),
    types.MethodWrapperType: ("__name__", "__self__"),
    typing.NewType: ("__name__", "__supertype__"), typing.TypeVar: ("__name__", "__bound__", "__constraints__"),
    **dict.fromkeys((types.WrapperDescriptorType, types.MethodDescriptorType, types.ClassMethodDescriptorType,
                     types.GetSetDescriptorType, types.MemberDescriptorType), ("__name__", "__objclass__")),
}

# Likewise, of packages whose own state has addresses in it, or a generator that runs.
OF_PACKAGES: dict[str, tuple[str, ...]] = {
    "scipy.spatial._ckdtree.cKDTree": ("data", "leafsize", "boxsize", "indices"),
    "contextlib._GeneratorContextManager": ("func", "args", "kwds"), "contextlib._AsyncGeneratorContextManager": ("func", "args", "kwds"),
}

# Content of a user's class over one of these, whatever methods it overrides.
CONTENT: dict[type, Any] = {
    list: lambda value: list(list.__iter__(value)), dict: lambda value: list(dict.items(value)),
    collections.OrderedDict: lambda value: list(collections.OrderedDict.items(value)),
    **{kind: vars(kind)["__getnewargs__"] for kind in (tuple, str, bytes, int, float, complex)},
}

# Names that say nothing about what a class or a module does, or that are made of its other names.
CLASS_SKIPPED = {"__dict__", "__weakref__", "__module__", "__qualname__", "__annotations__", "__annotate__",
                 "__annotate_func__", "__annotations_cache__", "__dataclass_params__", "__abstractmethods__", "_abc_impl",
                 "__slotnames__", "__static_attributes__", "__firstlineno__", "__orig_bases__", "__parameters__",
                 "__type_params__", "_value2member_map_"}
MODULE_SKIPPED = {"__builtins__", "__cached__", "__doc__", "__file__", "__loader__", "__name__", "__package__",
                  "__path__", "__spec__", "__annotations__", "__warningregistry__"}
CACHES_OF_DISPATCH = {"dispatch_cache", "cache_token"}  # in closures of functools.singledispatch, beside its registry
_WRAPPER = {*functools.WRAPPER_ASSIGNMENTS, "__wrapped__", "cache_parameters"}  # in the attributes of functools.cache


def sorted_names(names: Mapping[Any, Any], skipped: Iterable[str] = ()) -> list[tuple[Any, Any]]:
    """A namespace, in the order of its names."""
    texts = sorted(name for name in names if isinstance(name, str) and name not in skipped)
    return [(f".{name}", names[name]) for name in texts] + [
        ("other", entry) for entry in names.items() if not isinstance(entry[0], str)]


def of_function(function: Any) -> list[tuple[Any, Any]]:
    """The attributes of a function, without what empties the cache of functools.singledispatch: wrappers hand it on."""
    names = {name: value for name, value in vars(function).items() if getattr(value, "__func__", None) is not weakref.WeakKeyDictionary.clear}
    return sorted_names(names, () if isinstance(function, types.FunctionType) else _WRAPPER)


def attributes(value: Any) -> list[tuple[Any, Any]]:
    """Those of an instance and of its slots, whatever its class says about them."""
    names: dict[Any, Any] = {}
    for name in ("__dict__", *copyreg._slotnames(type(value))):  # type: ignore[attr-defined]
        try:
            held = object.__getattribute__(value, name)
        except AttributeError:
            continue
        names.update(held if name == "__dict__" else {name: held})
    return sorted_names(names)


@functools.lru_cache(10_000)
def is_plain(kind: type) -> bool:
    """True if instances hold nothing but attributes: pickle tells it the same way."""
    pointers = len(copyreg._slotnames(kind)) + (kind.__dictoffset__ > 0) + (kind.__weakrefoffset__ > 0)  # type: ignore
    return kind.__itemsize__ == 0 and kind.__basicsize__ <= object.__basicsize__ + pointers * struct.calcsize("P")


@functools.lru_cache(10_000)
def names_of_package(kind: type) -> tuple[str, ...]:
    """The attributes in OF_PACKAGES of a class, or of its bases; () if there are none."""
    return next((names for base in kind.__mro__ if (names := OF_PACKAGES.get(f"{base.__module__}.{base.__qualname__}"))), ())


def has_own_state(kind: type) -> bool:
    """True if a class says by itself what the state of an instance is, or OF_PACKAGES does."""
    return bool(names_of_package(kind)) or any(getattr(kind, name, None) is not getattr(object, name, None)
               for name in ("__reduce_ex__", "__reduce__", "__getstate__", "__getnewargs__", "__getnewargs_ex__"))


def extension_file(module: Any) -> str | None:
    file = getattr(module, "__file__", None)
    return file if isinstance(file, str) and file.endswith(tuple(importlib.machinery.EXTENSION_SUFFIXES)) else None


def no_content(value: Any) -> Unwalkable:
    kind = type(value)
    return Unwalkable(f"a {kind.__qualname__} ({kind.__module__}) has no content that could be compared")


def place(labels: list[Any], what: str) -> str:
    """Where an object was met: "net.layers[3].lock: what"."""
    text = ""
    for label in labels:
        if isinstance(label, str):
            text += label if label.startswith(".") or not text else f" > {label}"
        elif isinstance(label, int):
            text += f"[{label}]"
        elif label and type(label[0]) in (str, int):
            text += f"[{label[0]!r:.40}]"
    return f"{text}: {what}" if text else what
