# SPDX-License-Identifier: GPL-3.0-or-later
"""What the program's models are: one line of each, for docstrings, tables and pages."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Model:
    name: str
    authors: str = ""
    year: str = ""
    link: str = ""
    key: str = ""  # in docs/bibliography.bib
    values: str = ""  # what the map has, behind the name

    @property
    def source(self) -> str:
        return f"{self.authors} {self.year}".strip()

    @property
    def summary(self) -> str:
        return f"{self.name}{self.values}."


_CVF = "https://openaccess.thecvf.com/"
_DOI = "https://doi.org/"

MODELS = {
    "LS": Model("Saliency of large point sets", "Shtrom, Leifman, Tal", "2013",
                f"{_CVF}content_iccv_2013/html/Shtrom_Saliency_Detection_in_2013_ICCV_paper.html", "shtrom2013",
                ": what differs at two scales from all that resembles it, or is near to it; >= 0"),
    "CS": Model("Cluster-based point set saliency", "Tasse, Kosinka, Dodgson", "2015",
                f"{_CVF}content_iccv_2015/html/Tasse_Cluster-Based_Point_Set_ICCV_2015_paper.html", "tasse2015",
                ": clusters that are unlike their surroundings; 0 to 1"),
    "PS": Model("Saliency by principal components", "Tasse, Kosinka, Dodgson", "2016", f"{_DOI}10.1145/3005358.3005380", "tasse2016",
                ": the descriptor along the direction in which descriptors vary most"),
    "MS": Model("Mesh saliency by spectral processing", "Song, Liu, Martin, Rosin", "2014", f"{_DOI}10.1145/2530691", "song2014",
                ": irregularities of the log-Laplacian spectrum; logarithms"),
    "HS": Model("Human performance: the marks of one participant, scored against those of all others"),
    "RS": Model("Chance: a random number per point", key="tasse2016", values=", uniform in [0, 1)"),
    "MC": Model("Magnitude of the mean curvature", "Meyer, Desbrun, Schröder, Barr", "2003", f"{_DOI}10.1007/978-3-662-05105-4_2", "meyer2003",
                ", in 1 / R"),
    "LVJ": Model("Mesh saliency", "Lee, Varshney, Jacobs", "2005", f"{_DOI}10.1145/1073204.1073244", "lee2005",
                 ": mean curvature against that of a wider surrounding; >= 0"),
    "LCE": Model("Local curvature entropy", "Limper, Kuijper, Fellner", "2016", f"{_DOI}10.2312/egsh.20161003", "limper2016", ", in bits"),
    "CB": Model("Centre bias: the distance from the centroid", "after Tatler", "2007", f"{_DOI}10.1167/7.14.4", "tatler2007", ", in R"),
    "VIS": Model("Visibility: how much of the half space above a point sees it", values="; 0 to 1"),
    "NV": Model("Variation of the normals around a point", values=": one minus the mean dot product of its normal with theirs; 0 to 2"),
    "VD": Model("Number of edges at a vertex", values="; it knows the meshing alone"),
    "SD": Model("Sampling density: how closely points lie", values=", in points per R²: one over the area of a vertex, or of the disc that holds "
                "the nearest points where there are no faces; it knows the sampling alone"),
    "constant": Model("The same value at every point"),
}
