# SPDX-License-Identifier: GPL-3.0-or-later
"""Names, order and colours of models; names of files and of items."""

import re

DATASETS = {"meshes": "Meshes", "scans": "Scans", "clouds": "Point clouds"}

KIND_NAMES = {"meshes": "mesh", "scans": "scan", "clouds": "point cloud"}

MODELS = {
    "LS": "Saliency of large point sets (Shtrom, Leifman, Tal 2013)",
    "CS": "Cluster-based point set saliency (Tasse, Kosinka, Dodgson 2015)",
    "PS": "Principal components of descriptors (Tasse, Kosinka, Dodgson 2016)",
    "MS": "Mesh saliency by spectral processing (Song, Liu, Martin, Rosin 2014)",
    "HS": "Human performance: one participant against the others",
    "RS": "Chance",
}

# Okabe and Ito's colours, which colour-blind readers tell apart. Ground truth is black.
_COLOURS = {"GS": "#000000", "LS": "#0072B2", "CS": "#D55E00", "PS": "#009E73", "MS": "#CC79A7", "HS": "#E69F00",
            "RS": "#767676"}
_OWN = ("#56B4E9", "#8B4513", "#F0E442", "#5E3C99", "#B2DF8A")


def colours(models):
    """model -> colour. Built-in models keep theirs in every figure; others take the remaining ones in order."""
    own = [model for model in models if model not in _COLOURS]
    return {model: _COLOURS.get(model) or _OWN[own.index(model) % len(_OWN)] for model in models}


def dashes(models):
    """model -> line style: models of one's own are dashed, so that a repeated colour still differs."""
    return {model: "-" if model in _COLOURS else "--" for model in models}


def spoken(dataset):
    """The name of a data set within a sentence."""
    return DATASETS.get(dataset, dataset).lower()


def natural(name):
    """Sort key: item 9 stands before item 10."""
    return [(0, int(part), "") if part.isdigit() else (1, 0, part) for part in re.split(r"(\d+)", str(name)) if part]


def file_name(name):
    """A file name for any item, one-to-one: every character but letters, digits and ".-_" becomes its code between +."""
    escaped = re.sub(r"[^A-Za-z0-9._-]", lambda match: f"+{ord(match[0]):x}+", str(name))
    return f"+2e+{escaped[1:]}" if escaped.startswith(".") else escaped


def shape_name(item, view=""):
    """As the program names items: mesh "52", its scan 3 "52_3"."""
    return f"{item}_{view}" if view != "" else str(item)
