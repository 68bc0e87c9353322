"""What the paper's text claims, beside our figures."""

from report.results import Missing


def table(shop):
    raise Missing("not yet")
