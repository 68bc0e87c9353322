# SPDX-License-Identifier: GPL-3.0-or-later
"""Assignment of shapes to folds. The model of a fold is trained on all other folds, so it sees no shape that
it is scored on, nor its views or, by class, its class."""

import csv
import dataclasses
import hashlib
import io
import numbers
from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass

from salbench import _core
from salbench.datasets.records import Item

OWN_FOLDS = "cross-validated"  # prefix of the training description, unless the data set's own split is used


@dataclass(frozen=True)
class Dealing:
    """Assignment of shapes to folds."""

    how: str  # in tables: "cross-validated, 5 folds by class"
    fold_of: Mapping[str, int]  # by name, for shapes that get a map
    training: Sequence[Sequence[str]]  # for each fold, in the order of the data set

    def of(self, readable: Container[str]) -> "Dealing":
        """Restricts training to readable shapes."""
        return dataclasses.replace(
            self, training=[[item for item in names if item in readable] for names in self.training]
        )

    def csv(self) -> str:
        """Table of fold, item and role: "scored" or "trained on"."""
        rows = [(fold, item, "scored") for item, fold in self.fold_of.items()]
        rows += [(fold, item, "trained on") for fold, items in enumerate(self.training) for item in items]
        made = io.StringIO(newline="")
        csv.writer(made, lineterminator="\n").writerows(
            [("fold", "item", "role"), *sorted(rows, key=lambda row: row[0])]
        )
        return made.getvalue()


def dealt(items: Sequence[Item], folds: int, by: str, seed: int) -> Dealing:
    """Distributes classes or meshes over the folds in turn, in an order that depends on seed and names."""
    if by not in ("class", "mesh"):
        raise ValueError(f"by must be class, mesh or split, not {by!r}")
    if by == "class" and (without := [item.name for item in items if not item.category]):
        raise ValueError(
            f"{len(without)} of {len(items)} shapes have no class, such as {without[0]}: take by='mesh'"
        )
    seed = _core.whole_number(seed, "seed", 0, 2**64 - 1)
    classes: dict[str, str] = {}  # class of each mesh; views of a mesh stay together
    for item in items:
        classes.setdefault(item.shape_name, item.category)
    groups = {item.name: classes[item.shape_name] if by == "class" else item.shape_name for item in items}
    order = sorted(
        set(groups.values()),
        key=lambda group: hashlib.sha256(f"{seed}/{group}".encode("utf-8", "surrogateescape")).digest(),
    )
    if not isinstance(folds, numbers.Integral) or not 2 <= folds <= len(order):
        raise ValueError(
            f"folds must be 2 to {len(order)}, the number of {'classes' if by == 'class' else 'meshes'} with"
            f" ground truth, not {folds!r}"
        )
    number_of = {group: place % folds for place, group in enumerate(order)}
    fold_of = {name: number_of[group] for name, group in groups.items()}
    how = f"{OWN_FOLDS}, {folds} folds by {by}" + (f", seed {seed}" if seed else "")
    return Dealing(
        how, fold_of, [[name for name, own in fold_of.items() if own != fold] for fold in range(folds)]
    )


def in_split(items: Sequence[Item], split: str) -> Dealing:
    """Trains only on items of other splits, since a shape may be in several."""
    splits = {item.name: item.split.split("+") for item in items if item.split}
    scored = [item for item in items if split in splits.get(item.name, ())]
    training = [item for item in items if item.name in splits and split not in splits[item.name]]
    others = list(dict.fromkeys(name for item in training for name in splits[item.name]))
    if not scored or not others:
        known = ", ".join(dict.fromkeys(name for names in splits.values() for name in names)) or "none"
        raise KeyError(
            f"split {split!r}: nothing to {'train on' if scored else 'score'}; splits with ground truth:"
            f" {known}"
        )
    if shared := {item.shape_name for item in scored} & {item.shape_name for item in training}:
        raise ValueError(f"{min(shared)}: has views in split {split} and in another one")
    how = f"trained on split{'s' * (len(others) > 1)} {' and '.join(others)}"
    return Dealing(how, {item.name: 0 for item in scored}, [[item.name for item in training]])


def with_scans(dealing: Dealing) -> Dealing:
    fold_of = dict(dealing.fold_of)
    for name, fold in dealing.fold_of.items():
        for view in range(_core.views):
            if fold_of.setdefault(f"{name}_{view}", fold) != fold:
                raise ValueError(
                    f"{name}_{view} is the name of a shape and of scan {view} of {name}, which are in two"
                    " folds: rename it, or leave scans out"
                )
    return dataclasses.replace(dealing, fold_of=fold_of)
