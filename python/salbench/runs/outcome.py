# SPDX-License-Identifier: GPL-3.0-or-later
"""Summary at the end of a run: conclusions, and the location of results and cache."""

import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from salbench.system.console import aligned
from salbench.system.errors import InputError, StorageError

if TYPE_CHECKING:
    from salbench import _core


class Outcome(NamedTuple):
    """Conclusions from scores, or else means."""

    text: str = ""  # a table, a blank line, and sentences
    scores: Sequence[Mapping[str, str]] = ()
    leaders: Sequence[Mapping[str, Any]] = ()
    missing: str = ""  # a missing library
    failure: str = ""  # reason why there are no conclusions

    @property
    def sentences(self) -> list[str]:
        """Sentences on who leads, and with what certainty."""
        return self.text.partition("\n\n")[2].splitlines()


def of(going: "_core.Run") -> Outcome:
    """Reads the conclusions in the folder, or draws them. Imports slow libraries only in the second case."""
    if not going.scores:  # for a share, or before the first score
        return Outcome()
    from salbench.runs import conclusions_file

    folder = Path(going.output)
    try:
        document = conclusions_file.read_if_whole(folder, going.scores)
        if document is None:
            from salbench import conclusions

            document = conclusions.conclude(conclusions.source_of(str(folder)), of=going.scores)
        return Outcome(document["text"], document["scores"], document["leaders"])
    except ModuleNotFoundError as error:
        return _means(going)._replace(missing=f"{error}; install it for {sys.executable}")
    except (InputError, StorageError) as error:
        return _means(going)._replace(failure=str(error))
    except Exception as error:  # the scores exist anyway
        return _means(going)._replace(failure=f"{type(error).__name__}: {error}")


def computed_text(going: "_core.Run") -> str:
    return f"{going.computed} artefact{'' if going.computed == 1 else 's'} computed"


def places(going: "_core.Run") -> str:
    return (
        f"protocol {going.protocol_name}; {computed_text(going)}, results in {going.output},"
        f" cache in {going.cache}"
    )


def _means(going: "_core.Run") -> Outcome:
    from salbench import _core

    columns, rows = going.means()
    kinds: dict[str, Callable[[str], Any]] = {"n": int, "mean": lambda cell: float(cell or "nan")}
    cells = [[kinds.get(column, str)(cell) for column, cell in zip(columns, row)] for row in rows]
    note = [_core.simulated_note] if going.simulated else []
    return Outcome(
        "\n".join([aligned(columns, cells), *note, *([""] if note else [])]),
        [dict(zip(columns, row)) for row in rows],
    )
