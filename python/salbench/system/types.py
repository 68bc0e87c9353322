# SPDX-License-Identifier: GPL-3.0-or-later
"""Types of arrays that `help()` shows as one word; NumPy spells them out over many lines."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray
else:
    import numpy as np

    ArrayLike = type(
        "array_like", (), {"__module__": "builtins", "__doc__": "An array, or what NumPy makes one of."}
    )

    class NDArray:
        """Subscripted like NumPy's."""

        def __class_getitem__(cls, item):
            return np.ndarray


__all__ = ["ArrayLike", "NDArray"]
