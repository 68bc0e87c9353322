# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench export` writes the content of the cache, readable by other programs."""

from pathlib import Path

import h5py
import numpy as np
from support import MESHES, SCANS, VIEWS, Workspace
from tests.support.cache_files import segments
from tests.support.shapes import off, sphere

NAMED = {"stage", "stage_version", "kind", "options", "seed", "inputs", "key", "content"}
SCORES = ("auc", "auc_exact", "nss", "cc", "lcc")
PLY_TYPES = {"double": "<f8", "float": "<f4"}


def text(value):
    return value.decode() if isinstance(value, bytes) else value


def packing(data):
    return data.chunks, data.compression, data.compression_opts, data.shuffle


def read_ply(path):
    """Vertices with their properties, and faces."""
    header, _, body = path.read_bytes().partition(b"end_header\n")
    counts, columns = {}, []
    for line in header.decode().splitlines():
        words = line.split()
        if words[0] == "element":
            counts[words[1]] = int(words[2])
        if words[0] == "property" and words[1] in PLY_TYPES:
            columns.append((words[2], PLY_TYPES[words[1]]))
    vertices = np.frombuffer(body, columns, counts["vertex"])
    faces = np.frombuffer(body, [("n", "u1"), ("corners", "<i4", 3)], counts.get("face", 0), vertices.nbytes)
    assert (faces["n"] == 3).all()
    return vertices, faces["corners"]


