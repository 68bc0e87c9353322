# SPDX-License-Identifier: GPL-3.0-or-later
# Imported by scripts/figures.
"""Figures of docs/gaze.md: simulated people who look at shapes according to known densities, and the cost of
recordings."""

import collections
import resource
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import yaml

from .common import PROGRAM, ROOT, markdown, show

import salbench

sys.path.append(str(ROOT / "docs"))

from simulated_gaze import bumpy_sphere, losses, on_turntable, peaks, recording  # noqa: E402

PAGE = ROOT / "docs/gaze.md"
OF_FIXATIONS = {
    "method",
    "velocity",
    "dispersion",
    "min_ms",
    "merge_ms",
    "merge_degrees",
    "skip_ms",
    "skip_first",
}
PEOPLE, WIDTH, LOOKED_AT = 30, 0.2, 5  # people in a study; width of the peaks of a density, and their number


def looks_of(points, faces, recorded, person, **options):
    """Fixations of a person."""
    own = recorded.person == person
    eyes, directions, valid = recorded.origins[own], recorded.directions[own], recorded.valid[own]
    return salbench.fixations(
        recorded.time[own],
        directions,
        eyes,
        valid,
        salbench.cast_rays(points, faces, eyes, directions).place,
        **options,
    )


def viewers(points, faces, recorded, **options):
    """A density per person, and the mean number of fixations. Options as in the section `gaze` of a
    configuration."""
    of_fixations = {key: value for key, value in options.items() if key in OF_FIXATIONS}
    of_density = {key: value for key, value in options.items() if key not in OF_FIXATIONS}
    maps, count = [], 0
    for person in range(len(recorded.people)):
        looks = looks_of(points, faces, recorded, person, **of_fixations)
        hits = salbench.cast_rays(points, faces, looks.origin, looks.direction)
        maps.append(
            salbench.gaze_density(
                points, faces, hits.face, hits.weights, hits.depth, looks.duration, looks.origin, **of_density
            )
        )
        count += len(looks.start)
    return np.array(maps), count / len(recorded.people)


def correlation(maps, truth):
    return salbench.metrics.cc(maps.mean(axis=0), ground_truth=truth)


def studies(points, faces, number, **simulated):
    """Studies of the same shape, each with other people and another density; yields the density and the
    recording."""
    for seed in range(number):
        places = points[np.random.default_rng(1000 + seed).choice(len(points), LOOKED_AT, replace=False)]
        truth = peaks(points, places, WIDTH)
        yield truth, recording(points, faces, truth, PEOPLE, seed=seed, **simulated)


def cell(values):
    return f"{np.mean(values):.2f} ({min(values):.2f} to {max(values):.2f})"


def by_people(points, faces, number, people=(1, 2, 5, 10, 20, 30), spreads=(0.5, 1, 2, 4)):
    found, halves = collections.defaultdict(list), collections.defaultdict(list)
    for truth, recorded in studies(points, faces, number):
        for degrees in spreads:
            maps, _ = viewers(points, faces, recorded, degrees=degrees)
            for n in people:
                found[n, degrees].append(correlation(maps[:n], truth))
                if degrees == 2 and 1 < n <= len(maps):
                    halves[n].append(correlation(maps[: n // 2], maps[n // 2 : n // 2 * 2].mean(axis=0)))
    rows = [
        [str(n), *(cell(found[n, degrees]) for degrees in spreads), cell(halves[n]) if n in halves else ""]
        for n in people
    ]
    return markdown(["people", *(f"`degrees: {degrees}`" for degrees in spreads), "halves, at 2"], rows)


def by_error(points, faces, number, errors=(0, 0.5, 1, 2, 4), spreads=(1, 2)):
    rows = []
    for error in errors:
        found = collections.defaultdict(list)
        for truth, recorded in studies(points, faces, number, error=error):
            for degrees in spreads:
                found[degrees].append(
                    correlation(viewers(points, faces, recorded, degrees=degrees)[0], truth)
                )
        rows.append([f"{error}°", *(cell(found[degrees]) for degrees in spreads)])
    return markdown(["error", *(f"`degrees: {degrees}`" for degrees in spreads)], rows)


def by_method(points, faces, number, noises=(0.05, 0.2, 0.5), methods=("ivt", "idt", "none")):
    found = collections.defaultdict(list)
    for noise in noises:
        for truth, recorded in studies(points, faces, number, noise=noise):
            for method in methods:
                maps, count = viewers(points, faces, recorded, method=method)
                found[noise, method].append((correlation(maps, truth), count))
    rows = [
        [
            f"{noise}°",
            *(
                f"{np.mean([c for c, _ in found[noise, method]]):.2f},"
                f" {np.mean([n for _, n in found[noise, method]]):.0f}"
                for method in methods
            ),
        ]
        for noise in noises
    ]
    return markdown(["noise", *(f"`method: {method}`" for method in methods)], rows)


def by_speed(points, faces, number, speeds=(0, 10, 21, 36, 60, 90), methods=("ivt", "idt")):
    """Looks before a turntable: the share found, the share of their time, and the distance from the true
    places."""
    rows = []
    for speed in speeds:
        cells = []
        for method in methods:
            found, true, held, errors = 0, 0, [], []
            for seed in range(number):
                truth = peaks(
                    points,
                    points[np.random.default_rng(1000 + seed).choice(len(points), LOOKED_AT, replace=False)],
                    WIDTH,
                )
                recorded, targets = on_turntable(points, faces, truth, PEOPLE, speed=speed, seed=seed)
                for person in range(PEOPLE):
                    own = np.flatnonzero(recorded.person == person)
                    looks, time = looks_of(points, faces, recorded, person, method=method), recorded.time[own]
                    middle = np.searchsorted(time, looks.start + looks.duration / 2)
                    ways = points[targets[own[middle]]] - looks.origin
                    errors += [*angles(ways, looks.direction)[targets[own[middle]] >= 0]]
                    found += len(looks.start)
                    true += np.count_nonzero(np.diff(targets[own], prepend=-1) * (targets[own] >= 0))
                    held.append(looks.duration.sum() / (time[-1] * 300 / 330))
            cells += [f"{found / true:.2f}", f"{100 * np.mean(held):.0f} %", f"{np.median(errors):.2f}°"]
        rows.append([f"{speed}°/s", *cells])
    return markdown(
        ["turning", *(f"{what}, {method}" for method in methods for what in ("found", "time", "error"))], rows
    )


def angles(a, b):
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), (a * b).sum(axis=-1)))


