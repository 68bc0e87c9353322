# SPDX-License-Identifier: GPL-3.0-or-later
"""Registry of data sets: public ones by name, layouts that C++ lists, and user files."""

from __future__ import annotations

import contextlib
import functools
import json
import os
import sys
import traceback
import types
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Any

from salbench import _core
from salbench.datasets.files import CLOUDS, MESHES, extension, is_name, kind_of, match, read_file
from salbench.datasets.records import Item, Listing, Shape, shape_of
from salbench.system.errors import InputError, Interrupted, StorageError, UnreadableError, quoted
from salbench.system.workers import Question, is_of_the_system

_PACKAGE = os.path.dirname(os.path.dirname(os.path.abspath(__file__))) + os.sep
SETS = {  # layout -> file in this folder
    "3dva": "threedva",
    "3dvisa": "threedvisa",
    "alexiou": "alexiou",
    "eyenavgs": "eyenavgs",
    "gs": "gs",
    "meshmamba": "meshmamba",
    "meshmamba_textured": "meshmamba_textured",
    "princeton": "princeton",
    "sal3d": "sal3d",
    "sal3d_meshes": "sal3d_meshes",
    "sal3d_spread": "sal3d_spread",
    "saliency3d": "saliency3d",
    "texmeshsaliency": "texmeshsaliency",
    "zaragoza": "zaragoza",
}
AUTOMATIC, FORM = "automatic", "hdf5"
NATIVE = {  # layouts that C++ lists, and the authors' terms
    AUTOMATIC: "",
    "folder": "not known; ask whoever made the files",
    FORM: "each item's file says on what terms its source is given",
    "schelling": "not known; cite the study, and ask its authors before you pass the data on",
}
LAYOUTS = tuple(sorted({*SETS, *NATIVE}))
_MOST_BYTES = 1 << 20  # limit for a Python file


class Dataset:
    """A user-defined data set: a function that lists items, and one that reads an item.

    Parameters
    ----------
    items : list of Item, or function of a folder
        The function returns such a list, or a `Listing`, for the folder of the data set.
    read : function of an Item, optional
        Returns a `salbench.datasets.Shape`. It is called by several threads, never by two at once. Without
        it, items name a mesh, values per vertex and picks, which salbench reads itself.
    name : str
        Used in tables, and in the keys of shapes.
    version : int, optional
        From 1. Your promise that `read` returns the same for the same files and version: keys then depend
        only on it, the items and the contents of their files. By default they depend on the code and values
        of the function.
    licence : str
        Terms of the data; copied into imported files.
    root : path, optional
        Argument of `items`.

    Examples
    --------
    >>> import numpy
    >>> from salbench.datasets import Dataset, Item, Shape
    >>> points = numpy.eye(4, 3)
    >>> faces = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]
    >>> wedges = Dataset([Item("wedge")], lambda item: Shape(points, faces, ground_truth=points[:, 2]), name="wedges")
    >>> [item.name for item in wedges.items().items]
    ['wedge']
    """

    def __init__(
        self,
        items: Sequence[Item] | Callable[[str], Any],
        read: Callable[[Item], Shape] | None = None,
        *,
        name: str = "own",
        version: int | None = None,
        licence: str = "",
        root: str | os.PathLike[str] = "",
    ) -> None:
        if read is not None and not callable(read):
            raise ValueError(f"read must be a function of an Item, not {read!r:.100}")
        if version is not None and not (isinstance(version, int) and 1 <= version <= 2**31 - 1):
            raise ValueError(f"version must be a whole number from 1 to 2**31 - 1, not {version!r:.100}")
        self.name, self.licence, self.root = name, licence, os.fspath(root)
        self.version = (version or 1) if read is not None else 0
        self.layout = ""  # the name or the file by which another process finds it
        # Identity of `read` for keys; None: its code and values, computed when needed (runs/hooks.py).
        self.key = name if version is not None or read is None else None
        self._items, self.function = items, read

    @property
    def has_read(self) -> bool:
        return self.function is not None

    def key_of(self, item: Item) -> str:
        """Key of an item's shape, apart from the contents of its files."""
        assert self.key is not None
        return json.dumps([self.key, item.name, item.view, item.info], sort_keys=True)

    def question(self, function: str, items: Sequence[Item], *arguments: Any) -> Question:
        """Question to another process, which reads files of these items: `function(layout, *arguments)`."""
        paths = [path for item in items for path in item.paths]
        return Question(
            function,
            (self.layout or self.name, *arguments),
            items[0].place,
            paths,
            program=self.layout if is_file(self.layout) else "",
        )

    def items(self, root: str | os.PathLike[str] = "") -> Listing:
        """Items of a folder, each with its kind. Throws InputError."""
        listing: Listing = self._called(
            self._listing_of, os.fspath(root) or self.root, self.layout or self.name
        )
        if not listing.items:
            place = os.fspath(root) or self.root
            if place and not os.path.exists(place):
                raise InputError(f"{place}: there is no such folder")
            raise InputError(
                f"{self.layout or self.name}: items() found none in {os.fspath(root) or 'its list'}"
            )
        names: set[str] = set()
        for item in listing.items:
            self._settle(item)
            if item.name in names:
                raise InputError(f"{self.name}: two items are called {quoted(item.name)}: rename one of them")
            names.add(item.name)
        return listing

    def _listing_of(self, root: str) -> Listing:
        found = self._items(root) if callable(self._items) else self._items
        return found if isinstance(found, Listing) else Listing([*found])

    def _settle(self, item: Item) -> None:
        """Converts paths to texts, and determines the kind."""
        if not isinstance(item, Item):
            raise InputError(f"{self.name}: items() returned {item!r:.60}, expected salbench.datasets.Item")
        for word, what in (
            (item.name, "name"),
            (item.view, "view"),
            (item.category, "category"),
            (item.split, "split"),
        ):
            if not isinstance(word, str):
                raise InputError(f"{self.name}: the {what} of an item is {word!r:.60}, expected a text")
        if not is_name(item.name) or {"/", "\0"} & {*item.view}:
            raise InputError(
                f"{self.name}: an item is called {quoted(item.name)}: expected what a file can be called"
            )
        item.files = [os.fspath(path) for path in item.files]
        item.saliency, item.picks = os.fspath(item.saliency), [os.fspath(path) for path in item.picks]
        if self.function is None:
            item.truth = bool(item.saliency or item.picks)
        elif not item.kind:
            item.kind = kind_of(item.files[0]) if item.files else "mesh"

    def read(self, item: Item) -> Shape:
        """The shape of an item. Throws InputError for any exception of the data set's function."""
        if item.problem:
            raise InputError(item.problem)
        if self.function is None:
            return shape_of(_core.native_shape(item))
        shape = self._called(self.function, item, item.place)
        if not isinstance(shape, Shape):
            raise InputError(f"{item.place}: read() returned {shape!r:.60}, expected salbench.datasets.Shape")
        return shape

    def _called(self, function: Callable[[Any], Any], argument: Any, place: str) -> Any:
        """Calls a function of the data set. Throws InputError for its exceptions, except those that say
        nothing about the data set."""
        try:
            return function(argument)
        except MemoryError:
            raise UnreadableError(
                f"{place}: no memory for what its files hold; leave it out, or work on fewer items at a time"
            ) from None
        except (InputError, Interrupted):
            raise
        except (Exception, SystemExit) as error:
            # a defect of salbench, or no fault of the file
            if self.layout in SETS or is_of_the_system(error):
                raise
            raise InputError(
                f"{place}: {'read' if function is self.function else 'items'}() raised {_line_of(error)}"
            ) from None


