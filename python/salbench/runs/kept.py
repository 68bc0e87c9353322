# SPDX-License-Identifier: GPL-3.0-or-later
"""Storage of trained models, including nested functions, lambdas and classes of scripts. Loading a file runs
code."""

import io
import pathlib
import pickle
import pickletools
import sys
import types
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, cast

from salbench.models.fingerprint import distribution_of, is_own
from salbench.models.function import Predict
from salbench.system.files import replace_file


@dataclass(frozen=True)
class Kept:
    """Two files per fold, named by the digest of its dependencies: the pickled model, and the seconds of its
    training as text."""

    folder: pathlib.Path
    keys: Sequence[str]

    def path(self, fold: int) -> pathlib.Path:
        return self.folder / f"{self.keys[fold]}.pickle"

    def load(self, fold: int) -> Predict | None:
        """Returns a fold; None if it is not stored."""
        try:
            with open(self.path(fold), "rb") as file:
                return cast(Predict, pickle.load(file))
        except FileNotFoundError:
            return None
        except Exception as error:
            raise ValueError(
                f"{self.path(fold)}: cannot be loaded: {error}; remove it to have the fold trained again"
            ) from error

    def seconds(self, fold: int) -> float | None:
        """Returns the seconds of training; None if they are not stored."""
        try:
            return float(self._seconds_path(fold).read_bytes())
        except (OSError, ValueError):
            return None

    def store(self, fold: int, predict: Predict, seconds: float) -> None:
        """Stores a fold. Raises the exceptions of pickle."""
        data = pickled(predict)
        self.folder.mkdir(parents=True, exist_ok=True)
        replace_file(self._seconds_path(fold), str(seconds).encode())
        replace_file(self.path(fold), data)

    def _seconds_path(self, fold: int) -> pathlib.Path:
        return self.path(fold).with_suffix(".seconds")


def pickled(predict: Any) -> bytes:
    """Pickles a model with the code of the user's own modules. A network that cannot be pickled is stored as
    its class and its `state_dict`, and rebuilt by calling the class without arguments."""
    try:
        import cloudpickle
    except ImportError:
        try:
            return pickle.dumps(predict)
        except Exception as error:
            raise ValueError(
                f"{error}; cloudpickle, which stores functions within functions, is not installed"
            ) from error

    class WithNetworks(cloudpickle.CloudPickler):  # type: ignore[misc]
        def reducer_override(self, value: Any) -> Any:
            if _is_network(type(value)):
                return _network, (type(value), value.state_dict(), getattr(value, "training", None))
            return super().reducer_override(value)

    with _own_modules_by_value(cloudpickle):
        try:
            return cast(bytes, cloudpickle.dumps(predict))
        except Exception as error:
            made = io.BytesIO()
            try:
                WithNetworks(made).dump(predict)
                pickle.loads(made.getvalue())  # a class may need arguments
            except Exception:
                raise error from None
            return made.getvalue()


def packages_in(data: bytes) -> list[str]:
    """Installed packages that a pickle names, such as "numpy==1.24.2"."""
    names = {word.partition(".")[0] for _, word, _ in pickletools.genops(data) if isinstance(word, str)}
    return sorted(filter(None, {distribution_of(name) for name in names if name in sys.modules}))


def _is_network(kind: type) -> bool:
    return all(callable(getattr(kind, name, None)) for name in ("state_dict", "load_state_dict"))


def _network(kind: Any, state: Any, training: bool | None) -> Any:
    made = kind()
    made.load_state_dict(state)
    if training is not None:
        made.train(training)
    return made


@contextmanager
def _own_modules_by_value(cloudpickle: types.ModuleType) -> Iterator[None]:
    """Pickles the user's modules by value: elsewhere they are missing, or differ."""
    before = cloudpickle.list_registry_pickle_by_value()
    own = [
        module
        for name, module in list(sys.modules.items())
        if isinstance(module, types.ModuleType)
        and module.__name__ == name
        and name not in before
        and is_own(module)
    ]
    for module in own:
        cloudpickle.register_pickle_by_value(module)
    try:
        yield
    finally:
        for module in own:
            cloudpickle.unregister_pickle_by_value(module)
