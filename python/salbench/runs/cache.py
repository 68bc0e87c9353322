# SPDX-License-Identifier: GPL-3.0-or-later
"""Read-only access to the cache of a run, without an export."""

import datetime
import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from salbench import _core
from salbench.datasets.dataset import Path
from salbench.system.files import path_of, require_folder
from salbench.system.names import ByName, fail_unknown
from salbench.system.types import NDArray

Array = NDArray[Any]
Attributes = Mapping[str, str | int | float]


@dataclass(frozen=True, eq=False)
class Artefact(Mapping[str, Array]):
    """Result of one stage for one item: its arrays by name, as docs/data_dictionary.md describes them.

    Attributes
    ----------
    item, stage : str
        "52_3", "fpfh".
    arrays : dict
        By name; read-only views on the memory that the file was read into.
    attributes : dict
        All attributes of the file: "kind", "options", "seed", "inputs", "seconds", "program", ...
    path : str
        The file.
    stored : float
        Time of writing, in seconds since 1970; 0 if the file is gone.
    """

    item: str
    stage: str
    arrays: Mapping[str, Array]
    attributes: Attributes
    path: str
    stored: float = 0

    def __getitem__(self, name: str) -> Array:
        """Returns an array. KeyError if there is none of this name."""
        if name not in self.arrays:
            _core.fail_unknown(f"array in {self.stage} of {self.item}", name, list(self.arrays))
        return self.arrays[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.arrays)

    def __len__(self) -> int:
        return len(self.arrays)

    @property
    def recipe(self) -> str:
        """Recipe of the result: version, options, seed and inputs, one line each."""
        lines = [
            f"stage_version: {self.attributes['stage_version']}",
            *str(self.attributes["options"]).splitlines(),
        ]
        if self.attributes["seed"]:
            lines.append(f"seed: {self.attributes['seed']}")
        return "\n".join(lines + [f"input {line}" for line in str(self.attributes["inputs"]).splitlines()])

    def __repr__(self) -> str:
        shapes = ", ".join(f"{name} {values.shape}" for name, values in self.arrays.items())
        return f"Artefact({self.item!r}, {self.stage!r}: {shapes})"


class Item:
    """Cached results of one mesh, scan or point cloud, or of a whole data set ("meshes", "scans")."""

    def __init__(self, folder: _core.CacheFolder, name: str) -> None:
        self._folder, self.name = folder, name

    @property
    def stages(self) -> tuple[str, ...]:
        """Stages with results for the item."""
        return tuple(dict.fromkeys(known.stage for known in self._find([])))

    def __getitem__(self, stage: str) -> Artefact:
        """Returns the result of a stage: `cache["52"]["map.LS"]`. KeyError if there is none; LookupError if
        there are several with different contents, from different options or inputs: choose one of
        `all(stage)`."""
        return self._one([stage], stage)

    def all(self, stage: str) -> list[Artefact]:
        """All results of a stage for the item, the newest last; `recipe` and `attributes` distinguish them.
        Artefacts written at the same time are in the order of their keys."""
        return self._read(sorted(self._find([stage]), key=lambda known: known.stored))

    def __contains__(self, stage: object) -> bool:
        return stage in self.stages

    def __iter__(self) -> Iterator[str]:
        return iter(self.stages)

    @property
    def points(self) -> Array:
        """(n, 3) positions."""
        artefact = self._one(["mesh", "scan", "cloud"], "points")
        return artefact["vertices" if artefact.stage == "mesh" else "points"]

    @property
    def faces(self) -> Array:
        """(m, 3) corners of a mesh, or of the partial mesh over a scan or a point cloud."""
        return self._one(["mesh", "surface"], "faces")["faces"]

    @property
    def normals(self) -> Array:
        """(n, 3) unit normals, as estimated."""
        return self._one(["normals", "scan_normals", "cloud_normals"], "normals")["normals"]

    @property
    def fpfh(self) -> Array:
        """(n, 33) descriptors, float32."""
        return self._one(["fpfh"], "fpfh")["fpfh"]

    @property
    def ground_truth(self) -> Array:
        """(n,) saliency; NaN for points that nobody looked at."""
        return self._one(["ground_truth", "scan_ground_truth", "cloud_ground_truth"], "ground_truth")[
            "saliency"
        ]

    @property
    def maps(self) -> Mapping[str, Array]:
        """Maps by model, as the models computed them: (n,) arrays."""
        return self._of_models("map")

    @property
    def matched(self) -> Mapping[str, Array]:
        """Maps by model, matched to the histogram of the ground truth."""
        return self._of_models("matched")

    def _of_models(self, kind: str) -> Mapping[str, Array]:
        names = [stage.removeprefix(f"{kind}.") for stage in self.stages if stage.startswith(f"{kind}.")]
        return ByName(
            f"map of {self.name} by a model called", names, lambda model: self[f"{kind}.{model}"]["saliency"]
        )

    def _find(self, stages: list[str]) -> list[_core.KnownArtefact]:
        return self._folder.find(os.fsencode(self.name), stages)

    def _read(self, known: Iterable[_core.KnownArtefact]) -> list[Artefact]:
        """Reads artefacts, without those of another item with the same label."""
        read = ((each.stage, each.stored, *each.read()) for each in known)
        found = [
            Artefact(str(attributes["item"]), stage, arrays, attributes, os.fsdecode(path), stored)
            for stage, stored, arrays, attributes, path in read
        ]
        return [
            artefact
            for artefact in found
            if self.name in (artefact.item, _core.item_label(os.fsencode(self.name)))
        ]

    def _one(self, stages: list[str], what: str) -> Artefact:
        known = sorted(self._find(stages), key=lambda known: known.stored)
        found = self._read({(each.stage, each.content): each for each in known}.values())
        if not found:
            _core.fail_unknown(f"artefact of {self.name} from a stage called", what, list(self.stages))
        if len(found) > 1:
            raise LookupError(self._choice(self._read(known)))
        return found[0]

    def _choice(self, found: list[Artefact]) -> str:
        """Message that lists the artefacts with their times and differences."""
        lines = [set(artefact.recipe.splitlines()) for artefact in found]
        shared = set.intersection(*lines)
        texts = []
        for i, artefact in enumerate(found):
            own = [line for line in artefact.recipe.splitlines() if line not in shared] or ["the same recipe"]
            when = datetime.datetime.fromtimestamp(artefact.stored).strftime("%Y-%m-%d %H:%M:%S")
            texts.append(f"  [{i}] {artefact.item}, stored {when}: {'; '.join(own)}")
        chosen = f"cache[{self.name!r}].all({found[0].stage!r})"
        return "\n".join(
            [
                (
                    f"{found[0].stage} of {self.name} was computed {len(found)} times, with different"
                    f" results; choose one of {chosen}, such as the newest, {chosen}[-1]; salbench gc CONFIG"
                    " removes what a configuration does not need:"
                ),
                *texts,
            ]
        )

    def __repr__(self) -> str:
        return f"Item({self.name!r}, stages {', '.join(self.stages)})"


