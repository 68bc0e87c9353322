# SPDX-License-Identifier: GPL-3.0-or-later
"""Names, order and colours of models; names of files and of items."""

import hashlib
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
    return [(0, int(part), "") if part.isdecimal() else (1, 0, part) for part in re.split(r"(\d+)", str(name)) if part]


_DEVICES = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\.|$)", re.IGNORECASE)  # no files on Windows, whatever the extension
_LONGEST = 200  # a file system takes 255 bytes: this leaves room for extensions and for the names of pictures


def _escaped(pattern, text):
    return re.sub(pattern, lambda match: f"+{ord(match[0]):x}+", text)


def file_name(name, with_capitals=True):
    """A file name for any item, one-to-one: every character but letters, digits and ".-_" becomes its code between +, and
    so do a "." at either end and the first letter of a device's name. The end of a long one becomes a digest."""
    text = _escaped(r"[^A-Za-z0-9._-]" if with_capitals else r"[^a-z0-9._-]", str(name))
    text = _escaped(r"^\.|\.$", text) or "+"
    if _DEVICES.match(text):
        text = _escaped("^.", text)
    if len(text) > _LONGEST:
        text = f"{text[:_LONGEST - 33]}~{hashlib.md5(str(name).encode('utf-8', 'surrogatepass')).hexdigest()}"
    return text


def file_names(names):
    """name -> file name, all different also where capitals do not count: on macOS and Windows. In names that would be the
    same there, capitals become their codes."""
    alike = {}
    for name in dict.fromkeys(names):
        alike.setdefault(file_name(name).lower(), []).append(name)
    return {name: file_name(name, with_capitals=len(group) == 1) for group in alike.values() for name in group}


def shape_name(item, view=""):
    """As the program names items: mesh "52", its scan 3 "52_3"."""
    return f"{item}_{view}" if view != "" else str(item)
