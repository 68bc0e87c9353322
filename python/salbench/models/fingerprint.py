# SPDX-License-Identifier: GPL-3.0-or-later
"""Digest of a function and everything it depends on, equal in every interpreter: the cache key of its maps.

Python's pickler writes plain values and tuples. It writes every other object as a number, and the object's
content, also a tuple, once after that, so cycles end and nesting is unlimited. The user's functions count by
bytecode, constants, defaults, closure and the globals that they name; modules by the attributes that code
reads; classes and objects by attributes; arrays by type, shape and values. Python and installed packages
count by version. File names, line numbers and annotations do not count. Files, the environment and clocks
that a function reads when it is called cannot be seen.
"""

import collections
import copyreg
import ctypes
import dataclasses
import dis
import functools
import gc
import hashlib
import importlib.machinery
import importlib.metadata
import importlib.util
import inspect
import itertools
import os
import pathlib
import pickle
import sys
import sysconfig
import types
import typing
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, NoReturn

import numpy as np

from salbench import _core
from salbench.datasets.dataset import Dataset

Content = tuple[Any, ...]  # named values are pairs (name, value): messages use the names

MAX_OBJECTS = 10_000_000  # an array is one object
STDLIB = {pathlib.Path(sysconfig.get_path(name)).resolve() for name in ("stdlib", "platstdlib")}
SALBENCH = pathlib.Path(__file__).resolve().parent.parent
# pickle writes them by value
PLAIN = {type(None), bool, int, float, complex, str, bytes, tuple, type(...), type(NotImplemented)}
READS = ("LOAD_ATTR", "LOAD_METHOD")

# Code that names one of these may read anything, so it is refused.
OPAQUE = {
    id(sys.modules): "sys.modules",
    **{
        id(value): f"{value.__name__}()"
        for value in (
            eval,
            exec,
            globals,
            __import__,
            importlib.import_module,
            sys._getframe,
            inspect.currentframe,
            inspect.stack,
            gc.get_objects,
        )
    },
}

# Names in classes, modules and functions that say nothing about what these do, or repeat their other names.
SKIPPED = {
    *functools.WRAPPER_ASSIGNMENTS,
    *vars(types.ModuleType("")),
    "__abstractmethods__",
    "__annotate__",
    "__annotate_func__",
    "__annotations_cache__",
    "__builtins__",
    "__cached__",
    "__dataclass_params__",
    "__dict__",
    "__file__",
    "__firstlineno__",
    "__orig_bases__",
    "__parameters__",
    "__path__",
    "__slotnames__",
    "__static_attributes__",
    "__type_params__",
    "__warningregistry__",
    "__weakref__",
    "_abc_impl",
    "_clear_cache",
    "_value2member_map_",
} - {"__doc__"}


class Unwalkable(Exception):
    """Raised for values without comparable content; the message gives the value and its location."""


def fingerprint(value: Any) -> str:
    """Hexadecimal digest of an object and its dependencies. Raises Unwalkable."""
    key = _Key()
    try:
        return key.digest(value).hex()
    except Unwalkable as error:
        raise Unwalkable(f"{key.place()}{error}") from None
    except Exception as error:  # from the user's code: methods for pickle, imported modules
        raise Unwalkable(f"{key.place()}{type(error).__name__}: {error}") from None


def file_digest(path: str | os.PathLike[str]) -> str:
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


