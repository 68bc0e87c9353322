# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of numbers in texts; a number per line or per element, in texts and in NumPy's .npy."""

import io

import numpy as np

from salbench.datasets.reading import read_values, values
from salbench.datasets.records import InputError
from salbench.datasets.tables import numbers, require
from support import NAN, WithArchive, npy


class Numbers(WithArchive):
    def outcome(self, text, columns):
        path = self.write({"a.csv": text})
        try:
            return numbers(path, columns)
        except InputError as error:
            self.assertNotIn("\n", str(error))
            return str(error).removeprefix(f"{path}:")

    def expect(self, expected, text, columns=None):
        found = self.outcome(text, columns)
        if isinstance(expected, str):
            self.assertEqual(found, expected, repr(text))
        else:
            np.testing.assert_array_equal(found, np.atleast_2d(expected) if np.ndim(expected) == 2 else np.array([expected]).T, err_msg=repr(text))

    def test_columns_by_number_or_name(self):
        table = [[1, 2], [3, 4]]
        for text in ("1,2\n3,4\n", "1 2\n3\t4", "1;2\r\n\r\n3; 4\r\n", "1\t2\r3\t4\r", "# c\n1,2\n# d\n3,4", "x,y\n1,2\n3,4\n", '"1","2"\n"3","4"\n', "1,2,\n3,4,\n", "1,2\n3,4,\n",
                     " 1.0e0  +2\n 3 4 \n", "\ufeffx y\n1 2\n3 4\n", "1\t2\t\n3\t4\t\n", "id x\n1 2\n3 4"):
            self.expect(table, text)
            self.expect(table, text, 2)
        for text in ('x,"saliency"\r\n1,2\r\n\r\n3,4\r\n', "saliency other\n2 x\n4 y\n", "a;saliency;b\nx;2;0,5\ny;4;0,5\n", '"x","saliency"\n"a, b",2\n"c",4\n',
                     "# vertex saliency\n1 2\n3 4\n", "# vertex saliency\n# of mesh 52, by gaze\n1 2\n3 4\n", "name\tsaliency\n\0\t2\n\xe0\t4\n"):
            self.expect([2, 4], text, ["saliency"])
        self.expect([[4, 1], [8, 5]], "x y z s\n1 2 3 4\n5 6 7 8", ["s", "x"])
        self.expect([1, 2, 3], "1\r2\n3\r\n", 1)
        self.expect([7], "value\n7\n", 1)

    def test_what_numpy_reads(self):
        self.expect([NAN, NAN, np.inf, -np.inf, np.inf], "nan\n-NaN\ninf\n-Infinity\n1e999\n")
        self.expect([1e-320, 5e-324, 0, 1], "1e-320\n5e-324\n0e-999\n1" + "0" * 350 + "e-350\n")

    def test_file_line_and_what_was_expected(self):
        advice = ": write decimal commas, if these are some, as points"
        for text, columns, wrong in [
                ("x,s\n1,2\n", ["saliency"], '2: there is no column "saliency"; there are "x", "s"'),
                ("1,2\n", ["saliency"], '1: there is no column "saliency"; the first line has numbers, not names of columns'),
                ("1 2\n3\n", None, "2: the line has 1 columns, the first one 2"), ("x,s\n1,2\n3\n", ["s"], "3: the line has 1 columns, the first one 2"),
                ("x,s\n1,2\n1,0,5\n", ["s"], f"3: the line has 3 columns, the first one 2{advice}"), ("1,2\n", 1, f"1: the line has 2 columns, expected 1{advice}"),
                ("1\n\nx\n", 1, '3: "x" in column 1 is not a number'), ("a,b\n1,\n", 2, f"2: the line has 1 columns, the first one 2{advice}"),
                ("a,b\n,1\n", 2, '2: "" in column "a" is not a number'), ("x,s\n1,2\n3,y\n", 2, '3: "y" in column "s" is not a number'),
                ("vertex,saliency\n0,1\n", 1, '2: the line has 2 columns, expected 1: name it, as in numbers(path, ["saliency"])[:, 0]'),
                ("PK\3\4", None, " is a zip archive, as .npz and .xlsx are, expected text"), ("ply\nformat", 1, " is a PLY file, expected text"),
                ("# x\n\n", None, " the file has no values"), ("", 1, " the file has no values"), ("s\n", 1, " the file has no values"),
                ('x,s\n"two\nlines",1\n', ["s"], "2: the line has 1 columns, the first one 2: close each quote on its line"),
                ('x,s\n"a"b,2\n', ["s"], "2: the line has 1 columns, the first one 2: close each quote on its line")]:
            self.expect(wrong, text, columns)
            if len(text) > 3:
                self.expect(wrong, text.replace("\n", "\r"), columns)

    def test_decimal_commas_are_named(self):
        named = ' is not a number: write its decimal comma as a point'
        for text, columns, wrong in [
                ("saliency\n0,5\n", 1, "2: the line has 2 columns, the first one 1: write decimal commas, if these are some, as points"),
                ("1\n-0,5e-3\n", 1, f'2: "-0,5e-3" in column 1{named}'), ("0,5;1\n", None, f'1: "0,5" in column 1{named}'),
                ("x\ts\n1\t0,5\n", ["s"], f'2: "0,5" in column "s"{named}'),
                ('x,s\n1,"0,5"\n', ["s"], f'2: "0,5" in column "s"{named}'), ('"1,2"\n"3,4"\n', 1, f'1: "1,2" in column 1{named}'),
                ("1 0,5\n", 2, '1: "1 0" in column 1 is not a number')]:
            self.expect(wrong, text, columns)

    def test_words_that_are_no_numbers(self):
        for word in ("+-1", "1_000", "0x1", "1e", ".", "--1", "1\0", "\u0661", "1\xa0", "1.#INF", "-1.#IND", "1.#QNAN", "-1.#J", "0.5#1", "1 2", "nan(1)", "1d5"):
            self.assertRegex(str(self.outcome(f"1,2\n{word},2\n", 2)), r'^2: ".*" in column 1 is not a number$', word)
            if word[-1] in "NFJ1_":
                self.assertRegex(str(self.outcome(f"{word},2\n1,2\n", 2)), r'^1: ".*" in column 1 is not a number$', word)

    def test_rows_that_do_not_belong_are_named_by_their_lines(self):
        path = self.write({"a.csv": "# c\nx\n1\n\n5\n# d\n7\n"})
        found = numbers(path, 1)
        require(path, found < 9, "is too large")
        self.assertEqual(self.error_of(require, path, found < 7, "is too large"), "ROOT/a.csv:7: is too large")
        self.assertEqual(self.error_of(require, path, found[:, 0] < 2, "is too large"), "ROOT/a.csv:5: is too large")


