# SPDX-License-Identifier: GPL-3.0-or-later
"""What is read of an item, in a worker."""

from __future__ import annotations

import math
import os
from typing import Any

import numpy as np

from salbench import _core
from salbench.datasets import sets
from salbench.datasets.records import Item

UNKNOWN = {"points": 0, "faces": 0, "diagonal": 0.0, "has_truth": False, "seen": 0, "low": math.nan, "high": math.nan, "participants": 0,
            "picks": 0, "remark": ""}

Facts = dict[str, Any]


def facts_of(layout: str, root: str, item: Item) -> Facts:
    form = sets.read(layout, root, item)
    points, faces, diagonal, remark = _core.shape_facts(form, os.fsencode(item.name), os.fsencode(sets.shape_file(item)))
    facts = UNKNOWN | {"points": points, "faces": faces, "diagonal": diagonal, "remark": remark}
    for truth in form.truths:
        viewers = 0 if truth.viewers is None else len(truth.viewers)
        facts |= {"has_truth": True, "participants": max(viewers, len(truth.picks)), "picks": sum(map(len, truth.picks)), "seen": points}
        if truth.saliency is not None:
            seen = truth.saliency[~np.isnan(truth.saliency)]
            facts |= {"seen": len(seen), "low": float(seen.min()), "high": float(seen.max())}
    return facts