def _line_of(error: BaseException) -> str:
    """One line, such as "ValueError: ... (mine.py, line 12)"."""
    frames = traceback.extract_tb(error.__traceback__)
    # the user's own frame, not the helper that it called
    own = [frame for frame in frames if not frame.filename.startswith(_PACKAGE)] or frames
    place = f" ({own[-1].filename}, line {own[-1].lineno})" if own else ""
    return f"{type(error).__name__}: {' '.join(str(error).split())}{place}"


# --- by name ------------------------------------------------------------------------------------------------


def is_file(layout: str) -> bool:
    """True if the layout is a user's Python file."""
    return os.path.splitext(layout)[1].lower() == ".py"


def find(layout: str) -> Dataset:
    """Returns the data set of this name, or in this Python file. Throws InputError."""
    if layout in SETS:
        return _of_module(import_module(f"salbench.datasets.{SETS[layout]}"), layout, layout)
    if layout == FORM:
        from salbench.datasets import one_form

        dataset = Dataset([], one_form.read_item, name=FORM, version=1)
        dataset.layout = FORM
        return dataset
    if layout in NATIVE:
        return Dataset([], name=layout, licence=NATIVE[layout])
    if is_file(layout):
        return _of_file(layout, read_file(layout, _MOST_BYTES))
    raise _no_layout(layout)


def require_layout(layout: str) -> None:
    """Throws InputError for an unknown layout."""
    if layout not in LAYOUTS and not is_file(layout):
        raise _no_layout(layout)


def _no_layout(layout: str) -> InputError:
    refuse_description(layout)
    hint = _core.did_you_mean(
        os.fsencode(layout), list(LAYOUTS), "name one of docs/data_sets.md, or a file NAME.py"
    )
    return InputError(f"there is no layout '{layout}'; {hint}")


def refuse_description(layout: str) -> None:
    """Throws InputError for data set descriptions of 1.x."""
    if os.path.splitext(layout)[1].lower() in (".yaml", ".yml"):
        raise InputError(
            f"{layout}: data sets are no longer described in YAML: write a file of Python in its place"
            " (docs/upgrading.md shows how); if it is a configuration, name the layout in it"
        )


