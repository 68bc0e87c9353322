# SPDX-License-Identifier: GPL-3.0-or-later
"""Maps that other programs wrote: what a command may leave in place of one, and HDF5 files with a map per shape."""

import sys
from pathlib import Path

import h5py
import numpy as np
import toy
from salbench.runs import hooks
from salbench.shapes.shape import Shape
from salbench.system import hdf5
from salbench.system.errors import InputError

POINTS = np.random.default_rng(7).random((6, 3))


def by_python(code, file):
    return f'{sys.executable} -c "import h5py, numpy, sys; {code}" {{{file}}}'


# Action before the end, and the expected message.
NO_MAP = {
    "NaN": ("yes nan | head -n 6 > {out}", "finite"),
    "bytes": ("printf '0\\n\\177ELF\\002\\001\\000\\377\\376' > {out}", "out.val:.*is not a number"),
    "a pipe": ("mkfifo {out}", "is not a regular file"), "gigabytes": ("truncate -s 5G {out}", "5368709120 bytes are too many for 6 values"),
    "HDF5 of another shape": (by_python("h5py.File(sys.argv[1], 'w')['x'] = numpy.zeros((3, 2))", "out.h5"),
                              r"its shape is \(3, 2\), expected one value"),
    "NumPy of another shape": (by_python("numpy.save(sys.argv[1], numpy.zeros((3, 2)))", "out.npy"),
                               r"out.npy: not a .npy .*: its shape is \(3, 2\)"),
    "a closed input": ("exec 0<&-; exec 1>&-; exit 3", "status 3"), "a removed input": ("rm {mesh}; exit 3", "status 3"),
}

# Files with maps "1" and "2", the first of which is replaced.
UNREADABLE = {
    "it claims 8796093022208 bytes": lambda file: file.create_dataset("1", (1 << 40,), "f8", chunks=(16,)),
    "and 0 are stored": lambda file: file.create_dataset("1", (1 << 40,), "f4"),
    "bytes of values, and 0 are stored": lambda file: file.create_dataset("1", (1 << 32, 1 << 32), "f8", chunks=(1, 1)),
    "20 dimensions": lambda file: file.create_dataset("1", (1,) * 20, "f8"),
    "in other files": lambda file: file.create_dataset("1", (6,), "f8", external=[("/dev/zero", 0, 48)]),
    "no values": lambda file: file.create_dataset("1", data=h5py.Empty("f8")),
}


def with_links(file):
    file["g/up"], file["soft"], file["out"] = file["/"], h5py.SoftLink("/nowhere"), h5py.ExternalLink("/dev/zero", "/")


# Objects allowed beside the maps. An attribute with many numbers was once read into the space for one.
BESIDE = {
    "many numbers": lambda file: file["1"].attrs.update(unit=np.ones(4096), description=7),
    "a record": lambda file: file["1"].attrs.update(record=np.zeros(500, [("a", "i4"), ("b", "f8")])),
    "references": lambda file: file["1"].attrs.update(none=h5py.Empty("f8"), reference=file["1"].ref),
    "many numbers of groups": lambda file: (file.attrs.update(many=np.ones(4096)), file.create_group("g").attrs.update(many=np.ones(4096))),
    "data sets of other types": lambda file: file.update({"3": "a text", "4": np.zeros(2, [("a", "i4")]), "5": h5py.Empty("f8")}),
    "links": with_links,
}


class Maps(toy.InAFolder):
    def setUp(self):
        super().setUp()
        self.shape = Shape("1", POINTS, np.array([[0, 1, 2], [3, 4, 5]], np.int32))
        self.addCleanup(hooks.finish)

    def file(self, change):
        path = self.folder / "maps.h5"
        with h5py.File(path, "w") as file:
            file["1"] = file["2"] = np.arange(6.0)
            change(file)
        return str(path)

    def test_what_a_command_leaves_in_place_of_one_is_named(self):
        for name, (line, said) in NO_MAP.items():
            command = hooks.command("MINE", f"test {{mesh}}; {line}", 600.0, [])
            with self.subTest(name), self.assertRaisesRegex(InputError, said) as caught:
                command.map(self.shape, 0)
            self.assertLess(len(str(caught.exception)), 6000)

    def test_one_with_a_list_that_has_answered_is_asked_for_each_shape(self):
        """Some take longer than others, and who has answered flushes. An answer is the name of the shape's own file."""
        mark = self.folder / "answered"
        line = f'while read -r mesh out; do test -e {mark} && sleep 100; touch {mark}; seq 6 > "$out"; echo "$out"; done < {{list}}'
        command = hooks.command("MINE", line, 0.5, [])
        command.map(self.shape, 0)
        for _ in range(4):
            self.assertRaisesRegex(InputError, "longer than its timeout", command.map, self.shape, 0)
        other = hooks.command("MINE", 'while read -r mesh out; do seq 6 > "$out"; echo "$out.npy"; echo " $out"; done < {list}', 0.5, [])
        self.assertRaisesRegex(InputError, "longer than its timeout", other.map, self.shape, 0)

    def test_an_hdf5_file_of_another_program_is_read_as_far_as_it_goes(self):
        def made_anew(make):
            return lambda file: (file.__delitem__("1"), make(file))

        for said, make in UNREADABLE.items():
            path = self.file(made_anew(make))
            with self.subTest(said), self.assertRaises(InputError) as caught:
                hdf5.map_in(path, "1")
            self.assertIn(said, str(caught.exception))
            self.assertNotIn("\n", str(caught.exception))
            np.testing.assert_array_equal(hdf5.map_in(path, "2"), np.arange(6.0))
        for name, change in BESIDE.items():
            path = self.file(change)
            with self.subTest(name):
                self.assertEqual([one for one in hdf5.names_in(path) if one in "12"], ["1", "2"])
                np.testing.assert_array_equal(hdf5.map_in(path, "1"), np.arange(6.0))

    def test_a_file_that_is_none_is_refused(self):
        cut = self.folder / "cut.h5"
        cut.write_bytes(Path(self.file(lambda _: None)).read_bytes()[:1000])
        with self.assertRaisesRegex(InputError, f"^{cut}: "):
            hooks.names_of_maps(str(cut))
