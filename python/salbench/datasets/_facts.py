# SPDX-License-Identifier: GPL-3.0-or-later
"""What is read of an item, in a worker."""

from __future__ import annotations

import math
import os
from dataclasses import replace
from typing import Any

import numpy as np

from salbench import _core
from salbench.datasets import sets
from salbench.datasets.records import Form, Item

UNKNOWN: dict[str, Any] = {"points": 0, "faces": 0, "diagonal": 0.0, "has_truth": False, "seen": 0, "low": math.nan, "high": math.nan, "participants": 0,
            "picks": 0, "people": [], "notes": [], "remark": ""}
SNAP = 1.0  # degrees: how near to the shape a fixation that misses it counts as snapped

Facts = dict[str, Any]


def facts_of(layout: str, root: str, item: Item) -> Facts:
    form = sets.read(layout, root, item)
    points, faces, diagonal, remark = _core.shape_facts(form, os.fsencode(item.name), os.fsencode(sets.shape_file(item)))
    facts = UNKNOWN | {"points": points, "faces": faces, "diagonal": diagonal, "remark": remark, "notes": form.problems[1:] + form.remarks}
    if form.problems:
        facts["problem"] = form.problems[0]
    for truth in form.truths:
        viewers = 0 if truth.viewers is None else len(truth.viewers)
        facts |= {"has_truth": True, "participants": max(viewers, len(truth.picks)), "picks": sum(map(len, truth.picks)), "seen": points}
        if truth.saliency is not None:
            seen = truth.saliency[~np.isnan(truth.saliency)]
            facts |= {"seen": len(seen), "low": float(seen.min()), "high": float(seen.max())}
    if form.recording is not None:
        people, missed = _gaze_facts(form)
        facts |= {"people": people, "notes": [*form.problems[1:], *form.remarks, *missed]}
    return facts


def _gaze_facts(form: Form) -> tuple[list[Facts], list[str]]:
    """Counts by person, and a line on those whose gaze is nowhere on the shape."""
    if form.faces is None:
        from salbench._shapes import estimate_normals, partial_mesh

        normals = estimate_normals(form.points, viewpoint=form.viewpoint) if form.normals is None else form.normals
        form = replace(form, faces=partial_mesh(form.points, normals), normals=None, viewpoint=None, left_out=None, truths=())
    people, remark = _core.gaze_facts(form, SNAP)
    return people, [remark] if remark else []
