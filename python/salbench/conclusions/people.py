# SPDX-License-Identifier: GPL-3.0-or-later
"""Human curves [tasse2016]: how well n participants predict n others, the gain from more of them, the number
a model is worth, and the reliability of their ground truth. Comparisons are within meshes, since hard meshes
are hard for any number of people.

Each point of the curve is treated as a model, under a name that no model can have, so that units and shapes
are chosen by the same code.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import pandas

from salbench.conclusions.metrics import Metric
from salbench.conclusions.pairs import compare
from salbench.conclusions.samples import means, summarise
from salbench.conclusions.study import Study
from salbench.conclusions.tables import CI95, METRIC, N, N_SHAPES, Part, count, framed, number, text
from salbench.conclusions.units import Floats, Level, Numbers, Scores

ITEM, CLASS = text("item", "the mesh"), text("class", "of the mesh; empty if it has none")
PARTICIPANTS = count(
    "n", "participants in each of two groups that have none in common: how well one predicts the other"
)

CURVE = (
    PARTICIPANTS,
    METRIC,
    count("n_meshes", "meshes with 2 n participants where the metric is defined"),
    number("mean", "mean over these meshes"),
    number("sd", "standard deviation over them, by n - 1"),
    *CI95,
)

CURVE_BY_MESH = (
    ITEM,
    CLASS,
    PARTICIPANTS,
    METRIC,
    number(
        "value", "score of n participants against n others, the mean over the draws; empty where undefined"
    ),
    number(
        "reliability",
        (
            "of `cc` alone: of the ground truth by 2 n participants, 2 r / (1 + r), r being the value; 0"
            " where r is negative"
        ),
    ),
)

DIFFERENCES = (
    METRIC,
    count("from_participants", "fewer participants"),
    count("to_participants", "more participants"),
    N,
    N_SHAPES,
    number("mean_difference", "mean over the units of more - fewer"),
    *CI95,
    number("t_p", "two-sided p of the paired t-test"),
    number("ci90_low", "90 % interval, lower end"),
    number("ci90_high", "upper end"),
)

RELIABILITY = (
    METRIC,
    N,
    N_SHAPES,
    count("fewest_participants", "of a mesh, both halves together, without people who did not look at it"),
    count("most_participants", "likewise"),
    number("split_half", "mean correlation of two halves"),
    number("mean", "mean reliability of all participants, 2 r / (1 + r)"),
    number("sd", "standard deviation, by n - 1"),
    *CI95,
)


def human_curve(study: Study) -> pandas.DataFrame:
    """A row per number of participants and metric. This and the next four tables need HS."""
    people, metrics = _people(study), study.scores.metrics
    return framed(
        CURVE,
        (
            _cells(rows[metric.name].dropna().to_numpy()[:, None]) | {"n": n, "metric": metric.name}
            for n, rows in people.groupby("n")
            for metric in metrics
        ),
    )


def _cells(values: Floats) -> dict[str, Any]:
    """Statistics of one column, under the names of the tables."""
    n, mean, sd, low, high = summarise(values)
    return {"n_meshes": n, "mean": mean, "sd": sd, "ci95_low": low, "ci95_high": high}


def human_curve_by_mesh(study: Study) -> pandas.DataFrame:
    """A row per mesh, number of participants and metric."""
    people, metrics = _people(study), study.scores.metrics
    names = [metric.name for metric in metrics]
    values = people[names].to_numpy(dtype=float).ravel()
    columns = {name: np.repeat(people[name].to_numpy(), len(names)) for name in ("item", "class", "n")}
    metric = np.tile(np.array(names, dtype=object), len(people))
    return framed(
        CURVE_BY_MESH,
        [
            {
                **columns,
                "metric": metric,
                "value": values,
                "reliability": np.where(metric == "cc", reliability(values), np.nan),
            }
        ],
    )


def reliability(r: Floats) -> Floats:
    """Reliability of the whole from the correlation of its halves [spearman1910] [brown1910]."""
    positive = np.maximum(r, 0)  # NaN stays
    return np.asarray(2 * positive / (1 + positive))


def human_curve_differences(study: Study) -> pandas.DataFrame:
    """A row per metric and pair of group sizes, over the meshes that have both."""
    level, curve = curve_level(study)
    return framed(
        DIFFERENCES,
        (_differences(level, curve, metric) for metric in range(len(level.metrics) if len(curve) > 1 else 0)),
    )


def _differences(level: Level, curve: Numbers, metric: int) -> Part:
    fewer, more = np.triu_indices(len(curve), 1)
    found = level.pairs(
        metric, curve[more], curve[fewer], lambda differences: compare(differences)._asdict(), with_all=False
    )
    return dict(found) | {
        "metric": level.metrics[metric].name,
        "from_participants": fewer + 1,
        "to_participants": more + 1,
    }


def human_reliability(study: Study) -> pandas.DataFrame:
    """One row, for the metric cc, by the largest groups of each mesh; none without this metric."""
    people = _people(study)
    if "cc" not in people:
        return framed(RELIABILITY, [])
    known = people.dropna(subset=["cc"])
    last = known[~known["item"].duplicated(keep="last")]  # the largest groups of each mesh
    if study.unit == "class":
        last = last[last["class"] != ""]
    r = last["cc"].to_numpy(dtype=float)
    halves = Scores(
        _as_models(last, pandas.DataFrame({"cc": r, "reliability": reliability(r)}), "people"),
        (Metric("cc"), Metric("reliability")),
        study.scores.first_of,
    )
    level = Level(halves, "meshes", study.unit)
    if not level.models:
        return framed(RELIABILITY, [])
    scores = level.averaged(1, [0])
    return framed(
        RELIABILITY,
        [
            _cells(scores.values)
            | {
                "metric": "cc",
                "n": scores.n,
                "n_shapes": scores.n_shapes,
                "fewest_participants": 2 * last["n"].min(),
                "most_participants": 2 * last["n"].max(),
                "split_half": means(level.averaged(0, [0]).values),
            }
        ],
    )


def curve_level(study: Study, beside: pandas.DataFrame | None = None) -> tuple[Level, Numbers]:
    """Returns the scores `beside`, if any, followed by the curve, one model per number of participants; and
    their numbers.

    Units may exclude meshes, and with them their curves.
    """
    people = _people(study)
    names = [metric.name for metric in study.scores.metrics]
    curves = _as_models(people, people[names], people["n"].astype(str) + " participants")
    rows = curves if beside is None else pandas.concat([beside, curves], ignore_index=True)
    level = Level(replace(study.scores, frame=rows), "meshes", study.unit)
    places = (level.find(f"{n} participants") for n in range(1, int(people["n"].max()) + 1))
    return level, np.array([place for place in places if place is not None], dtype=np.intp)


def _as_models(
    meshes: pandas.DataFrame, values: pandas.DataFrame, model: "str | pandas.Series"
) -> pandas.DataFrame:
    """Converts to rows of scores."""
    texts = meshes[["item", "class"]].assign(dataset="meshes", split="", view="", model=model)
    return pandas.concat([texts.reset_index(drop=True), values.reset_index(drop=True)], axis=1)


def _people(study: Study) -> pandas.DataFrame:
    if study.people is None:
        raise LookupError("no human curves")
    return study.people