TYPES = [order + kind for order in "<>" for kind in ("f2", "f4", "f8", "i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8")]


class Values(WithArchive):
    def test_one_value_per_point_of_any_type_and_shape(self):
        one = np.arange(3.0)
        for array in (one[:, None], one[None], np.asfortranarray(one[:, None]), np.arange(1.0), np.arange(0.0), *map(one.astype, TYPES)):
            self.equal(read_values(self.write({"a.npy": npy(array)})), np.asarray(array, float).ravel())
        file = io.BytesIO()
        np.lib.format.write_array(file, one, (2, 0))
        by_python_2 = npy(one).replace(b"(3,), }  ", b"(3L,), } ")
        for content in (file.getvalue(), by_python_2, "0\n1\n2\n", "values\n0\r\n1\r\n2", "0,\n1,\n2,\n"):
            self.equal(read_values(self.write({"a.txt": content})), one)

    def test_any_other_array_is_refused(self):
        good, begin = npy(np.arange(3.0)), "^ROOT/a.npy: not a .npy file that can be read: "
        for data, wrong in [(npy(np.array([{}, 1], object)), 'Object arrays cannot be loaded'),
                            *((npy(np.ones(3, kind)), "its type is ") for kind in ("c8", "S4", "U4", "M8[s]", "V8", np.longdouble)),
                            (npy(np.zeros((2, 3))), r"its shape is \(2, 3\), expected one value per point"), (npy(np.array([1 << 53, -1 - (1 << 53)])), "it holds whole "),
                            (npy(np.array([1 << 63], "u8")), "it holds whole numbers beyond 2.53: scale them"), (good[:11], "EOF: reading array header"),
                            (good[:-1], r"EOF: reading array data, expected 24 bytes got 23"), (good.replace(b"(3,)", b"(x,)"), "malformed node"),
                            (good.replace(b"(3,)", b"()  "), r"its shape is \(\), expected one value per point"), (good.replace(b"(3,), }   ", b"(999999,)}"), "EOF: .* got 24"),
                            (npy(np.ones(3, bool)), 'its type is "bool", expected float16, float32, float64, or whole numbers'),
                            (good + b"x", r"its shape is \(3,\), and 1 bytes are left behind its values")]:
            self.assertRegex(self.error_of(read_values, self.write({"a.npy": data})), begin + wrong)

    def test_as_many_as_there_are_elements_and_finite(self):
        for content, unseen, expected in [("1\n-1\n3\n", -1, [1, NAN, 3]), ("1\nNaN\n3\n", NAN, [1, NAN, 3]), (npy([1.0, -1, 3]), -1, [1, NAN, 3]),
                                          (npy([1.0, NAN, 3]), NAN, [1, NAN, 3]), ("1\n-1\n3\n", None, [1, -1, 3])]:
            self.equal(values(self.write({"a": content}), 3, unseen), expected)
        for content, place in (("1\n2\ninf\n", "a:3: "), (npy([1, 2, np.inf]), "a: value 2 \\(0-based\\) "), ("# of b\n1\n2\nnan\n", "a:4: ")):
            self.assertRegex(self.error_of(values, self.write({"a": content}), 3, -1.0), place)
        for content in ("1\n2\n", npy([1, 2])):
            self.assertEqual(self.error_of(values, self.write({"a": content}), 3), "ROOT/a: the file has 2 values, but 3 are expected")
        with self.assertRaisesRegex(InputError, "/absent: cannot be read: No such file"):
            values(self.root / "absent", 3)