@functools.lru_cache(maxsize=64)
def _of_file(path: str, text: bytes) -> Dataset:
    """Loads a file again if it was edited during a session."""
    module, name = _loaded(path, text), os.path.splitext(os.path.basename(path))[0]
    dataset = _of_module(module, path, name)
    if not hasattr(module, "VERSION"):
        dataset.key = f"{name}, file {_core.xxh128(text)}"
    return dataset


def _of_module(module: Any, layout: str, name: str) -> Dataset:
    try:
        dataset = Dataset(
            module.items,
            getattr(module, "read", None),
            name=name,
            version=getattr(module, "VERSION", None),
            licence=getattr(module, "LICENCE", ""),
        )
    except ValueError as error:
        raise InputError(f"{layout}: {error}") from None
    dataset.layout = layout if layout in SETS else os.path.abspath(layout)
    return dataset


def _loaded(path: str, text: bytes) -> Any:
    """The module of a user's file, which may import modules beside it."""
    module = types.ModuleType(f"salbench_data_set_{_core.xxh128(os.fsencode(os.path.abspath(path)))}")
    module.__file__ = path
    sys.modules[module.__name__] = module  # dataclasses look up their names there
    folder = os.path.dirname(os.path.abspath(path))
    sys.path.insert(0, folder)
    try:
        exec(compile(text, path, "exec"), module.__dict__)
    except SyntaxError as error:
        raise InputError(f"{error.filename or path}:{error.lineno}: {error.msg}") from None
    except (Exception, SystemExit) as error:
        raise InputError(f"{path}: cannot be imported: {_line_of(error)}") from None
    finally:
        sys.path.remove(folder)
    if not callable(getattr(module, "items", None)):
        raise InputError(
            f"{path}: has no function items(root): expected one, and read(item) (docs/data_sets.md)"
        )
    return module


def read_of(layout: str, item: Item, key: str = "") -> Shape:
    """`find(layout).read(item)`, for another process. key: of the data set that listed the item; its file may
    have changed since."""
    dataset = find(layout)
    if key and dataset.key != key:
        raise StorageError(f"{layout}: was changed while it was in use: run it again")
    return dataset.read(item)


# --- of a folder --------------------------------------------------------------------------------------------


def listed(layout: str, root: str) -> tuple[Dataset, Listing]:
    """Returns the data set of a layout (for "automatic", the matching one) and its listing of a folder."""
    try:
        return _listed(layout, root)
    except InputError as error:
        others = layouts_that_fit(root) or shapes_in_sub_folders(root) if "; looked in " in str(error) else ""
        if not others:
            raise
        raise InputError(f"{error}{others}") from None


def _listed(layout: str, root: str) -> tuple[Dataset, Listing]:
    if layout == AUTOMATIC:
        layout = _core.automatic_layout(os.fsencode(root))
    if layout not in NATIVE:
        dataset = find(layout)
        return dataset, dataset.items(os.path.normpath(root) if root else root)
    _, fields = _core.native_listing(os.fsencode(layout), os.fsencode(root))
    rows = fields.pop("items")
    listing = Listing([Item(**row) for row in rows], **fields)
    if layout == FORM:
        listing.read.append(os.path.join(root, "index.csv"))
        return find(FORM), listing
    return Dataset(listing.items, name=layout, licence=NATIVE[layout]), listing


def layouts_that_fit(root: str) -> str:
    """End of a message about a folder without shapes in its layout: the layouts that do find shapes there.
    Reads no shape."""
    fit = []
    for layout in LAYOUTS:
        with contextlib.suppress(InputError, OSError):
            if layout != AUTOMATIC and _listed(layout, root)[1].items:
                fit.append(layout)
    return (
        f"; {'the layout that fits' if len(fit) == 1 else 'layouts that fit'}: {', '.join(fit)}"
        if fit
        else ""
    )


def shapes_in_sub_folders(root: str) -> str:
    """End of the same message if no layout fits: sub-folders with shapes, and how to read them."""
    with contextlib.suppress(InputError, OSError):
        shapes = [one.path for one in match(root, "*/*") if extension(one.path) in (*MESHES, *CLOUDS)]
        if folders := [*dict.fromkeys(os.path.basename(os.path.dirname(path)) for path in shapes)]:
            named = ", ".join(folders[:3]) + (f" and {len(folders) - 3} others" if folders[3:] else "")
            return (
                f"; there are some in the sub-folders {named}: read them by a file of your own, with match(root,"
                f' "*/{{item}}{extension(shapes[0])}") (docs/data_sets.md)'
            )
    return ""


def chosen(listing: Listing, items: str | list[str] | None, split: str = "") -> list[Item]:
    """Items selected by the user: "1-20,52", "scored" for those with ground truth, or a list of names; None:
    all. split "": all splits."""
    if items == []:
        return []
    if items == "":
        raise InputError("items names no item")
    wanted = (
        [*map(os.fsencode, items)]
        if isinstance(items, list)
        else None
        if items is None
        else os.fsencode(items)
    )
    return [listing.items[number] for number in _core.chosen_items(listing, wanted, os.fsencode(split))]
