"""Tables of all shapes: thousands of rows, so that they stand in a script and the page renders some at a time."""

import json

from report import statistics
from report.names import ALL_METRICS, DATASETS
from report.results import Missing


def rounded(value):
    """Five digits are more than a reader tells apart, and keep the file small; undefined becomes null."""
    return round(float(value), 5) if value == value else None


def page_data(shop, tables):
    """{models, metrics, shapes: [[data set, item, class, view, page]], scores: {metric: [[a value per model] per shape]}}.
    tables: (data set, metric) -> shapes by models."""
    class_of = statistics.classes(shop.results)
    metrics = [metric for metric in ALL_METRICS if any(metric == key[1] for key in tables)]
    shapes, scores = [], {metric: [] for metric in metrics}
    for dataset in DATASETS:
        found = {metric: tables[dataset, metric] for metric in metrics if (dataset, metric) in tables}
        if not found:
            continue
        index = next(iter(found.values())).index
        shapes += [[DATASETS[dataset], item, class_of.get(item, ""), view, shop.page_of(item)] for item, view in index]
        for metric in metrics:
            wide = found.get(metric, next(iter(found.values())) * float("nan")).reindex(index=index, columns=shop.models)
            scores[metric].extend([rounded(value) for value in row] for row in wide.to_numpy())
    if not shapes:
        raise Missing("There are no scores: no shape has ground truth, or none was finished.")
    return {"models": shop.models, "metrics": {metric: ALL_METRICS[metric] for metric in metrics}, "shapes": shapes,
            "scores": scores}


def all_scores(shop):
    columns = shop.results.table("results.csv", "dataset", "item", "class", "view", "model")
    return page_data(shop, {(dataset, metric): statistics.scores(shop.results, dataset, metric)
                            for dataset in statistics.datasets(shop.results) for metric in ALL_METRICS if metric in columns})


def write_page(shop, pages, path, build, sections=(), **values):
    """A page with the table of what `build` gives, and its data as data/NAME.js; where there is none the page says so."""
    try:
        table, missing = build(), ""
    except Missing as reason:
        table, missing = None, str(reason)
    script = f"data/{path.removesuffix('.html')}.js"
    if table:
        text = json.dumps(table, separators=(",", ":"), ensure_ascii=True)
        (shop.out / script).write_text(f"salbench.scores = {text};\n", encoding="utf-8")
    classes = sorted({row[2] for row in table["shapes"]}) if table else []
    sets = list(dict.fromkeys(row[0] for row in table["shapes"])) if table else []
    pages.write(path, "scores.html", missing=missing, table=table, classes=classes, sets=sets, script=script,
                sections=sections, **values)
