# SPDX-License-Identifier: GPL-3.0-or-later
"""One function per metric of the program's tables, named like its column.

Each takes the arguments of `salbench.score` except `metrics`, and returns only the score.

>>> from salbench import metrics
>>> metrics.auc_exact([0.1, 0.9, 0.4, 0.2], picks=[1])
1.0
>>> round(metrics.cc([0.1, 0.9, 0.4, 0.2], ground_truth=[0, 1, 0.5, 0]), 6)
0.978232
"""

from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from salbench import _core
from salbench.shapes.scoring import score
from salbench.shapes.shape import Shape
from salbench.system.names import Rows
from salbench.system.types import ArrayLike


class Metric(NamedTuple):
    """A row of the table of metrics."""

    name: str
    unit: str
    help: str
    higher_is_better: bool
    label: str
    low: float  # theoretical range
    high: float


def table() -> Rows[Metric]:
    """All metrics, in the order of the tables: a list, whose `frame()` is a data frame.

    >>> from salbench import metrics
    >>> metrics.table()[0].name, metrics.table().frame().loc["kl", "unit"]
    ('auc', 'nats')
    """
    return Rows(Metric(*row) for row in _core.metric_rows())


class MetricFunction(Protocol):
    """Signature of the functions of this module; they return a float, or an array for several maps."""

    def __call__(
        self,
        prediction: ArrayLike,
        ground_truth: ArrayLike | Shape | None = None,
        picks: Any = None,
        **keywords: Any,
    ) -> Any:
        ...


def _function(row: Metric) -> MetricFunction:
    def metric(
        prediction: ArrayLike,
        ground_truth: ArrayLike | Shape | None = None,
        picks: Any = None,
        **keywords: Any,
    ) -> Any:
        return score(prediction, ground_truth, picks, metrics=row.name, **keywords)[row.name]

    metric.__name__ = metric.__qualname__ = row.name
    metric.__doc__ = f"{row.help}\n\nUnit: {row.unit or 'none'}. Arguments as of `salbench.score`."
    return metric


_functions = {row.name: _function(row) for row in table()}
globals().update(_functions)
__all__ = ["Metric", "MetricFunction", "table", *_functions]


def __dir__() -> list[str]:
    return sorted(__all__)


if TYPE_CHECKING:

    def __getattr__(name: str) -> MetricFunction:
        ...
