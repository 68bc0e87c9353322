# SPDX-License-Identifier: GPL-3.0-or-later
"""A figure of Matplotlib as the list of calls that makes it. Code draws on it as on the figure itself, and nothing is drawn: the
calls and their numbers give a key, so that a figure that shows the same as before is not drawn again, and what is to be drawn
can be, in any process. Where code asks for a number that only the figure knows, the calls so far are made."""

import operator
from collections.abc import Callable, Iterator
from typing import Any

import numpy
import pandas
from numpy.typing import NDArray

from salbench.report.kept import digest


class Part:
    """Stands for what call number `at` of a drawing returns, in calls that follow."""

    def __init__(self, drawing: "Drawing", at: int) -> None:
        object.__setattr__(self, "_drawing", drawing)
        object.__setattr__(self, "_at", at)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):  # what libraries ask of anything that they are given
            raise AttributeError(name)
        return self._drawing.record(getattr, (self, name))

    def __setattr__(self, name: str, value: Any) -> None:
        self._drawing.record(setattr, (self, name, value))

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        return self._drawing.record(None, (self, *arguments), named)

    def __getitem__(self, key: Any) -> Any:
        return self._drawing.record(operator.getitem, (self, key))

    def __iter__(self) -> Iterator[Any]:
        real = self._drawing.real(self)
        if isinstance(real, Iterator):
            raise TypeError("an iterator of a drawing cannot be read: give it to the figure as it is")
        for key, value in (real.items() if isinstance(real, dict) else enumerate(real)):
            yield key if isinstance(real, dict) else value if is_plain(value) else self[key]

    def __len__(self) -> int:
        return len(self._drawing.real(self))

    def __array__(self, *arguments: Any) -> NDArray[Any]:
        return numpy.asarray(self._drawing.real(self), *arguments)


def _asked(name: str) -> Callable[..., Any]:
    def method(self: Part, *others: Any) -> Any:
        real = [self._drawing.real(other) if isinstance(other, Part) else other for other in (self, *others)]
        return getattr(operator, name)(*real)
    return method


for _name in ("add", "sub", "mul", "truediv", "lt", "le", "gt", "ge", "eq", "ne", "neg", "pos", "abs"):
    setattr(Part, f"__{_name}__", _asked(_name))
for _name, _operator in (("radd", operator.add), ("rsub", operator.sub), ("rmul", operator.mul), ("rtruediv", operator.truediv)):
    setattr(Part, f"__{_name}__", lambda self, other, apply=_operator: apply(other, self._drawing.real(self)))
for _type in (float, int, bool):
    setattr(Part, f"__{_type.__name__}__", lambda self, convert=_type: convert(self._drawing.real(self)))
setattr(Part, "__hash__", object.__hash__)