class _Key(pickle.Pickler):
    def __init__(self, outer: "_Key | None" = None) -> None:
        self._hash = hashlib.sha256()
        super().__init__(types.SimpleNamespace(write=self._hash.update), protocol=4)
        self.fast = True  # no memo: whether equal strings are one object varies between interpreters
        # address to (number, object); the reference keeps the address in use
        self._numbers: dict[int, tuple[int, Any]] = outer._numbers if outer else {}
        self._count: Iterator[int] = outer._count if outer else itertools.count(1)
        # (object, place) of content still to be written
        self._waiting: collections.deque[tuple[Any, Any]] = collections.deque()
        # (place of the owner, name in the owner) of the object being written; None for the root
        self._place: Any = None
        self._label = ""  # last string written: the name of the next value

    def digest(self, value: Any) -> bytes:
        self.dump(value)
        while self._waiting:
            value, self._place = self._waiting.popleft()
            self._label = ""
            self.dump(self._content(value))
        return self._hash.digest()

    def persistent_id(self, value: Any) -> Any:
        """Returns the number of an object, the content of one that the interpreter may share, or None:
        pickle writes the value."""
        kind = type(value)
        if next(self._count) > MAX_OBJECTS:
            raise Unwalkable(f"there are more than {MAX_OBJECTS:,} objects; arrays would be one each")
        if kind in PLAIN:
            self._label = value if kind is str else self._label
            return None
        if id(value) in OPAQUE:
            raise Unwalkable(f"{OPAQUE[id(value)]} may read anything")
        if kind is types.CodeType or kind is frozenset or issubclass(kind, np.dtype):
            return self._content(value)
        if id(value) not in self._numbers:
            self._numbers[id(value)] = len(self._numbers), value
            self._waiting.append((value, (self._place, self._label)))
        return self._numbers[id(value)][0]

    def place(self) -> str:
        """Path to the value being written: "net.layers.lock: "."""
        labels, place = [self._label], self._place
        while place:
            place, label = place
            labels.append(label)
        text = ".".join(label for label in reversed(labels) if label)
        return f"{text:.200}: " if text else ""

    def _content(self, value: Any) -> Content:
        kind = type(value)
        if issubclass(kind, (set, frozenset)):
            base: Any = set if issubclass(kind, set) else frozenset
            return (
                base.__name__.encode(),
                *sorted(map(self._apart, base.__iter__(value))),
                *(() if kind is base else _state(value)),
            )
        base = kind if kind in HELD else next(base for base in kind.__mro__ if base in RULES)
        return base.__name__.encode(), *(HELD if kind in HELD else RULES)[base](value)

    def _apart(self, value: Any) -> bytes:
        """Digest of an element of a set. Its numbers are freed, so digests do not depend on the order of
        elements."""
        before = len(self._numbers)
        digest = _Key(self).digest(value)
        while len(self._numbers) > before:
            self._numbers.popitem()
        return digest


# --- Packages


@functools.lru_cache(10_000)
def _package(name: str, path: str | None) -> Content:
    """Package and version of a module; the file's digest for a user's compiled module; () for a user's
    source file."""
    top = name.partition(".")[0]
    python = ("package", "python", sys.version.partition(" ")[0])
    if path is None or top == "__main__":
        return python if top in {*sys.builtin_module_names, *sys.stdlib_module_names} - {"__main__"} else ()
    folders = {*pathlib.Path(path).parents, *pathlib.Path(path).resolve().parents}
    if SALBENCH in folders:
        return "package", "salbench", _core.version
    if any(folder.name in ("site-packages", "dist-packages") for folder in folders):
        if version := _version(top):
            return "package", top, version
    elif STDLIB & folders:
        return python
    return (
        ("compiled", name, file_digest(path))
        if path.endswith(tuple(importlib.machinery.EXTENSION_SUFFIXES))
        else ()
    )


@functools.cache
def _version(top: str) -> str | None:
    """Version of the distribution that provides a module, which is not imported."""
    try:
        return importlib.metadata.version(top)
    except importlib.metadata.PackageNotFoundError:
        names = importlib.metadata.packages_distributions().get(top)  # such as Pillow for PIL
        return (
            importlib.metadata.version(names[0])
            if names
            else getattr(sys.modules.get(top), "__version__", None)
        )


def _package_of(names: Mapping[str, Any]) -> Content:
    """Package of a module, given its namespace."""
    return _package(
        str(names.get("__name__", "__main__")),
        names.get("__file__") or next(iter(names.get("__path__", ())), None),
    )


def is_own(module: types.ModuleType) -> bool:
    """True for a module that is the user's source file."""
    return bool(getattr(module, "__file__", None)) and not _package_of(vars(module))


def distribution_of(top: str) -> str:
    """Requirement such as "numpy==1.24.2" for an installed module; "" for one of Python, of salbench or of
    the user."""
    module = sys.modules[top]
    if (
        top == "salbench"
        or (package := _package_of(vars(module)))[:1] != ("package",)
        or package[1] == "python"
    ):
        return ""
    names = importlib.metadata.packages_distributions().get(top) or [top]
    return f"{names[0]}=={package[2]}"


