# SPDX-License-Identifier: GPL-3.0-or-later
# Imported by scripts/figures.
"""Figures of README.md: who leads on real data, scores beside the authors', and pictures of the report in
headless Chromium."""

import io
import sys
import tempfile
from pathlib import Path

import pandas as pd

from .common import ROOT, markdown, ran, results, show
from .data_sets import NEARLY_KL, results_of

import salbench
from salbench.conclusions.floors import CEILING, above_floors, role
from salbench.conclusions.tables import of_all

PAGE, PLOT = ROOT / "README.md", ROOT / "docs/leaders.svg"
METRICS, MODELS = ["auc", "nss", "lcc"], ["LS", "CS", "PS", "MS", "RS"]
MODEL, BASELINE = "#0b5fa5", "#8a8a8a"
SETS = (  # protocol, folder of DATA, its metric that leads, name, what its shapes and values are
    ("schelling", "SchellingData", "auc", "Schelling points", "{} meshes: AUC"),
    ("sal3d", "sal3d", "cc", "SAL3D", "{} point clouds: correlation"),
)


def leaders(data, write):
    with tempfile.TemporaryDirectory() as scratch:
        said, parts = "", []
        for protocol, folder, metric, name, shapes in SETS:
            results = salbench.Results(results_of(data, Path(scratch), protocol, folder))
            said += f"- **{name}.** {sentence(results)}\n"
            parts.append((f"{name}, {shapes}", means_of(results, metric)))
        if write:
            PLOT.write_bytes(plotted(parts))
        show(said, PAGE, "leaders", write)


def sentence(results):
    """Names the leader by the leading metric, and the models better than every trivial baseline."""
    leads, _, _ = of_all(results.leaders)["sentence"].iloc[0].partition(" Beside it")
    found = {
        metric: models
        for metric, models in above_floors(of_all(results.significance)).items()
        if metric != NEARLY_KL
    }
    better = [f"{' and '.join(models)} by {metric.upper()}" for metric, models in found.items() if models]
    none = [metric.upper() for metric, models in found.items() if not models]
    rest = f"no model by {' or '.join(none)}" if none else ""
    return f"{leads} Better than every trivial baseline, by paired intervals: {'; '.join(filter(None, [*better, rest]))}."


def means_of(results, metric):
    """A row per model, best first: mean, its 95 % interval, number of shapes."""
    summary = of_all(results.summary)
    # without people: the available files do not assign picks to participants
    known = summary[(summary["metric"] == metric) & (summary["model"] != CEILING) & (summary["n"] > 0)]
    return known.sort_values("mean", ascending=False)


def plotted(parts):
    from matplotlib.figure import Figure
    from salbench.report import style

    style.apply()
    figure = Figure(figsize=(9, 3.4), layout="constrained")
    for axes, (title, rows) in zip(figure.subplots(1, len(parts)), parts):
        colours = [BASELINE if role(model) else MODEL for model in rows["model"]]
        heights = range(len(rows))[::-1]
        axes.hlines(heights, rows["ci95_low"], rows["ci95_high"], colours, linewidth=2)
        axes.scatter(rows["mean"], heights, 36, colours, zorder=3)
        axes.set_yticks(heights, rows["model"])
        for label, colour in zip(axes.get_yticklabels(), colours):
            label.set_color(colour)
        axes.grid(axis="y", visible=False)
        axes.set_title(title.format(int(rows["n_shapes"].max())), loc="left")
    figure.supxlabel("mean and its 95 % interval; grey: trivial baselines, which know nothing of saliency")
    return style.save(figure)[0]


def readme(data, write):
    with tempfile.TemporaryDirectory() as scratch:
        show(beside_published(data, Path(scratch)), PAGE, "readme", write)


def beside_published(data, scratch):
    """A table of means: over the meshes used for fitting parameters, and over those held out."""
    columns = ["item", "model", *METRICS]
    theirs, held_out = (
        pd.read_csv(data / f"reference/{name}.csv", dtype={"item": str}).assign(lcc=lambda of: of["cc"].abs())
        for name in ("published_scores", "held_out_scores")
    )
    at_hand = {path.stem for path in (data / "SchellingData/Distributions").glob("*.val")}
    kept_back = set(held_out["item"]) & at_hand
    theirs = pd.concat([theirs, held_out])[columns]
    theirs = theirs[theirs["item"].isin(at_hand)]
    ran(
        "run",
        ROOT / "configs/shrec07_meshes.yaml",
        data / "SchellingData",
        scratch / "cache",
        *("--items", ",".join(sorted(set(theirs["item"]), key=int)), "--out", scratch / "matched"),
        # histogram of all 400 meshes, used to match the authors' maps
        *("--reference", data / "reference/mean_histograms_meshes.csv"),
    )
    ours = results(scratch / "matched")[columns]
    halves = [
        [
            table[table["item"].isin(kept_back) == is_kept].groupby("model")[METRICS].mean()
            for table in (ours, theirs)
        ]
        for is_kept in (False, True)
    ]
    n_fitted = theirs["item"].nunique() - len(kept_back)
    sizes = (f"{n_fitted} meshes fitted to", f"{len(kept_back)} held out")
    return markdown(
        ["ours / published", *(f"{metric.upper()}, {size}" for size in sizes for metric in METRICS)],
        [
            [
                model,
                *(
                    " / ".join(f"{of.loc[model, metric]:.3f}" if model in of.index else "–" for of in half)
                    for half in halves
                    for metric in METRICS
                ),
            ]
            for model in MODELS
        ],
    )


def pictures(demo, to):
    from PIL import Image, ImageOps
    from selenium.webdriver.common.by import By
    from selenium.webdriver.support.ui import WebDriverWait

    sys.path.insert(0, str(ROOT / "tests/report"))
    import browser as chromium

    report = demo / "out/report"

    def save(png, name, part=None):
        image = Image.open(io.BytesIO(png)).convert("RGB").crop(part)
        ImageOps.expand(image, 16, "white").save(to / name, optimize=True)

    to.mkdir(parents=True, exist_ok=True)
    browser = chromium.start(1280, 1700)
    try:
        browser.get((report / "paper.html").as_uri())
        save(browser.find_element(By.ID, "figure-1").screenshot_as_png, "report_examples.png")
        shapes = report / "shapes"
        browser.get(
            next(
                page for page in (shapes / "lion-head.html", *sorted(shapes.glob("*.html"))) if page.is_file()
            ).as_uri()
        )
        viewer = browser.find_element(By.CSS_SELECTOR, ".viewer")
        WebDriverWait(browser, 60).until(lambda _: viewer.get_attribute("data-ready") == "yes")
        # cut below the first maps
        save(browser.get_screenshot_as_png(), "report_shape.png", (60, 0, 1220, 1150))
    finally:
        browser.quit()
