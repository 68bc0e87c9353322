# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench reproduce`: makes the maps of a submission again, by its command, from code and weights with the digests of its card, over the same
data; and says shape by shape and metric by metric how near they come.

What came is scored here like what is made, so that both differ by their maps alone."""

import argparse
import datetime
import itertools
import json
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas

from salbench import _core
from salbench._console import ALL_DONE, SOME_FAILED, aligned, report, warn
from salbench._errors import InputError, quoted, wrong_with_line
from salbench._results import Results
from salbench._scratch import ScratchFolder
from salbench._yaml import flow_text, plain_text
from salbench.conclusions import folders, tables
from salbench.leaderboard import board, origin, submission, texts
from salbench.leaderboard.card import Card, read_card
from salbench.leaderboard.expected import NAMES, Expected
from salbench.leaderboard.session import Session, summary_of
from salbench.leaderboard.submission import Submission

ROUNDING = 0.0005  # of a score: half of the third decimal, to which they are published
MAP_ROUNDING = 1e-5  # of a map, over its range: what single precision leaves of a network
PARTED = 0.01  # of a score of such maps: equal values that part move ranks. Not more: a range may be that of one stray value
_LARGE = 2.0 ** 1020  # of a value: sums of a few do not overflow
MOST_BY = 500  # bytes of --by
_ROOM = 1000  # bytes that are kept free in a card for what is found, of the 2 000 of a line
BIT, NEAR, WITHIN, DIFFERS = "to the bit", "to rounding", "within the interval", "differs"

SHAPES = (tables.DATASET, tables.text("item", "as in results.csv"), tables.text("view", "as in results.csv"), tables.METRIC,
          tables.number("submitted", "score of the map that was submitted, computed here"), tables.number("reproduced", "score of the map made here"),
          tables.number("map_difference", "largest difference of the two maps, over the range of the submitted one"),
          tables.text("outcome", f"{BIT}: the same map; {NEAR}: scores less than {ROUNDING} apart, or less than {PARTED} of maps less than {MAP_ROUNDING} of their range "
                      f"apart; {DIFFERS}"))
MEANS = (tables.DATASET, tables.METRIC, tables.N_SHAPES, tables.number("submitted", "mean over the units of the submitted maps"), *tables.CI95,
         tables.number("reproduced", "mean over the units of the maps made here"), tables.number("difference", "largest, of a shape"),
         tables.text("outcome", f"of the shapes, the worst; {WITHIN}: scores differ, and the mean lies within the interval of the submitted one"))


@dataclass(frozen=True)
class Reproduced:
    shapes: pandas.DataFrame  # SHAPES
    means: pandas.DataFrame  # MEANS
    maps: int
    same_maps: int

    @property
    def outcome(self) -> str:
        """The worst of any metric."""
        found = set(self.means["outcome"])
        return next(outcome for outcome in (DIFFERS, WITHIN, NEAR, BIT) if outcome in found)

    @property
    def sentence(self) -> str:
        same = f"all {self.maps} maps are the same" if self.same_maps == self.maps else f"{self.same_maps} of {self.maps} maps are the same to the bit"
        said = f"{self.outcome}: {same}"
        if self.outcome != DIFFERS:
            return said
        rows = self.means[self.means["outcome"] == DIFFERS]
        return said + "; " + ", ".join(f"mean {row.metric} {row.reproduced - row.submitted:+.4f}" for row in rows.itertuples())


def reproduce(given: argparse.Namespace) -> int:
    """given: CARD, --model, --to and --by beside the arguments of a session. Returns the status."""
    _check_by(given)
    file = Path(given.card)
    with ScratchFolder() as name:
        scratch = Path(name)
        given.cache = given.cache or str(scratch / "cache")
        asked = _checked(file, given, scratch)
        card, session = asked.read.card, asked.session
        if given.by:  # what cannot be written in the end is refused before anything is computed
            _with_line(asked, _line(given.by, "x" * _ROOM), scratch)
        if not given.quiet:
            command = texts.shown(asked.options.get("command", "").strip())
            warn("note", f"runs, for each shape, what {file.name} names: {command or f'the built-in model {card.name}'}")
        theirs = session.run(functions=[(card.name, board.model_of(asked.read.maps))], silent=True)
        _require_scored(theirs, asked)
        given.config = _with_model(given.config, card.name, asked.options, scratch / "model")
        try:
            ours = session.run(kept=card.name, silent=True)
        except InputError as error:  # which may repeat what stands in the archive, and names a file that is ours
            said = " ".join(texts.shown(re.sub(rf"{re.escape(given.config)}(:[0-9]+)?: ", "", str(error))).split())[:300]
            raise InputError(f"{file}: not runnable here: {texts.MODEL}: {said}; ask {asked.whom} for another submission") from None
        if ours.failures and not any(ours.scores["model"] == card.name):
            raise InputError(f"{file}: not runnable here: {ours.failures[0].item}: {ours.failures[0].cause.splitlines()[0]}")
        for failure in ours.failures:
            warn("error", f"{failure.item}: {failure.cause.splitlines()[0]}")
        found = compare(theirs, ours, card.name)
        line = _line(given.by or "somebody", found.sentence)
        if given.to:
            _write(Path(given.to), found, folders.read_run(theirs.folder).remarks, _with_line(asked, line, scratch) if given.by else b"", card.name)
        document = {"model": card.name, "outcome": found.outcome, "reproduced_by": line, "maps": found.maps, "same_maps": found.same_maps,
                    "means": tables.records(found.means), "to": given.to, **summary_of(ours)}
        text = aligned(list(found.means), list(found.means.itertuples(index=False))) + f"{card.name}: {found.sentence}\n"
    report(given, "reproduce", document, text)
    return SOME_FAILED if found.outcome == DIFFERS or ours.failures else ALL_DONE


def _check_by(given: argparse.Namespace) -> None:
    if given.by and (wrong := wrong_with_line(given.by)):
        raise InputError(f"--by has {wrong}, expected a line such as 'Jane Doe, University of Somewhere'")
    if given.by and (n := len(given.by.encode())) > MOST_BY:
        raise InputError(f"--by has {n} bytes, expected at most {MOST_BY}")
    if given.by and not given.to:
        raise InputError("--by needs --to, the folder of the new card")


# --- what a card names -----------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Asked:
    """What is to be reproduced."""

    file: Path
    read: Submission  # whose data, protocol, maps, code and weights fit what it has the digests of
    said: Mapping[str, str]  # its texts, as they came
    options: Mapping[str, Any]  # of its model
    session: Session  # over its configuration
    expected: Expected

    @property
    def whom(self) -> str:
        return _whom(self.read.card)


def _whom(card: Card) -> str:
    return card.contact or "its authors"


def _checked(file: Path, given: argparse.Namespace, scratch: Path) -> Asked:
    """Throws InputError for what does not fit."""
    place = scratch / "model"
    place.mkdir()
    session = Session(given, scratch)
    said = submission.texts_of(file)
    for name in NAMES:
        if name not in said:
            raise InputError(f"{file}: has no {name}")
    given.config = str(scratch / "configuration.yaml")
    Path(given.config).write_text(submission.protocol_of(_bytes(said["configuration.yaml"]), f"{file}: configuration.yaml"))
    before = session.run(kept="")
    expected = board.expected_of(before, before._run.protocol)
    read = submission.read_all([file], expected, scratch, given.threads)[0]
    if isinstance(read, str):
        raise InputError(f"{file}: {read}")
    options = _options_of(read, file)
    asked = Asked(file, read, said, options, session, expected)
    _place_files(asked, Path(given.model), place)
    return asked


def _bytes(text: str) -> bytes:
    """Of a text that a process has sent: what is no UTF-8 stays none, and is refused where the text is read."""
    return text.encode("utf-8", "surrogatepass")


def _options_of(read: Submission, file: Path) -> dict[str, Any]:
    """The entry of the model in a configuration: texts, and lists and mappings of texts. The program checks what they say."""
    import yaml

    made_by = read.manifest.made_by
    if made_by not in ("command", "built-in") or not read.options:
        how = "a function of Python" if made_by == "function" else "files"
        raise InputError(f"{file}: not runnable: its maps came from {how}, and it names no command; ask "
                         f"{_whom(read.card)} for a submission of a configuration (docs/leaderboard.md)")
    where, ask = f"{file}: {texts.MODEL}", f"ask {_whom(read.card)} for another submission"
    try:
        options = yaml.load(plain_text(_bytes(read.options), where, texts.LONGEST_TEXT), yaml.BaseLoader)  # no tag, standard ones included, makes anything
        json.dumps(options, ensure_ascii=False).encode()
    except (yaml.YAMLError, UnicodeEncodeError) as error:  # a key that is a list, two documents; half a character
        raise InputError(f"{where}: {getattr(error, 'problem', None) or 'is not Unicode'}, expected lines such as `command: ...`; {ask}") from None
    if not isinstance(options, dict):
        raise InputError(f"{where} has no options of a model; {ask}")
    if not isinstance(options.get("command", ""), str):
        raise InputError(f"{where}: command is a list or mapping, expected text; {ask}")
    depends = options.get("depends") or []
    if not isinstance(depends, list) or not all(isinstance(name, str) for name in depends):
        raise InputError(f"{where}: depends is no list of names, expected one such as [predict.py, weights.pt]; {ask}")
    return options


def _place_files(asked: Asked, folder: Path, place: Path) -> None:
    """Links to code and weights, once their digests fit, beside the configuration that names them."""
    read = asked.read
    digests = {name: digest for digest, _, name in (line.partition(" ") for line in read.manifest.files)}
    for name in asked.options.get("depends") or []:
        if name.startswith("/") or ".." in Path(name).parts or name not in digests:
            raise InputError(f"{asked.file}: {read.card.name} depends on {quoted(name)}, of which submission.yaml has no digest, or which is no path below "
                             f"a folder; ask {asked.whom} for another submission")
        own = folder / name
        found = origin.sha256_of(own)
        if found != digests[name]:
            raise InputError(f"{own}: its SHA-256 is {found}, and the card of {read.card.name} has {quoted(digests[name])}: other code or weights than "
                             "those of the submission; name the folder with the same ones with --model")
        (place / name).parent.mkdir(parents=True, exist_ok=True)
        if not os.path.lexists(place / name):  # a and ./a
            (place / name).symlink_to(own.absolute())


def _with_model(configuration: str, name: str, options: Mapping[str, Any], place: Path) -> str:
    """The file of a configuration that also has the model, beside links to the files that the model depends on: it takes the place of none."""
    made = next(path for n in itertools.count() if not os.path.lexists(path := place / f"with_model{n or ''}.yaml"))
    made.write_text(f"{Path(configuration).read_text()}models: {flow_text({name: options})}\n")
    return str(made)


# --- what came out ---------------------------------------------------------------------------------------------------------------------------


def _require_scored(theirs: Results, asked: Asked) -> None:
    """Throws InputError for a submission that a leaderboard refuses, too: a map of it has no score."""
    name = asked.read.card.name
    for failure in theirs.failures:
        if failure.item in asked.read.maps and failure.stage.endswith(f".{name}"):
            raise InputError(f"{asked.file}: its map of {failure.item} cannot be scored: {failure.cause.splitlines()[0]}; ask {asked.whom} for another "
                             "submission")
    if not any(theirs.scores["model"] == name):
        raise InputError(f"{asked.file}: none of its maps has a score; ask {asked.whom} for another submission")


def compare(theirs: Results, ours: Results, model: str) -> Reproduced:
    """Of two runs by the same protocol over the same data: the maps that were submitted, and those made here."""
    keys = ["dataset", "item", "view"]
    submitted, reproduced = (results.scores[results.scores["model"] == model].set_index(keys) for results in (theirs, ours))
    came, made = theirs.maps(model), ours.maps(model)
    apart = {item: map_difference(came[item], made[item]) for item in came if item in made}
    same = {item for item in apart if np.array_equal(came[item], made[item])}
    rows = []
    for key, row in submitted.iterrows():
        shape = "_".join(filter(None, (key[1], key[2])))
        for metric in theirs.record["metrics"]:
            mine = float(reproduced.at[key, metric]) if key in reproduced.index else float("nan")
            is_near = near(float(row[metric]), mine, PARTED if apart.get(shape, float("nan")) < MAP_ROUNDING else ROUNDING)
            rows.append({**dict(zip(keys, key)), "metric": metric, "submitted": float(row[metric]), "reproduced": mine,
                         "map_difference": apart.get(shape, float("nan")), "outcome": BIT if shape in same else NEAR if is_near else DIFFERS})
    shapes = tables.framed(SHAPES, rows)
    return Reproduced(shapes, tables.framed(MEANS, _means(shapes, theirs, ours, model)), len(came), len(same))


def map_difference(came: Any, made: Any) -> float:
    """The largest, over the range of the first; NaN of other sizes."""
    if len(came) != len(made):
        return float("nan")
    if max(np.max(np.abs(came)), np.max(np.abs(made))) > _LARGE:  # a range that overflows would make all maps near
        came, made = came / 8, made / 8
    spread = float(np.ptp(came)) or 1.0
    return float(np.max(np.abs(came - made))) / spread


def near(submitted: float, reproduced: float, by: float) -> bool:
    """So are two that are both undefined."""
    return abs(submitted - reproduced) < by or (submitted != submitted and reproduced != reproduced)


def _means(shapes: pandas.DataFrame, theirs: Results, ours: Results, model: str) -> list[dict[str, Any]]:
    """Rows of MEANS; without a mean where a metric has no score of any shape."""
    submitted, reproduced = _summary(theirs, model), _summary(ours, model)
    rows = []
    for key, part in shapes.groupby(["dataset", "metric"], sort=False):
        found = set(part["outcome"])
        outcome = next(outcome for outcome in (DIFFERS, NEAR, BIT) if outcome in found)
        came, mine = submitted.get(key, _NO_MEAN), reproduced.get(key, _NO_MEAN)["mean"]
        is_whole = not (part["reproduced"].isna() & part["submitted"].notna()).any()
        is_within = is_whole and came["ci95_low"] <= mine <= came["ci95_high"]
        rows.append({"dataset": key[0], "metric": key[1], "n_shapes": len(part), "submitted": came["mean"], "ci95_low": came["ci95_low"],
                     "ci95_high": came["ci95_high"], "reproduced": mine, "difference": (part["reproduced"] - part["submitted"]).abs().max(),
                     "outcome": WITHIN if outcome == DIFFERS and is_within else outcome})
    return rows


_NO_MEAN = dict.fromkeys(("mean", "ci95_low", "ci95_high"), float("nan"))


def _summary(results: Results, model: str) -> dict[tuple[str, str], Mapping[str, float]]:
    table = tables.of_all(results.summary)
    rows = table[table["model"] == model].to_dict("records")
    return {(row["dataset"], row["metric"]): row for row in rows}


def _write(to: Path, found: Reproduced, remarks: Sequence[str], archive: bytes, model: str) -> None:
    folders.make(to)
    folders.write_tables(to, [("reproduced", found.shapes), ("reproduced_means", found.means)], remarks)
    if archive:
        folders.write(to, f"{model}.zip", archive)


def _line(by: str, found: str) -> str:
    return f"{datetime.date.today()}, {by}: {found} (salbench {_core.version})"


def _with_line(asked: Asked, line: str, scratch: Path) -> bytes:
    """The submission, with a card that says who reproduced it. Throws InputError for one that a leaderboard would refuse."""
    read, said = asked.read, asked.said
    manifest = replace(read.manifest, maps=len(read.maps))  # a text, as it was read
    names = said[texts.LIST].encode("utf-8", "surrogateescape") if texts.LIST in said else None
    card = card_text(read_card(_bytes(said["card.yaml"]), f"{asked.file}: card.yaml"), line)
    made = submission.archive_of(card.encode(), manifest, said["configuration.yaml"], read.results.encode("utf-8", "surrogateescape"), read.maps, names,
                                 read.options, read.seeds)
    own = scratch / "again"  # the maps of the submission are read from a file of the scratch folder itself
    own.mkdir(exist_ok=True)
    if refusal := submission.refusal_of(made, asked.expected, own):
        raise InputError(f"{asked.file}: with the line of --by in its card it would be refused: {refusal}; choose another --by, or leave it out")
    return made


def card_text(card: Card, reproduced_by: str) -> str:
    """A card with one line more on who reproduced it."""
    values = {field.name: getattr(card, field.name) for field in fields(card)}
    values["reproduced_by"] = (*card.reproduced_by, reproduced_by)
    values["test_overlap"] = card.test_overlap or "none"
    values["trained_on"] = card.trained_on[0] if len(card.trained_on) == 1 else card.trained_on
    return "".join(f"{key}: {json.dumps(list(value) if isinstance(value, tuple) else value, ensure_ascii=False)}\n"
                   for key, value in values.items() if value)
