# SPDX-License-Identifier: GPL-3.0-or-later
"""A digest of all that a function depends on, the same in every interpreter: what its maps are found by.

Objects are walked in one order: each gives its kind and its plain content, then its parts follow, with their names.
One that was met before gives its number, which ends cycles. Elements of a set are walked each by itself, and their
digests sorted.

What counts: code with its constants, names, defaults and closures; the globals that code names, and attributes of
modules that it names, as far as they are the user's; of installed packages and of Python their version; objects by
class and state, arrays and tensors by type, shape and bytes. What does not: names of files, lines, addresses,
annotations. What cannot be seen: files, the environment and clocks that a function reads when it is called.
"""

import builtins
import copyreg
import functools
import gc
import hashlib
import os
import pickle
import sys
import types
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from salbench._content import (
    ATOM_TAGS, ATOMS, ATTRIBUTES, CACHES_OF_DISPATCH, CLASS_SKIPPED, CONTENT, MODULE_SKIPPED, OPAQUE, UNNUMBERED,
    attributes, extension_file, has_own_state, is_plain, names_of_package, no_content, of_function, place, sorted_names)
from salbench._data import Dataset
from salbench._names import Origin, Unwalkable, imported, names_in, of_module, origin_of, resolved

MAX_OBJECTS = 10_000_000  # 13 s on a busy machine; an array is one object
NO_VALUE = "no value"  # in place of the package of a name that has no value
Parts = Iterable[tuple[Any, Any]]  # labels and values; a text as a label counts, others are for messages


def fingerprint(value: Any) -> str:
    """The digest of an object and of what it depends on, in hexadecimal. Raises Unwalkable."""
    walk = _Walk()
    try:
        walk.visit(value)
    except RecursionError:
        raise Unwalkable("sets are nested too deeply") from None
    return walk.hash.hexdigest()


def file_digest(path: str | os.PathLike[str]) -> str:
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _packed(*texts: bytes) -> bytes:
    return b"".join([b"%d:%b" % (len(text), text) for text in texts])