class Drawing(Part):
    """The figure. make: what gives an empty one; size: its width and height, inches."""

    def __init__(self, make: Callable[[], Any], size: tuple[float, float], *further: Any) -> None:
        super().__init__(self, 0)
        for name, value in (("_calls", []), ("_made", []), ("_make", make), ("_size", size), ("_further", further)):
            object.__setattr__(self, name, value)

    def record(self, function: Callable[..., Any] | None, arguments: Any, named: dict[str, Any] | None = None) -> Any:
        self._calls.append((function, frozen(arguments), frozen(named or {})))
        return Part(self, len(self._calls))

    def real(self, part: Part | None = None) -> Any:
        """What a part stands for, or the figure."""
        if not self._made:
            self._made.append(self._make())
        for function, arguments, named in self._calls[len(self._made) - 1:]:
            arguments, named = self._thawed(arguments), self._thawed(named)
            self._made.append(arguments[0](*arguments[1:], **named) if function is None else function(*arguments))
        return self._made[part._at if part is not None else 0]

    def key(self) -> str | None:
        """A digest of all that is drawn; None where some of it has no content that could be told."""
        try:
            return digest(*told((self._size, self._further, [(getattr(function, "__name__", ""), arguments, named)
                                                             for function, arguments, named in self._calls])))
        except TypeError:
            return None

    def get_figwidth(self) -> float:
        return float(self._size[0])

    def subplots(self, nrows: int = 1, ncols: int = 1, *, squeeze: bool = True, **named: Any) -> Any:
        """Axes in an array, as the figure gives them."""
        all_axes = self.record(None, (self.record(getattr, (self, "subplots")), nrows, ncols), {**named, "squeeze": False})
        array = numpy.empty((nrows, ncols), dtype=object)
        for at in numpy.ndindex(nrows, ncols):
            array[at] = all_axes[at]
        if not squeeze:
            return array
        return array.item() if array.size == 1 else array.squeeze()

    def subplot_mosaic(self, mosaic: list[list[str]], **named: Any) -> dict[str, Any]:
        """Axes by their names in a list of lists."""
        made = self.record(None, (self.record(getattr, (self, "subplot_mosaic")), mosaic), named)
        return {name: made[name] for row in mosaic for name in row}

    def _thawed(self, value: Any) -> Any:
        if isinstance(value, Part):
            return self._made[value._at]
        if isinstance(value, Later):
            return value.function(*self._thawed(value.arguments))
        if type(value) in (list, tuple):
            return type(value)(map(self._thawed, value))
        if isinstance(value, numpy.ndarray) and value.dtype == object:
            return numpy.frompyfunc(self._thawed, 1, 1)(value)
        if type(value) is dict:
            return {key: self._thawed(entry) for key, entry in value.items()}
        return value


class Later:
    """An argument that is made when the figure is drawn: function(*arguments). content: what it is told by, in place of the
    arguments."""

    def __init__(self, function: Callable[..., Any], *arguments: Any, content: Any = None) -> None:
        self.function, self.arguments = function, arguments
        self.content = arguments if content is None else content


def is_plain(value: Any) -> bool:
    return value is None or isinstance(value, (str, bytes, bool, int, float, complex, numpy.generic, slice))


def frozen(value: Any) -> Any:
    """A copy that later changes of the caller's arrays do not reach."""
    if isinstance(value, numpy.ndarray):
        return value.copy() if value.dtype != object else numpy.frompyfunc(frozen, 1, 1)(value)
    if isinstance(value, (pandas.Series, pandas.DataFrame, pandas.Index)):
        return value.copy()
    if type(value) is dict:
        return {key: frozen(entry) for key, entry in value.items()}
    if isinstance(value, Part) or is_plain(value):
        return value
    if type(value) in (list, tuple):
        return type(value)(map(frozen, value))
    if isinstance(value, (Iterator, range, type({}.keys()), type({}.values()), type({}.items()))):
        return list(map(frozen, value))
    return value


def told(value: Any) -> Iterator[str | bytes]:
    """Texts and bytes that differ where values differ. TypeError for what has no content that could be told."""
    if isinstance(value, Part):
        yield f"part {value._at}"
    elif isinstance(value, Later):
        yield f"later {value.function.__module__}.{value.function.__qualname__}"
        yield from told(value.content)
    elif is_plain(value):
        yield f"{type(value).__name__} {value!r}"
    elif isinstance(value, numpy.ndarray) and value.dtype != object:
        yield f"{value.dtype.str} {value.shape}"
        yield value.tobytes()
    elif isinstance(value, pandas.DataFrame):
        for name in value:
            yield from told(value[name])
    elif isinstance(value, (pandas.Series, pandas.Index)):
        yield f"{type(value).__name__} {value.name!r}"
        yield from told(value.to_numpy())
        if isinstance(value, pandas.Series):
            yield from told(value.index)
    elif isinstance(value, dict):
        yield f"dict {len(value)}"
        for key, entry in value.items():
            yield from told(key)
            yield from told(entry)
    elif isinstance(value, (list, tuple)) or isinstance(value, numpy.ndarray):
        yield f"{type(value).__name__} {len(value)}"
        for entry in value:
            yield from told(entry)
    else:
        raise TypeError(type(value))
