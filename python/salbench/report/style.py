# SPDX-License-Identifier: GPL-3.0-or-later
"""How figures look, and how they are written: one SVG for the page and one PDF for print, the same bytes
every time."""

from collections.abc import Sequence
from io import BytesIO
from typing import Any

INK = "#1a1a1a"
GRID = "#dddddd"
MAP = "viridis"  # every saliency and score map: even in lightness, safe for colour-blind readers

PRINT_DPI = 300  # of pictures in a PDF: what publishers ask for

_SETTINGS = {
    "svg.hashsalt": "salbench",
    "svg.fonttype": "path",
    "pdf.fonttype": 42,  # TrueType: the checks of publishers refuse Type 3, which is Matplotlib's default
    "font.family": "DejaVu Sans",  # comes with Matplotlib, so that labels do not depend on the machine
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
    """No window system, and the settings above. Matplotlib is loaded here, where there is something to
    draw, with all that processes which are forked later need of it."""
    import matplotlib
    import matplotlib.backends.backend_pdf
    import matplotlib.backends.backend_svg
    import matplotlib.figure  # noqa: F401

    matplotlib.rcdefaults()  # whatever a matplotlibrc of the user's says
    matplotlib.use("Agg")
    matplotlib.rcParams.update(_SETTINGS)


def label_ends(
    axes: Any, ends: Sequence[tuple[float, str, Any]], limits: tuple[float, float], height: float
) -> None:
    """A name at the right end of every line: ends are (y, text, colour), limits those of y, height of the
    axes about in inches. Names that would touch are moved apart, with a thin line to their own."""
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
    """Ascending places, moved apart to at least a gap, about where they were and within 0 to 1 if there is
    room."""
    moved: list[float] = []
    for at, place in enumerate(places):
        moved.append(max(place, moved[-1] + gap) if at else place)
    over = max(0.0, moved[-1] - 1) if moved else 0
    for at in range(len(moved) - 1, -1, -1):
        room = 1.0 if at == len(moved) - 1 else moved[at + 1] - gap
        moved[at] = min(moved[at], room) if over else moved[at]
    return moved


def save(figure: Any) -> tuple[bytes, bytes]:
    """The figure as SVG and as PDF, without dates. Laid out once, where there is a layout; savefig would
    draw each file twice."""
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