def by_losses(points, faces, number, losses_of_each=(0, 8), methods=("ivt", "idt", "none")):
    """Effect of samples lost by a tracker, as marked rows and as missing ones."""
    rows = []
    for count in losses_of_each:
        for how in ("marked", "missing") if count else ("",):
            cells = []
            for method in methods:
                found = []
                for truth, recorded in studies(points, faces, number):
                    lost = losses(recorded, count) if count else np.zeros(len(recorded.time), bool)
                    if how == "missing":
                        columns = {
                            name: getattr(recorded, name)[~lost]
                            for name in ("person", "time", "valid", "origins", "directions")
                        }
                        recorded = replace(recorded, **columns)
                    else:
                        recorded = replace(recorded, valid=~lost)
                    maps, looks = viewers(points, faces, recorded, method=method)
                    found.append((correlation(maps, truth), looks))
                cells.append(f"{np.mean([c for c, _ in found]):.3f}, {np.mean([n for _, n in found]):.1f}")
            rows.append([f"{count} losses, {how}" if count else "none", *cells])
    return markdown(["lost in 10 s", *(f"`method: {method}`" for method in methods)], rows)


def sheets(side, gap):
    """Two parallel square sheets of side x side points; the first half of the points is the front."""
    x, y = np.meshgrid(np.linspace(-1, 1, side), np.linspace(-1, 1, side))
    flat = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=-1)
    corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    front = np.concatenate(
        [
            np.stack([corner, corner + 1, corner + side + 1], axis=-1),
            np.stack([corner, corner + side + 1, corner + side], axis=-1),
        ]
    )
    return np.concatenate([flat + [0, 0, gap / 2], flat - [0, 0, gap / 2]]), np.concatenate(
        [front, front[:, ::-1] + side**2]
    )


def by_grazing(side, slopes=(90, 45, 20, 8), looks=2000):
    """Looks at a place on a plane under grazing angles, with an error of 1 degree: spread of the density
    across and along the plane, as seen by the eye, compared with the spread of the recorded places."""
    x, y = np.meshgrid(np.linspace(-0.5, 0.5, side), np.linspace(-0.5, 0.5, side))
    points = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=-1)
    faces = sheets(side, 0)[1][: 2 * (side - 1) ** 2]
    areas, rows = salbench.vertex_areas(points, faces), []

    def spread(ways, mass, ahead, along):
        """Root mean square, in degrees, of angles across and along."""
        ways = ways / (ways @ ahead)[:, None]
        return [
            np.degrees(np.sqrt(mass @ (ways @ axis) ** 2 / mass.sum()))
            for axis in (np.cross(ahead, along), along)
        ]

    for slope in slopes:
        eye = np.array([0, -np.cos(np.radians(slope)), np.sin(np.radians(slope))])
        ahead = -eye
        along = np.cross([1, 0, 0], ahead)
        random = np.random.default_rng(1)
        recorded = ahead + np.radians(1) * random.normal(size=(looks, 2)) @ np.stack(
            [np.cross(ahead, along), along]
        )
        hit = salbench.cast_rays(points, faces, np.tile(eye, (looks, 1)), recorded)
        cells = [spread(recorded[hit.face >= 0], np.ones((hit.face >= 0).sum()), ahead, along)]
        one = salbench.cast_rays(points, faces, [eye], [ahead])
        for name in ("geodesic", "euclidean", "view"):
            mass = (
                salbench.gaze_density(
                    points, faces, one.face, one.weights, one.depth, origins=[eye], spread=name
                )
                * areas
            )
            cells.append(spread(points - eye, mass, ahead, along))
        rows.append([f"{slope}°", *(f"{across:.2f}°, {down:.2f}°" for across, down in cells)])
    return markdown(["seen at", "recorded places", "`geodesic`", "`euclidean`", "`view`"], rows)


