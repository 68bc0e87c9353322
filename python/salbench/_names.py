# SPDX-License-Identifier: GPL-3.0-or-later
"""Whose code a function is, and what code names: globals, attributes of modules, imports."""

import dis
import functools
import importlib
import importlib.metadata
import importlib.util
import pathlib
import sys
import sysconfig
import types
from collections.abc import Iterator
from typing import Any, NamedTuple

from salbench import _core

STDLIB = {pathlib.Path(sysconfig.get_path(name)).resolve() for name in ("stdlib", "platstdlib")}
SALBENCH = pathlib.Path(__file__).resolve().parent


class Origin(NamedTuple):
    """What was installed, in place of its content."""

    package: str
    version: str


PYTHON = Origin("python", sys.version.partition(" ")[0])


class Unwalkable(Exception):
    """Something without content that can be compared; the message says what, and where it was met."""


@functools.lru_cache(10_000)
def origin_of(name: str, path: str | None) -> Origin | None:
    """The package that a module of this name and file belongs to; None if it is the user's."""
    top = name.partition(".")[0]
    if top == "__main__":
        return None
    if path is None:
        return PYTHON if top in sys.builtin_module_names or top in sys.stdlib_module_names else None
    folders = {*pathlib.Path(path).parents, *pathlib.Path(path).resolve().parents}
    if SALBENCH in folders:
        return Origin("salbench", _core.version)
    if any(folder.name in ("site-packages", "dist-packages") for folder in folders):
        version = _version(top)
        return None if version is None else Origin(top, version)
    return PYTHON if STDLIB & folders else None


@functools.cache
def _version(top: str) -> str | None:
    """The version of what is installed under the name of a module, without importing it."""
    try:
        return importlib.metadata.version(top)
    except importlib.metadata.PackageNotFoundError:
        pass
    for distribution in importlib.metadata.packages_distributions().get(top, []):  # such as Pillow of PIL
        return importlib.metadata.version(distribution)
    version = getattr(sys.modules.get(top), "__version__", None)
    return version if isinstance(version, str) else None


def of_module(module: types.ModuleType, name: str) -> tuple[Any, ...]:
    """(value,) of a name in a module, () if it has none. What a module imports when it is first asked for it counts before as after."""
    if name not in vars(module) and "__getattr__" in vars(module):
        try:
            return (getattr(module, name),)
        except Exception:  # of its own __getattr__; the code will meet it
            return ()
    return (vars(module)[name],) if name in vars(module) else ()


def resolved(module: str, name: str) -> Any:
    """What has this name in a module, such as "Class.method"; None if nothing has."""
    found: Any = sys.modules.get(module)
    for part in name.split("."):
        found = getattr(found, part, None)
    return found


class Import(NamedTuple):
    level: int
    module: str
    names: tuple[str, ...]


NOT_LOADS = {"LOAD_ATTR", "LOAD_METHOD", "LOAD_SUPER_ATTR", "STORE_ATTR", "DELETE_ATTR", "STORE_NAME", "DELETE_NAME",
             "STORE_GLOBAL", "DELETE_GLOBAL", "IMPORT_FROM", "IMPORT_NAME"}


@functools.lru_cache(10_000)
def names_in(code: types.CodeType) -> tuple[frozenset[tuple[str, ...]], frozenset[Import]]:
    """Globals that code names, with the attributes read of each at once, such as ("helper", "f"); and its imports."""
    chains: set[tuple[str, ...]] = set()
    imports: set[Import] = set()
    steps = [step for step in dis.get_instructions(code) if step.opname != "EXTENDED_ARG"]
    for at, step in enumerate(steps):
        if step.opname == "IMPORT_NAME":
            imports.add(Import(steps[at - 2].argval, step.argval, tuple(steps[at - 1].argval or ())))
        elif step.opcode in dis.hasname and step.opname not in NOT_LOADS:
            chain = [step.argval]
            for after in steps[at + 1:]:
                if after.opname not in ("LOAD_ATTR", "LOAD_METHOD"):
                    break
                chain.append(after.argval)
            chains.add(tuple(chain))
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            inner_chains, inner_imports = names_in(constant)
            chains |= inner_chains
            imports |= inner_imports
    return frozenset(chains), frozenset(imports)


def imported(package: str, wanted: Import) -> Iterator[tuple[str, Any]]:
    """What an import within a function brings: the user's modules or parts of them, and the origin of installed ones."""
    try:
        full = importlib.util.resolve_name("." * wanted.level + wanted.module, package)
        top = full.partition(".")[0]
        if top not in sys.modules:  # to import what is installed may take seconds
            spec = importlib.util.find_spec(top)
            if spec is None:
                raise ModuleNotFoundError("there is no such module")
            origin = origin_of(top, spec.origin if spec.has_location else next(iter(spec.submodule_search_locations or ()), None))
            if origin:
                yield full, origin
                return
        module = importlib.import_module(full)
        if not wanted.names:
            yield full, module
        for name in wanted.names:
            found = vars(module)[name] if name in vars(module) else importlib.import_module(f"{full}.{name}")
            yield f"{full}.{name}", found
    except Exception as error:  # of the user's module, too
        raise Unwalkable(f"import {wanted.module}: {type(error).__name__}: {error}") from None