class _Walk:
    def __init__(self) -> None:
        self.hash = hashlib.sha256()
        self._met: dict[int, tuple[int, Any]] = {}  # by address: number, and the object, which is to stay
        self._objects = 0
        self._origins: dict[int, tuple[Origin | None, Any]] = {}  # likewise, of namespaces
        self._globals: dict[str, dict[int, str]] = {}  # names of the values of a module, by address
        self._exact: dict[type, Callable[[Any], Parts]] = {
            tuple: enumerate, list: enumerate, dict: self._dict, set: self._set, frozenset: self._set,
            types.MappingProxyType: self._dict, types.CodeType: self._code, types.FunctionType: self._function,
            types.BuiltinFunctionType: self._builtin, functools._lru_cache_wrapper: self._cached,
            types.CellType: self._cell, Origin: self._named, type(functools.cmp_to_key(int.__sub__)): self._referents,
        }
        self._kinds: tuple[tuple[Any, Callable[[Any], Parts]], ...] = (
            (tuple(ATTRIBUTES), self._made_of_attributes), (types.ModuleType, self._module),
            (type, self._class), (np.generic, self._scalar), (np.dtype, self._dtype), (np.ndarray, self._array),
            ((set, frozenset), self._set), (object, self._instance),
        )

    def visit(self, root: Any) -> None:
        labels: list[Any] = [None]
        walked = [iter([((), root)])]
        while walked:
            part = next(walked[-1], None)
            if part is None:
                walked.pop()
                labels.pop()
                self.hash.update(_packed(b"end"))
                continue
            labels[-1], value = part
            if type(labels[-1]) is str:
                self.hash.update(_packed(b"name", labels[-1].encode("utf-8", "surrogatepass")))
            try:
                parts = self._open(value)
            except Unwalkable as error:
                raise Unwalkable(place(labels, str(error))) from None
            if parts is not None:
                walked.append(iter(parts))
                labels.append(None)

    def _put(self, *texts: bytes) -> None:
        self.hash.update(_packed(*texts))

    def _open(self, value: Any) -> Parts | None:
        """Hashes what an object is by itself; its parts, or None if it has none."""
        kind = type(value)
        self._objects += 1
        if self._objects > MAX_OBJECTS:
            raise Unwalkable(f"there are more than {MAX_OBJECTS:,} objects; arrays would be one each")
        if kind in ATOMS:
            self._put(ATOM_TAGS[kind], ATOMS[kind](value))
            return None
        if id(value) in OPAQUE:
            raise Unwalkable(f"{OPAQUE[id(value)]} may read anything")
        if kind not in UNNUMBERED:
            if id(value) in self._met:
                self.hash.update(_packed(b"again", b"%d" % self._met[id(value)][0]))
                return None
            self._met[id(value)] = len(self._met), value
        rule = self._exact.get(kind)
        if rule is not None:
            self._put(kind.__name__.encode())
            return rule(value)
        base, rule = next((base, rule) for base, rule in self._kinds if isinstance(value, base))
        self._put(b"a " + getattr(base, "__name__", kind.__name__).encode())
        return rule(value)

    def _origin_of(self, what: Any) -> Origin | None:
        """Of a class, or of the names of a module."""
        names = what
        if isinstance(what, type):
            module = what.__module__
            names = vars(sys.modules[module]) if isinstance(module, str) and module in sys.modules else {}
        if id(names) not in self._origins:
            path = names.get("__file__") or next(iter(names.get("__path__", ())), None)
            self._origins[id(names)] = origin_of(str(names.get("__name__", "__main__")), path), names
        return self._origins[id(names)][0]

    # --- containers

    def _dict(self, values: Any) -> Parts:
        return [part for key, value in values.items() for part in (((), key), ((key,), value))]

    def _set(self, values: Any) -> Parts:
        """The order of elements differs between interpreters, and so would numbers: each by itself."""
        digests = []
        outer, met = self.hash, len(self._met)
        for value in set.__iter__(values) if isinstance(values, set) else frozenset.__iter__(values):
            self.hash = hashlib.sha256()
            self.visit(value)
            digests.append(self.hash.digest())
            while len(self._met) > met:
                self._met.popitem()
        self.hash = outer
        self._put(b"".join(sorted(digests)))
        return [] if type(values) in (set, frozenset) else [("class", type(values)), *attributes(values)]

    # --- code

    def _code(self, code: types.CodeType) -> Parts:
        self._put(code.co_code, code.co_exceptiontable)
        counts = (code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount, code.co_flags)
        names = (code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars)
        return [((), counts), ((), names), ((), code.co_consts)]

    def _function(self, function: types.FunctionType) -> Parts:
        names = function.__globals__
        parts: list[tuple[Any, Any]] = [("default", function.__defaults__), ("keyword default", function.__kwdefaults__)]
        parts += zip(function.__code__.co_freevars, function.__closure__ or ())
        if names is vars(functools):
            parts = [part for part in parts if part[0] not in CACHES_OF_DISPATCH]
        parts += of_function(function)
        origin = self._origin_of(names)
        if origin:
            self._put(function.__qualname__.encode(), str(names["__name__"]).encode())  # convolve of scipy.ndimage, and of scipy.signal
            whole = resolved(names["__name__"], function.__qualname__) is function
            return [("of", origin)] if whole else [("of", origin), *parts]
        chains, imports = names_in(function.__code__)
        for chain in sorted(chains):
            parts.append(self._follow(chain, function))
        for wanted in sorted(imports):
            parts += imported(str(names.get("__package__") or ""), wanted)
        return [("code", function.__code__), *parts]

    def _follow(self, chain: tuple[str, ...], function: types.FunctionType) -> tuple[str, Any]:
        """The value of a global that code names, or of an attribute of a module."""
        unbound = Origin(NO_VALUE, chain[0])
        value = function.__globals__.get(chain[0], getattr(function, "__builtins__").get(chain[0], unbound))
        at, origin = 1, None
        while isinstance(value, types.ModuleType) and at < len(chain) and (found := of_module(value, chain[at])):
            origin = self._origin_of(vars(value))
            (value,) = found
            at += 1
        content = (type, types.FunctionType, types.ModuleType, list, tuple, dict, np.ndarray, *ATOMS)
        if origin and id(value) not in OPAQUE and not isinstance(value, content) and self._origin_of(type(value)):
            value = origin  # state of an installed package
        return ".".join(chain[:at]), value

    def _builtin(self, function: Any) -> Parts:
        owner = function.__self__
        if owner is None or type(owner).__name__ == "PyCapsule":  # pybind11
            owner = sys.modules.get(function.__module__ or "", builtins)
        return [("name", function.__name__), ("of", owner)]

    def _cached(self, function: Any) -> Parts:
        return [("function", function.__wrapped__), ("parameters", function.cache_parameters()), *of_function(function)]

    def _referents(self, value: Any) -> Parts:
        """Of an object that shows its parts to the garbage collector alone."""
        return enumerate(gc.get_referents(value))

    def _cell(self, cell: types.CellType) -> Parts:
        try:
            return [((), cell.cell_contents)]
        except ValueError:  # not bound yet
            return []

    def _module(self, module: types.ModuleType) -> Parts:
        """All of a module: where code names attributes of it, these come here without it."""
        origin = self._origin_of(vars(module))
        if origin:
            return [("name", module.__name__), ("of", origin)]
        file = extension_file(module)
        return [("file", file_digest(file))] if file else sorted_names(vars(module), MODULE_SKIPPED)

    def _named(self, origin: Origin) -> Parts:
        return enumerate(tuple(origin))

    # --- classes

    def _class(self, kind: type) -> Parts:
        """A user's class with all of its names; of an installed one those that the user has put there."""
        names = vars(kind)
        parts: list[tuple[Any, Any]] = [("bases", kind.__bases__), ("metaclass", type(kind))]
        origin = self._origin_of(kind)
        if origin:
            parts += [("name", kind.__qualname__), ("in", str(kind.__module__)), ("of", origin)]
            return parts + [part for part in sorted_names(names)
                            if type(part[1]) is types.FunctionType and not self._origin_of(part[1].__globals__)]
        module = sys.modules.get(kind.__module__)
        return parts + [("module", module)] if extension_file(module) else parts + sorted_names(names, CLASS_SKIPPED)

    def _made_of_attributes(self, value: Any) -> Parts:
        names = next(names for kind, names in ATTRIBUTES.items() if isinstance(value, kind))
        parts = [(name, getattr(value, name)) for name in names]
        return parts if type(value) in ATTRIBUTES else [*parts, ("class", type(value)), *attributes(value)]

    # --- arrays

    def _dtype(self, dtype: Any) -> Parts:
        return [((), dtype.str)] if dtype.names is None else [((), dtype.__reduce__())]

    def _scalar(self, value: np.generic) -> Parts:
        return [((), value.dtype), ((), value.item() if value.dtype.hasobject else value.tobytes())]

    def _array(self, array: Any) -> Parts:
        plain: Any = array.view(np.ndarray)
        parts: list[tuple[Any, Any]] = [((), plain.dtype), ((), plain.shape)]
        if type(array) not in (np.ndarray, np.memmap):
            parts += [("class", type(array)), *attributes(array)]
        if plain.dtype.hasobject:
            return [*parts, ((), plain.ravel().tolist())]
        if plain.flags.c_contiguous:
            self.hash.update(plain.reshape(-1).view(np.uint8).data)
        else:
            for piece in np.nditer(plain, ["external_loop", "buffered", "zerosize_ok"], order="C", buffersize=1 << 16):
                self.hash.update(np.ascontiguousarray(piece).view(np.uint8).data)
        return parts

    def _tensor(self, tensor: Any) -> Parts:
        """PyTorch's, or what looks like one; types that NumPy lacks fit into float32."""
        values = tensor.detach().cpu()
        try:
            array = values.numpy()
        except TypeError:
            array = values.float().numpy()
        return [("class", type(tensor)), ("type", str(tensor.dtype)), ("values", np.asarray(array))]

    # --- other objects

    def _instance(self, value: Any) -> Parts:
        """By class and attributes; what else it holds, as it says to pickle."""
        kind: Any = type(value)
        if isinstance(value, Dataset) or "ctypes" in sys.modules and isinstance(value, sys.modules["ctypes"].CDLL):
            raise no_content(value)  # what they read lies in files
        is_users = self._origin_of(kind) is None
        if not is_users and (name := self._global_name(value)):
            return [("of", self._origin_of(kind)), ("name", name)]
        if hasattr(kind, "detach") and hasattr(kind, "numpy"):
            return [*self._tensor(value), *(attributes(value) if is_users else ())]
        parts = [("class", kind)]
        if is_users or is_plain(kind) and not has_own_state(kind):
            parts += attributes(value)
            if is_plain(kind):
                return parts
            base = next((base for base in kind.__mro__ if self._origin_of(base) and not is_plain(base)), None)
            if base in CONTENT:
                return [*parts, ("content", CONTENT[base](value))]
        return [*parts, *self._reduced(value)]

    def _reduced(self, value: Any) -> Parts:
        kind: Any = type(value)
        if names := names_of_package(kind):
            return [(name, getattr(value, name)) for name in names]
        try:
            reduce = copyreg.dispatch_table.get(kind)
            reduced = reduce(value) if reduce else value.__reduce_ex__(4)
        except TypeError:
            return self._stands_for(value)
        except Exception as error:
            raise Unwalkable(f"{type(error).__name__}: {error}") from None
        if isinstance(reduced, str):
            return self._by_name(value, reduced)
        function, arguments, state, items, entries = [*reduced, None, None, None][:5]
        held = sorted_names(state) if type(state) is dict else [("state", state)]
        return [("made by", function), ("of", arguments), *held,
                ("items", items and list(items)), ("entries", entries and list(entries))]

    def _stands_for(self, value: Any) -> Parts:
        """The content of what pickle refuses: its bytes, its weights, or its name."""
        try:
            view = memoryview(value)
            return [("format", view.format), ("shape", view.shape), ("bytes", view.tobytes())]
        except (TypeError, ValueError):
            pass
        if callable(value):
            return self._by_name(value, getattr(value, "__qualname__", None) or "")
        raise no_content(value)

    def _by_name(self, value: Any, name: str) -> Parts:
        """A function that was compiled, or a single object, of a module."""
        module = sys.modules.get(pickle.whichmodule(value, name))  # type: ignore[attr-defined]
        if module is None or resolved(module.__name__, name) is not value:
            raise no_content(value)
        if self._origin_of(vars(module)) is None and not extension_file(module):
            return [("name", name)]
        return [("name", name), ("of", module)]

    def _global_name(self, value: Any) -> str | None:
        """The name of what an installed module holds by itself, such as the environment: the state is not the user's."""
        module = type(value).__module__
        if module not in self._globals:
            self._globals[module] = {id(held): name for name, held in vars(sys.modules[module]).items()}
        return self._globals[module].get(id(value))