class Cache(Mapping[str, Item]):
    """A cache of the program or of `run`, read-only: artefacts by item and stage. A run may write to it
    meanwhile.

    Parameters
    ----------
    path : path
        The folder.

    Raises
    ------
    FileNotFoundError
        A missing folder.
    ValueError
        A folder that is no cache; on access, a damaged artefact, which stays in place.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import salbench
    >>> folder = pathlib.Path(tempfile.mkdtemp())
    >>> _ = (folder / "box.off").write_text("OFF\\n4 4 0\\n0 0 0\\n1 0 0\\n0 1 0\\n0 0 1\\n3 0 2 1\\n3 0 1 3\\n3 0 3 2\\n3 1 2 3\\n")
    >>> _ = salbench.run({"dataset": {"participants": "simulated", "scans": False}, "metrics": {"names": ["nss"]}},
    ...                  data=folder, models={"CB": None}, cache=folder / "cache", out=folder / "out", progress=False)
    >>> cache = salbench.Cache(folder / "cache")
    >>> cache["box"].points.shape, cache["box"].maps["CB"].shape
    ((4, 3), (4,))
    >>> list(cache["box"]["scores.CB"])
    ['counts', 'scores']
    """

    def __init__(self, path: Path) -> None:
        self.path = path_of(path, "path")
        require_folder(self.path)
        self._folder = _core.CacheFolder(os.fsencode(self.path))

    @property
    def stages(self) -> tuple[str, ...]:
        """Stages with artefacts of any item."""
        return tuple(self._folder.stages())

    def names(self) -> list[str]:
        """Names of the items, in natural order; characters except letters, digits, '-' and '_' become '_', as
        in file names."""
        names: list[str] = self._folder.items()
        return names

    def maps(self, model: str) -> Mapping[str, Array]:
        """Maps of a model by item name, like `Results.maps`: maps("LS")["52_3"]."""
        names = [name for name in self.names() if self._folder.find(os.fsencode(name), [f"map.{model}"])]
        if not names:
            _core.fail_unknown(
                "map by a model called",
                model,
                [stage[4:] for stage in self.stages if stage.startswith("map.")],
            )
        return ByName(f"map by {model} of an item called", names, lambda name: self[name].maps[model])

    def __getitem__(self, name: str) -> Item:
        """Returns the cached results of an item. KeyError if there are none."""
        if name not in self:
            fail_unknown("item", name, self.names())
        return Item(self._folder, name)

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and bool(self._folder.find(os.fsencode(name), []))

    def __iter__(self) -> Iterator[str]:
        return iter(self.names())

    def __len__(self) -> int:
        return len(self._folder.items())

    def __repr__(self) -> str:
        return f"Cache({self.path!r})"

    def __reduce__(self) -> tuple[type["Cache"], tuple[str]]:
        return Cache, (os.path.abspath(self.path),)
