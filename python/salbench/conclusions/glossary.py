# SPDX-License-Identifier: GPL-3.0-or-later
"""What the letters of tables stand for: each model with its authors, each metric with what it compares. The one place that says it; pages
show a line of each, and titles everywhere else."""

from collections.abc import Iterable
from dataclasses import dataclass
from math import isinf

from salbench.conclusions.metrics import Metric, label_of, lower_is_better, of_program


@dataclass(frozen=True)
class Model:
    name: str
    authors: str = ""
    year: str = ""
    link: str = ""

    @property
    def source(self) -> str:
        return f"{self.authors} {self.year}".strip()


_CVF = "https://openaccess.thecvf.com/"
_DOI = "https://doi.org/"

MODELS = {
    "LS": Model("Saliency of large point sets", "Shtrom, Leifman, Tal", "2013",
                f"{_CVF}content_iccv_2013/html/Shtrom_Saliency_Detection_in_2013_ICCV_paper.html"),
    "CS": Model("Cluster-based point set saliency", "Tasse, Kosinka, Dodgson", "2015",
                f"{_CVF}content_iccv_2015/html/Tasse_Cluster-Based_Point_Set_ICCV_2015_paper.html"),
    "PS": Model("Saliency by principal components", "Tasse, Kosinka, Dodgson", "2016", f"{_DOI}10.1145/3005358.3005380"),
    "MS": Model("Mesh saliency by spectral processing", "Song, Liu, Martin, Rosin", "2014", f"{_DOI}10.1145/2530691"),
    "HS": Model("Human performance: the marks of one participant, scored against those of all others"),
    "RS": Model("Chance: a random number per point"),
    "MC": Model("Magnitude of the mean curvature", "Meyer, Desbrun, Schröder, Barr", "2003", f"{_DOI}10.1007/978-3-662-05105-4_2"),
    "LVJ": Model("Mesh saliency", "Lee, Varshney, Jacobs", "2005", f"{_DOI}10.1145/1073204.1073244"),
    "LCE": Model("Local curvature entropy", "Limper, Kuijper, Fellner", "2016", f"{_DOI}10.2312/egsh.20161003"),
    "CB": Model("Centre bias: the distance from the centroid", "after Tatler", "2007", f"{_DOI}10.1167/7.14.4"),
    "VIS": Model("Visibility: how much of the half space above a point sees it"),
    "NV": Model("Variation of the normals around a point"),
    "VD": Model("Number of edges at a vertex"),
    "SD": Model("Sampling density: how closely points lie"),
    "constant": Model("The same value at every point"),
}

# In plain words; of other metrics the program's own.
_COMPARES = {
    "auc": "how often a point that people picked lies above one drawn at random; 0.5 is chance",
    "auc_exact": "how often a point that people picked lies above one that nobody picked; 0.5 is chance",
    "nss": "how far picked points lie above the mean of the map, in its standard deviations; 0 is chance",
    "cc": "how far map and ground truth rise and fall together (Pearson's correlation); 0 is chance",
    "lcc": "how far map and ground truth rise and fall together, whichever way (magnitude of the correlation)",
    "spearman": "how far map and ground truth order the points alike (correlation of ranks); 0 is chance",
    "sim": "what map and ground truth share, both as distributions",
}


def compares(name: str) -> str:
    """What a metric compares; empty of a column that is not the program's."""
    from salbench import _core

    of_program = {row[0]: row[2] for row in _core.metric_rows()}
    return _COMPARES.get(name, of_program.get(name, ""))


def range_of(name: str) -> str:
    """The values that a metric can take: "0 to 1"."""
    known = of_program().get(name, Metric(name))
    low, high = ("" if isinf(end) else f"{end:.0f}".replace("-", "−") for end in (known.low, known.high))
    return f"{low} to {high}" if low and high else f"{low} or more" if low else "any number"


def better(name: str) -> str:
    return f"{'lower' if lower_is_better(name) else 'higher'} is better"


def titles(models: Iterable[str], metrics: Iterable[str]) -> dict[str, str]:
    """What stands for a model or a metric in a table -> what it means. models: the program's own; others may have the same letters."""
    found = {name: ", ".join(filter(None, (MODELS[name].name, MODELS[name].source))) for name in models if name in MODELS}
    return found | {label_of(name): f"{compares(name)}; {range_of(name)}, {better(name)}" for name in metrics if compares(name)}