def _package_of_class(kind: type) -> Content:
    module = sys.modules.get(kind.__module__) if isinstance(kind.__module__, str) else None
    return _package_of(vars(module)) if module else ()


def _resolved(module: str, name: str) -> Any:
    """Value of a qualified name such as "Class.method" in a module, or None."""
    return functools.reduce(
        lambda found, part: getattr(found, part, None), name.split("."), sys.modules.get(module)
    )


# --- Code


@functools.lru_cache(10_000)
def _names_in(
    code: types.CodeType,
) -> tuple[frozenset[tuple[str, ...]], frozenset[tuple[int, str, tuple[str, ...]]]]:
    """Globals that code names, each with the attributes read from it, as ("helper", "f"); and imports as
    (level, module, names)."""
    chains, imports = set(), set()
    steps = [step for step in dis.get_instructions(code) if step.opname != "EXTENDED_ARG"]
    for at, step in enumerate(steps):
        if step.opname == "IMPORT_NAME":
            imports.add((steps[at - 2].argval, step.argval, tuple(steps[at - 1].argval or ())))
        elif (
            step.opcode in dis.hasname
            and step.opname.startswith("LOAD_")
            and step.opname not in (*READS, "LOAD_SUPER_ATTR")
        ):
            chains.add(
                (
                    step.argval,
                    *(
                        read.argval
                        for read in itertools.takewhile(lambda read: read.opname in READS, steps[at + 1 :])
                    ),
                )
            )
    inner = [_names_in(constant) for constant in code.co_consts if isinstance(constant, types.CodeType)]
    return frozenset(chains).union(*(names for names, _ in inner)), frozenset(imports).union(
        *(names for _, names in inner)
    )


def _follow(chain: tuple[str, ...], function: types.FunctionType) -> Content:
    """Name and value of a global, or of an attribute if the global is a module."""
    names = collections.ChainMap(function.__globals__, getattr(function, "__builtins__"))
    if chain[0] not in names:
        return (chain[0],)
    value, at = names[chain[0]], 1
    package: Content = ()
    while isinstance(value, types.ModuleType) and at < len(chain):
        try:  # getattr: a module may import its attributes lazily
            value, package, at = getattr(value, chain[at]), _package_of(vars(value)), at + 1
        except Exception:  # also from the module's own __getattr__; the function itself will raise it
            break
    by_content = (type, types.FunctionType, types.ModuleType, list, dict, np.ndarray, *PLAIN)
    if (
        package
        and id(value) not in OPAQUE
        and not isinstance(value, by_content)
        and _package_of_class(type(value))
    ):
        value = package  # state of an installed package does not count
    return ".".join(chain[:at]), value


def _imported(package: str, level: int, module: str, names: tuple[str, ...]) -> list[Content]:
    """Names and values of an import within a function. Installed packages are not imported, since that may
    take seconds."""
    full = importlib.util.resolve_name("." * level + module, package)
    spec = importlib.util.find_spec(full.partition(".")[0])
    if spec and (
        installed := _package(
            full,
            spec.origin if spec.has_location else next(iter(spec.submodule_search_locations or []), None),
        )
    ):
        return [(full, *names, installed)]
    found = importlib.import_module(full)
    return [
        (name, getattr(found, name) if hasattr(found, name) else importlib.import_module(f"{full}.{name}"))
        for name in names
    ] or [(full, found)]


def _function(function: types.FunctionType) -> Content:
    names = function.__globals__
    # in closures of singledispatch
    caches = ("dispatch_cache", "cache_token") if names is vars(functools) else ()
    closure = [
        pair
        for pair in zip(function.__code__.co_freevars, function.__closure__ or ())
        if pair[0] not in caches
    ]
    parts = [
        ("default", function.__defaults__),
        ("keyword default", function.__kwdefaults__),
        *closure,
        *_sorted(vars(function)),
    ]
    if package := _package_of(names):
        is_whole = _resolved(names["__name__"], function.__qualname__) is function
        return package, names["__name__"], function.__qualname__, *(() if is_whole else parts)
    chains, imports = _names_in(function.__code__)
    imported = [_imported(str(names.get("__package__") or ""), *wanted) for wanted in sorted(imports)]
    return function.__code__, *parts, *(_follow(chain, function) for chain in sorted(chains)), *imported