def by_spread(side, number, gaps=(0.1, 0.5, 1, 2)):
    # the eye is three radii away
    sigma, spreads = 3 * 2**0.5 * np.tan(np.radians(1)), ("geodesic", "euclidean", "view")
    rows = []
    for gap in gaps:
        points, faces = sheets(side, gap * sigma)
        front, found = np.arange(len(points)) < side**2, collections.defaultdict(list)
        for seed in range(number):
            random = np.random.default_rng(1000 + seed)
            truth = np.concatenate(
                [
                    peaks(points[part], random.uniform(-0.8, 0.8, (2, 3)) * [1, 1, 0], WIDTH)
                    for part in (front, ~front)
                ]
            )
            both, of_front = recording(points, faces, truth, PEOPLE, seed=seed), recording(
                points, faces, truth * front, PEOPLE, seed=seed
            )
            for spread in spreads:
                found["cc", spread].append(correlation(viewers(points, faces, both, spread=spread)[0], truth))
                mass = viewers(points, faces, of_front, spread=spread)[0].mean(
                    axis=0
                ) * salbench.vertex_areas(points, faces)
                found["mass", spread].append(100 * mass[~front].sum())
        rows.append(
            [
                f"{gap}",
                *(cell(found["cc", spread]) for spread in spreads),
                *(f"{np.mean(found['mass', spread]):.0f} %" for spread in spreads),
            ]
        )
    return markdown(
        [
            "gap / sigma",
            *(f"`spread: {spread}`" for spread in spreads),
            *(f"leaks, {spread}" for spread in spreads),
        ],
        rows,
    )


def tables(points=10_000, number=5):
    shape = bumpy_sphere(points)
    side = round((points / 2) ** 0.5)
    of = f"{number} studies on a bumpy sphere of {points} vertices, {PEOPLE} people unless stated otherwise"
    return f"""Mean over {of}, lowest and highest in brackets.

**People and `degrees`.** CC with the true density. Halves: CC between the maps of the two halves of the people, which a study can measure.

{by_people(*shape, number)}
**Error of the tracker**, root mean square, drawn once per look:

{by_error(*shape, number)}
**Method and noise**, root mean square, drawn for each sample at 120 Hz: CC, and fixations per person.

{by_method(*shape, number)}
**A shape on a turntable**, noise of 0.2 degrees, looks of 300 ms: share of the looks and of their time that is detected; median angle at the eye
between detected and true place.

{by_speed(*shape, number)}
**Losses** of 150 to 400 ms, as rows marked as lost and as missing rows: CC, and fixations per person.

{by_losses(*shape, number)}
**A plane seen at an angle**, with a tracker error of 1 degree across and along: angles at the eye, across and along, from the true place to the
recorded ones, and the spread that `degrees: 1` gives it.

{by_grazing(301)}
**A thin shape**: two sheets of {side} x {side} vertices with different densities, `degrees: 1`. Leaks: mass on the back sheet from people
who look only at the front.

{by_spread(side, number)}"""


def speed(data, people=32):
    """Processor time and memory of a run, with one thread, on recordings that are simulated where people
    looked at these meshes."""

    def shapes():
        for shape in salbench.Dataset("zaragoza", data):
            density = np.nan_to_num(shape.ground_truth) + 0.001 * np.nanmean(shape.ground_truth)
            yield SimpleNamespace(
                id=shape.id,
                points=shape.points,
                faces=shape.faces,
                recording=recording(shape.points, shape.faces, density, people),
            )

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        salbench.datasets.write(folder / "set", shapes())
        (folder / "gaze.yaml").write_text(
            "dataset: {layout: hdf5, scans: false, participants: recorded}\nmodels: {RS: }\n"
        )
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(
            [
                PROGRAM,
                "run",
                folder / "gaze.yaml",
                "--data",
                folder / "set",
                "--cache",
                folder / "cache",
                "--out",
                folder / "out",
                "--threads",
                "1",
                "--quiet",
            ],
            check=True,
            stderr=subprocess.DEVNULL,
        )
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        record = yaml.safe_load((folder / "out/run.yaml").read_text(encoding="utf-8"))
    seconds = {node["stage"]: node["processor"] for node in record["nodes"]}
    for stage in ("fixations", "gaze_hits", "ground_truth"):
        print(f"{stage:14}{seconds[stage]:7.2f} s")
    print(
        f"{'all of it':14}{used.ru_utime + used.ru_stime - before.ru_utime - before.ru_stime:7.2f} s of"
        f" processor time, {record['peak_memory_mb']:.0f} MB"
    )


def gaze(write):
    show(tables(), PAGE, "gaze", write)
