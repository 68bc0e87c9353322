"""The table of all shapes: thousands of rows, so that they stand in a script and the page renders some at a time."""

import json

from report import statistics
from report.names import ALL_METRICS, DATASETS
from report.results import Missing


def rounded(value):
    """Five digits are more than a reader tells apart, and keep the file small; undefined becomes null."""
    return round(float(value), 5) if value == value else None


def data(shop):
    """{models, metrics, shapes: [[dataset, item, class, view, page]], scores: {metric: [[a value per model] per shape]}}"""
    class_of = statistics.classes(shop.results)
    shapes, scores, metrics = [], {}, []
    columns = shop.results.table("results.csv")
    for dataset in statistics.datasets(shop.results):
        per_metric = {}
        for metric in ALL_METRICS:
            if metric in columns:
                per_metric[metric] = statistics.scores(shop.results, dataset, metric).reindex(columns=shop.models)
        if not per_metric:
            raise Missing("results.csv has no column of a metric that is known here.")
        metrics = list(per_metric)
        index = per_metric[metrics[0]].index
        shapes += [[DATASETS[dataset], item, class_of.get(item, ""), view, shop.page_of(item)] for item, view in index]
        for metric, wide in per_metric.items():
            scores.setdefault(metric, []).extend([rounded(value) for value in row] for row in wide.to_numpy())
    if not shapes:
        raise Missing("results.csv holds no scores: no shape of the run has ground truth, or none was finished.")
    return {"models": shop.models, "metrics": {metric: ALL_METRICS[metric] for metric in metrics}, "shapes": shapes,
            "scores": scores}


def write_page(shop, pages, name="scores"):
    """scores.html and data/scores.js; where there are no scores the page says so."""
    try:
        table, missing = data(shop), ""
    except Missing as reason:
        table, missing = None, str(reason)
    if table:
        text = json.dumps(table, separators=(",", ":"), ensure_ascii=True)
        (shop.out / "data" / "scores.js").write_text(f"salbench.scores = {text};\n", encoding="utf-8")
    classes = sorted({row[2] for row in table["shapes"]}) if table else []
    sets = list(dict.fromkeys(row[0] for row in table["shapes"])) if table else []
    pages.write(f"{name}.html", "scores.html", title="Scores", missing=missing, table=table, classes=classes, sets=sets,
                shapes=shop.pages)