def _builtin(function: Any) -> Content:
    is_of_module = function.__self__ is None or type(function.__self__).__name__ == "PyCapsule"  # pybind11
    return function.__name__, (
        sys.modules.get(function.__module__ or "builtins") if is_of_module else function.__self__
    )


def _module(module: types.ModuleType) -> Content:
    """A module that is used as a value counts with all of its names."""
    package = _package_of(vars(module))
    return (package, module.__name__) if package else tuple(_sorted(vars(module), {*SKIPPED, "__doc__"}))


def _class(kind: type) -> Content:
    """A user's class counts with all of its names, an installed class with the functions that the user
    added to it."""
    parts = ("bases", kind.__bases__), ("metaclass", type(kind))
    if package := _package_of_class(kind):
        return (
            *parts,
            package,
            str(kind.__module__),
            kind.__qualname__,
            *(
                pair
                for pair in _sorted(vars(kind))
                if type(pair[1]) is types.FunctionType and not _package_of(pair[1].__globals__)
            ),
        )
    return *parts, *_sorted(vars(kind))


# --- Objects


def _sorted(names: Mapping[Any, Any], skipped: Iterable[str] = SKIPPED) -> list[Content]:
    """Pairs of a namespace, sorted by name."""
    texts = sorted(name for name in names if isinstance(name, str) and name not in skipped)
    return [(name, names[name]) for name in texts] + [
        pair for pair in names.items() if not isinstance(pair[0], str)
    ]


def _state(value: Any) -> Content:
    """Class, attributes and slots of an instance, even if the class hides them."""
    names: dict[Any, Any] = {}
    for name in ("__dict__", *copyreg._slotnames(type(value))):  # type: ignore[attr-defined]
        try:
            held = object.__getattribute__(value, name)
        except AttributeError:
            continue
        names.update(held if name == "__dict__" else {name: held})
    return "class", type(value), *_sorted(names, ())


def _of(*names: str) -> Callable[[Any], Content]:
    """Rule for types whose instances consist of these attributes."""
    return lambda value: (
        *((name, getattr(value, name)) for name in names),
        *(() if _package_of_class(type(value)) else _state(value)),
    )


def _array(array: Any) -> Content:
    """Type, shape, and values in C order, whatever the memory order."""
    plain = array.view(np.ndarray)
    data = (
        np.ascontiguousarray(plain).reshape(-1).view(np.uint8).data
        if plain.nbytes and not plain.dtype.hasobject
        else b""
    )
    values = tuple(plain.ravel().tolist()) if plain.dtype.hasobject else hashlib.sha256(data).digest()
    return (
        plain.dtype,
        plain.shape,
        values,
        *(() if type(array) in (np.ndarray, np.memmap) else _state(array)),
    )


def _instance(value: Any) -> Content:
    """Class and attributes; for installed classes and bases, the state that they give to pickle."""
    kind = type(value)
    package = _package_of_class(kind)
    for name, held in vars(sys.modules[kind.__module__]).items() if package else ():
        if held is value:  # global of an installed module, such as os.environ: state of the package
            return package, name
    parts = ("class", kind) if package else _state(value)
    # functions of Cython and nanobind, whose class is in no module that has a file
    made_in = sys.modules.get(getattr(value, "__module__", None) or "")
    if not package and made_in and (compiled := _package_of(vars(made_in)))[:1] == ("compiled",):
        return *parts, compiled, getattr(value, "__qualname__", "")
    if hasattr(kind, "detach") and hasattr(kind, "numpy"):
        tensor = value.detach().cpu()  # PyTorch or an equal interface
        try:
            array = tensor.numpy()
        except TypeError:  # bfloat16 and other types that NumPy lacks fit into float32
            array = tensor.float().numpy()
        return *parts, str(value.dtype), *_array(np.asarray(array))
    base = next(
        base for base in kind.__mro__ if base is object or _package_of_class(base) and not _is_plain(base)
    )
    if package or base not in (object, *HELD):
        return *parts, *_reduced(value)
    return parts if base is object else (*parts, *HELD[base](value))


