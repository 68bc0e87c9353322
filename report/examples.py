"""Galleries of painted pictures: the paper's examples."""

from report.results import Missing

HOW = "No export with pictures was given: salbench pictures and salbench export make one (see --help of scripts/report)."


def meshes(shop):
    raise Missing(HOW)


matching = scans = meshes


def difficult(shop, dataset, metric):
    raise Missing(HOW)