class Export(Workspace):
    def export(self, *words, to="all.h5", status=0):
        return self.salbench("export", "--to", self.folder / to, *words, status=status)

    def test_it_says_what_the_cache_says_to_the_bit(self):
        """Values, types, attributes and packing, copied as well as linked."""
        self.configure(SCANS)
        (self.data / "Meshes/3.off").write_text(off(*sphere(40, 20)))  # descriptors large enough to be packed
        self.export()
        self.export("--link", to="links/all.h5")
        self.assertLess((self.folder / "links/all.h5").stat().st_size, (self.folder / "all.h5").stat().st_size / 2)
        for name in ("all.h5", "links/all.h5"):
            with h5py.File(self.folder / name) as file:
                n_scores, n_packed = self.compare(file, name != "all.h5")
                self.assertEqual((n_scores, len(file["scores"])), (2 * 2 * (1 + VIEWS),) * 2)
                self.assertGreater(n_packed, 0)

    def compare(self, file, is_linked):
        rows = {}
        for row in file["scores"][:]:
            item, view = text(row["item"]), text(row["view"])
            rows["scores." + text(row["model"]), f"{item}_{view}" if view else item] = row
        n_scores = n_packed = 0
        for path in segments(self.cache):
            with h5py.File(path) as segment:
                for stage, item in ((stage, item) for stage in segment for item in segment[stage]):
                    artefact, kind = segment[stage][item], stage.partition(".")[0]
                    if kind == "score_table":
                        self.assertNotIn(f"means/{stage}", file)  # its rows are those of /scores
                    elif kind == "scores":
                        row = rows[stage, item]
                        np.testing.assert_array_equal([row[name] for name in SCORES], artefact["scores"][()])
                        self.assertEqual([row["n_points"], row["n_picks"]], list(artefact["counts"][()]))
                        n_scores += 1
                    else:
                        group = file[f"means/{stage}/{item}" if kind in ("reference", "mean_histogram") else f"{item}/{stage}"]
                        self.assertEqual((set(artefact), text(group.attrs["stage"])), (set(group), stage))
                        self.assertTrue(NAMED <= set(group.attrs) if is_linked else NAMED == set(group.attrs))
                        for name, data in artefact.items():
                            copy = group[name]
                            self.assertEqual((data.dtype, data.shape, data[()].tobytes()), (copy.dtype, copy.shape, copy[()].tobytes()), copy.name)
                            self.assertEqual((dict(data.attrs), packing(data)), (dict(copy.attrs), packing(copy)), copy.name)
                            self.assertEqual(set(copy.attrs), {"unit", "description"})
                            n_packed += copy.compression == "gzip"
        return n_scores, n_packed

    def test_its_configuration_can_be_run_again_and_the_same_is_the_same_bytes(self):
        self.export()
        with h5py.File(self.folder / "all.h5") as file:
            said = {name: text(value) for name, value in file.attrs.items()}
            self.assertEqual(text(file["1"].attrs["dataset"]), "meshes")
        self.assertTrue(said["program"].startswith("salbench "))
        self.assertEqual(said["protocol"], "published")
        self.assertRegex(said["stage_versions"], "(?s)fpfh: .*map.PS: ")
        before = (self.folder / "all.h5").read_bytes()
        self.configure(said["configuration"])
        self.salbench("run")
        self.assertEqual(self.computed(), 0)
        self.configure(MESHES)
        self.forget()
        self.export("--threads", "1")
        self.assertEqual((self.folder / "all.h5").read_bytes(), before)

    def test_it_says_what_maps_were_matched_to(self):
        def told(*words):
            self.export(*words)
            with h5py.File(self.folder / "all.h5") as file:
                return text(file.attrs["reference"])

        self.salbench("run")
        table = self.out / "mean_histograms_meshes.csv"
        over_all, of_the_export = "mean over all items of the data set or split", "mean over the items of the export"
        for words, expected in (((), of_the_export), (("--items", "1-2"), of_the_export), (("--items", "2"), over_all),
                                (("--items", "2", "--stage", "map"), over_all), (("--items", "2", "--reference", "items"), of_the_export),
                                (("--items", "2", "--reference", table), "given by --reference")):
            self.assertEqual(told(*words), expected, words)
        for part in ("Distributions", "RawData"):
            for file in (self.data / part).iterdir():
                file.unlink()
        self.assertEqual(told(), "none")

    def test_items_stages_and_pictures_are_chosen(self):
        arrays = []

        def chosen(*words):
            self.export(*words)
            arrays.clear()
            with h5py.File(self.folder / "all.h5") as file:
                file.visititems(lambda name, entry: arrays.append(name) if isinstance(entry, h5py.Dataset) else None)
            return sum(name.endswith("/picture/primitive") for name in arrays)

        chosen("--items", "2", "--stage", "normals, map")
        self.assertEqual(sorted(arrays), ["2/map.PS/saliency", "2/map.RS/saliency", "2/normals/normals"])
        self.configure(SCANS)
        self.assertEqual([chosen(), chosen("--pictures", "--items", "2"), chosen()], [0, 1 + VIEWS, 1 + VIEWS], "it has them from then on")
        with h5py.File(self.folder / "all.h5") as file:
            self.assertEqual((file["2/picture/primitive"].shape, file["2_5/picture/weights"].shape), ((400, 400), (400, 400, 3)))

    def test_shapes_have_the_values_of_the_export(self):
        self.configure(SCANS)
        self.export("--format", "ply", to="shapes")
        self.export()
        with h5py.File(self.folder / "all.h5") as file:
            names = [name for name, item in file.items() if "dataset" in item.attrs]
            self.assertEqual(len(names), 2 * (1 + VIEWS))
            for name in names:
                self.compare_ply(self.folder / f"shapes/{name}.ply", file[name])

    def compare_ply(self, path, item):
        is_mesh = "mesh" in item
        vertices, corners = read_ply(path)
        points, normals = (item["mesh/vertices"], item["normals/normals"]) if is_mesh else (item["scan/points"], item["scan_normals/normals"])
        truth = item["ground_truth" if is_mesh else "scan_ground_truth"]
        fields = {"ground_truth": truth["saliency"][:], "picks": np.bincount(truth["picks"][:], minlength=len(points))}
        for stage in item:
            if stage.partition(".")[0] in ("map", "matched"):
                fields[stage.replace(".", "_")] = item[stage]["saliency"][:]
        np.testing.assert_array_equal(corners, item["mesh/faces" if is_mesh else "surface/faces"])
        for axis, name in enumerate("xyz"):
            np.testing.assert_array_equal(vertices[name], points[:, axis])
            np.testing.assert_array_equal(vertices[f"n{name}"], normals[:, axis].astype("f4"))
        self.assertEqual(set(vertices.dtype.names), {"x", "y", "z", "nx", "ny", "nz", *fields})
        for name, values in fields.items():
            np.testing.assert_array_equal(vertices[name], values.astype("f4"), name)

    def test_it_takes_the_place_of_no_file_of_the_user(self):
        thesis = self.write("thesis.txt", "years of work")
        self.assertIn("is there, and no HDF5 file; choose another", self.export(to="thesis.txt", status=2).stderr)
        self.write("empty.h5")
        for _ in range(2):
            self.export(to="empty.h5")  # and that of an earlier call
        self.export("--format", "maps", to="maps")
        maps = (self.folder / "maps/PS").rename(self.folder / "maps/MINE")
        read = self.export("--format", "maps", "--maps", maps, "--name", "MINE", "--stage", "matched", to="maps", status=2)
        self.assertIn("the maps of MINE are read from there; choose another", read.stderr)
        self.export("--format", "ply", to="ply")
        (self.folder / "link").symlink_to("ply")
        self.configure("dataset: {scans: false, layout: folder, participants: simulated}\nmodels: {PS: }\n")
        kept = [thesis, maps / "1.val", self.folder / "ply/1.ply"]
        before = [file.read_bytes() for file in kept]
        for to in ("ply", "ply/.", "link"):
            self.assertIn("is read from there; choose another", self.export("--data", self.folder / "ply", "--format", "ply", to=to, status=2).stderr)
        self.assertEqual([file.read_bytes() for file in kept], before)

    def test_no_two_things_have_one_name(self):
        self.configure(SCANS)
        (self.data / "Meshes/1_3.off").write_text(off())
        for form in ("h5", "ply", "maps"):
            self.assertIn("would be called '1_3'", self.export("--format", form, to="x", status=2).stderr)
            self.assertFalse(Path(self.folder / "x").exists())
