# SPDX-License-Identifier: GPL-3.0-or-later
"""Style and output of figures: one SVG for the page and one PDF for print, reproducible to the byte."""

from collections.abc import Sequence
from io import BytesIO
from typing import Any

INK = "#1a1a1a"
GRID = "#dddddd"
MAP = "viridis"  # for every saliency and score map: perceptually uniform, safe for colour-blind readers

PRINT_DPI = 300  # for pictures in a PDF, as publishers ask
SCREEN_DPI = 100  # for pictures in an SVG on a page

_SETTINGS = {
    "svg.hashsalt": "salbench",
    "svg.fonttype": "path",
    "pdf.fonttype": 42,  # TrueType: publishers' checks refuse Type 3, Matplotlib's default
    "font.family": "DejaVu Sans",  # comes with Matplotlib, so labels do not depend on the machine
    "font.size": 11,
    "axes.titlesize": 12,
    "axes.labelsize": 11,
    "axes.edgecolor": "#555555",
    "axes.labelcolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": GRID,
    "grid.linewidth": 0.7,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "legend.frameon": False,
    "image.cmap": MAP,
    "savefig.facecolor": "white",
}


def apply() -> None:
    """Selects the backend without windows, and the settings above. Loads Matplotlib here, before forking,
    with everything that drawing processes need."""
    import matplotlib
    import matplotlib.backends.backend_pdf
    import matplotlib.backends.backend_svg
    import matplotlib.figure  # noqa: F401

    matplotlib.rcdefaults()  # undoes the user's matplotlibrc
    matplotlib.use("Agg")
    matplotlib.rcParams.update(_SETTINGS)


def label_ends(
    axes: Any, ends: Sequence[tuple[float, str, Any]], limits: tuple[float, float], height: float
) -> None:
    """Labels every line at its right end: ends are (y, text, colour), limits those of y, height of the axes
    roughly in inches. Labels that would touch are moved apart, with a thin line to the curve."""
    low, high = limits
    ends = sorted(((y - low) / (high - low) if high > low else 0.5, text, colour) for y, text, colour in ends)
    gap = 0.17 / height
    places = spread([at for at, _, _ in ends], gap)
    for (at, text, colour), place in zip(ends, places):
        axes.annotate(
            text,
            (1, at),
            (1.06, place),
            xycoords="axes fraction",
            textcoords="axes fraction",
            fontsize=9,
            color=colour,
            va="center",
            annotation_clip=False,
            arrowprops={"arrowstyle": "-", "color": colour, "lw": 0.7, "shrinkA": 0, "shrinkB": 0},
        )


def spread(places: Sequence[float], gap: float) -> list[float]:
    """Moves ascending positions apart to at least a gap, near their original place and within 0 to 1 if there
    is room."""
    moved: list[float] = []
    for at, place in enumerate(places):
        moved.append(max(place, moved[-1] + gap) if at else place)
    over = max(0.0, moved[-1] - 1) if moved else 0
    for at in range(len(moved) - 1, -1, -1):
        room = 1.0 if at == len(moved) - 1 else moved[at + 1] - gap
        moved[at] = min(moved[at], room) if over else moved[at]
    return moved


def save(figure: Any) -> tuple[bytes, bytes]:
    """Renders the figure as SVG and as PDF, without dates. The layout is computed once; savefig would do it
    twice."""
    from matplotlib.backends.backend_pdf import FigureCanvasPdf
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    if figure.get_layout_engine() is not None:
        figure.draw_without_rendering()
        figure.set_layout_engine("none")
    svg, pdf = BytesIO(), BytesIO()
    FigureCanvasSVG(figure).print_svg(svg, metadata={"Date": None, "Creator": "salbench"})
    figure.dpi = PRINT_DPI
    FigureCanvasPdf(figure).print_pdf(
        pdf, metadata={"CreationDate": None, "Creator": "salbench", "Producer": None}
    )
    return svg.getvalue(), pdf.getvalue()
