# SPDX-License-Identifier: GPL-3.0-or-later
"""Types of arrays, for annotations. Importing this loads no NumPy."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Ints = NDArray[np.signedinteger[Any]]
    Bools = NDArray[np.bool_]
else:
    Floats = Ints = Bools = Any
