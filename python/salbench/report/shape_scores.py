# SPDX-License-Identifier: GPL-3.0-or-later
"""What each shape scored, and its place among all others."""

from salbench.conclusions.units import DATASETS
from salbench.pages.blocks import Missing
from salbench.report import statistics
from salbench.report.exports import Shape
from salbench.report.names import natural
from salbench.report.results import Shown


class Scores:
    """Scores and ranks of all shapes under the leading metrics, looked up by shape: read once for all pages."""

    def __init__(self, results: Shown) -> None:
        self.metrics = results.leading
        self._known: dict[tuple[str, str, str, str], dict[str, tuple[float, float, int]]] = {}
        for dataset in DATASETS:
            for metric, of in self.metrics.items():
                try:
                    wide = statistics.scores(results, dataset, metric)
                except Missing:
                    continue
                ranks, counts = wide.rank(ascending=of.lower, method="min").to_dict("index"), wide.notna().sum().to_dict()
                for (item, view), row in wide.to_dict("index").items():
                    self._known[metric, dataset, item, view] = {model: (value, ranks[item, view][model], counts[model]) for model, value in row.items()}

    def of(self, metric: str, dataset: str, item: str, view: str = "") -> dict[str, tuple[float, float, int]]:
        """model -> (score, rank within the data set, 1 for the best score, number of ranked shapes) of the models that the shape has rows of."""
        return self._known.get((metric, dataset, item, view), {})

    def best(self, metric: str, dataset: str, item: str, view: str = "") -> set[str]:
        """The models with the best score of the shape."""
        return self.metrics[metric].best({model: value for model, (value, _, _) in self.of(metric, dataset, item, view).items()})

    def pieces(self, shape: Shape, model: str, when: str = "") -> list[tuple[str, bool]]:
        """The scores of a map as text, and whether each is the best of the shape. when: of what that picture shows, "before" or "after"
        matching, alone."""
        found = []
        for metric in (name for name, of in self.metrics.items() if when in ("", of.pictured)):
            key = (metric, shape.dataset, shape.item, shape.view)
            value = self.of(*key).get(model, (float("nan"),))[0]
            found.append(("–" if value != value else f"{value:.2f}".replace("-", "−"), model in self.best(*key)))
        return found

    def dataset_of(self, item: str) -> str:
        """Of a mesh or point cloud that has scores."""
        return "clouds" if any(self.of(metric, "clouds", item) for metric in self.metrics) else "meshes"

    def views(self, item: str) -> list[str]:
        return sorted({view for _, dataset, name, view in self._known if (dataset, name) == ("scans", item)}, key=natural)
