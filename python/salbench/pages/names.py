# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of data sets, and counts, in words."""

DATASETS = {"meshes": "Meshes", "scans": "Scans", "clouds": "Point clouds"}
KIND_NAMES = {"meshes": "mesh", "scans": "scan", "clouds": "point cloud"}


def spoken(dataset: str) -> str:
    """Name of a data set within a sentence."""
    return DATASETS.get(dataset, dataset).lower()


def several(n: float, name: str) -> str:
    """A count with its noun: "1 mesh", "2 meshes"."""
    n = int(n)
    return f"{n} {name}" if n == 1 else f"{n} {name}es" if name.endswith(("s", "sh")) else f"{n} {name}s"