@functools.lru_cache(10_000)
def _is_plain(kind: type) -> bool:
    """True if instances hold nothing but attributes and slots; pickle uses the same test."""
    pointers = len(copyreg._slotnames(kind)) + (kind.__dictoffset__ > 0) + (kind.__weakrefoffset__ > 0)  # type: ignore[attr-defined]
    return (
        kind.__itemsize__ == 0 and kind.__basicsize__ <= object.__basicsize__ + pointers * tuple.__itemsize__
    )


def _reduced(value: Any) -> Content:
    """Content that pickle would store: the parts that rebuild the object, or its name in a module."""
    kind = type(value)
    for base in kind.__mro__:
        if names := OF_PACKAGES.get(f"{base.__module__}.{base.__qualname__}"):
            return _of(*names)(value)
    try:
        reduced = (
            copyreg.dispatch_table[kind](value) if kind in copyreg.dispatch_table else value.__reduce_ex__(4)
        )
    except TypeError:  # compiled functions, for example
        reduced = getattr(value, "__qualname__", "")
    if not isinstance(reduced, str):
        made_by, arguments, state, items, entries = [*reduced, None, None, None][:5]
        return (
            made_by,
            arguments,
            _sorted(state, ()) if type(state) is dict else state,
            tuple(items or ()),
            tuple(entries or ()),
        )
    module = sys.modules.get(pickle.whichmodule(value, reduced))  # type: ignore[attr-defined]
    if module is None or _resolved(module.__name__, reduced) is not value:
        _refuse(value)
    return reduced, _package_of(vars(module)), module.__name__


def _refuse(value: Any) -> NoReturn:
    raise Unwalkable(
        f"a {type(value).__qualname__} ({type(value).__module__}) has no content that could be compared"
    )


RULES: dict[Any, Callable[[Any], Content]] = {
    types.CodeType: _of(
        "co_code",
        "co_exceptiontable",
        "co_argcount",
        "co_posonlyargcount",
        "co_kwonlyargcount",
        "co_flags",
        "co_names",
        "co_varnames",
        "co_freevars",
        "co_cellvars",
        "co_consts",
    ),
    types.FunctionType: _function,
    types.BuiltinFunctionType: _builtin,
    types.ModuleType: _module,
    type: _class,
    np.ndarray: _array,
    np.dtype: lambda dtype: tuple(dtype.__reduce__()[1:]),
    np.generic: lambda value: (value.dtype, value.item() if value.dtype.hasobject else value.tobytes()),
    memoryview: lambda view: (view.format, view.shape, view.tobytes()),
    **dict.fromkeys(
        (types.CellType, types.MappingProxyType, types.MethodType, type(functools.cmp_to_key(int.__sub__))),
        lambda value: tuple(gc.get_referents(value)),
    ),
    # includes __wrapped__ and cache_parameters
    functools._lru_cache_wrapper: lambda value: tuple(_sorted(vars(value))),
    Dataset: _refuse,
    ctypes.CDLL: _refuse,  # their content is in files
    staticmethod: _of("__func__"),
    classmethod: _of("__func__"),
    property: _of("fget", "fset", "fdel"),
    functools.cached_property: _of("func"),
    functools.singledispatchmethod: _of("dispatcher", "func"),
    dataclasses.Field: _of("name", "default", "default_factory", "metadata"),
    typing.NewType: _of("__name__", "__supertype__"),
    typing.TypeVar: _of("__name__", "__bound__", "__constraints__"),
    object: _instance,
}

# Content of containers and values; for a user's subclass, in addition to its attributes and regardless of
# overridden methods.
HELD: dict[Any, Callable[[Any], Content]] = {
    list: lambda value: tuple(list.__iter__(value)),
    dict: lambda value: tuple(dict.items(value)),
    collections.OrderedDict: lambda value: tuple(collections.OrderedDict.items(value)),
    **{kind: vars(kind)["__getnewargs__"] for kind in (tuple, str, bytes, int, float, complex)},
}

# Classes whose state for pickle contains addresses or a running generator: these attributes count instead.
OF_PACKAGES = {
    "scipy.spatial._ckdtree.cKDTree": ("data", "leafsize", "boxsize", "indices"),
    "contextlib._GeneratorContextManager": ("func", "args", "kwds"),
    "contextlib._AsyncGeneratorContextManager": ("func", "args", "kwds"),
}
