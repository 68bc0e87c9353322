# SPDX-License-Identifier: GPL-3.0-or-later
"""Columns of texts of numbers."""

import unittest

import numpy as np

from salbench.datasets import _numbers
from salbench.datasets._layout import Indices, Values
from salbench.datasets._order import Elements
from salbench.datasets._values import read_picks, read_values
from salbench.datasets.records import InputError
from support import NAN

VERTICES, FACES = Elements(4), Elements(4, "mesh", "face", "faces")


def outcome(text, columns, unseen="", elements=None):
    """The columns as lists, or the message."""
    data = text if isinstance(text, bytes) else text.encode()
    try:
        return [column.tolist() for column in _numbers.read_columns(data, "a.csv", columns, unseen, elements)]
    except InputError as error:
        return str(error)


class Texts(unittest.TestCase):
    def expect(self, expected, text, *columns, unseen="", elements=None):
        found = outcome(text, columns, unseen, elements)
        if isinstance(expected, str):
            self.assertEqual(found, f"a.csv:{expected}", text)
        else:
            np.testing.assert_array_equal(found, [expected] if len(columns) == 1 else expected, err_msg=repr(text))


class Numbers(Texts):
    def test_columns_by_number_or_name(self):
        self.expect([2, 4], "1,2\n3,4\n", "2")
        self.expect([2, 4], 'x,"saliency"\r\n1,2\r\n\r\n3,4\r\n', "saliency")
        self.expect([1], "x y\n1 2\n", "1")
        self.expect([-2, 4], "1.5e0\t-2 \n+3\t4", "2")
        self.expect([2, 4], "1; 2\n3; 4", "2")
        self.expect([7], "\ufeffvalue\n7\n", "value")
        self.expect([1, 2], "1\r2\r", "1")
        for text in ("1\r2\r3\n", "1\r\n2\n3\r", "1\r2\n3", "1\n\r2\r\r3\r\n\n"):  # each line ends in its own way
            self.expect([1, 2, 3], text, "1")
        self.expect("3: \"x\" is not a number", "1\r2\nx\r\n", "1")
        self.expect([1, 2], "saliency\n1\n2\n", "")
        self.expect([[4, 8], [1, 5], [2, 6]], "x y z s\n1 2 3 4\n5 6 7 8", "s", "x", "2")
        self.expect([1e-320, 5e-324, 0], "1e-320\n5e-324\n0e-999\n", "")
        self.expect([1], "1" + "0" * 350 + "e-350\n", "")

    def test_what_was_not_seen(self):
        self.expect([NAN, 0, NAN], "-1\n0\n-1.0\n", "", unseen="-1")
        self.expect([NAN, 0, NAN], "nan\n0\nNaN\n", "", unseen="nan")
        self.expect([NAN, 0], "x,s\n1,-nan\n2,0\n", "s", unseen="NaN")
        self.expect([[NAN, 0], [1, 2]], "s x other\nNAN 1 nan\n0 2 3\n", "s", "x", unseen="nan")
        self.expect([5, 4], "s other\n5 nan\n4 inf\n", "s")
        self.expect('2: "nan" is not a finite number', "5\nnan\n", "", unseen="-1")
        self.expect('2: "NaN" is not a finite number', "s,x\nnan,NaN\n", "s", "x", unseen="nan")
        self.expect('2: "na" is not a number', "nan\nna\n", "", unseen="nan")

    def test_file_line_and_what_was_expected(self):
        alone = ("the line has 2 columns, expected one value: keep that column alone, or name it in the description (`column:`)")
        self.expect('1: no column "saliency": the header has "x", "s"', "x,s\n1,2\n", "saliency")
        self.expect('1: no column "saliency": the first line has numbers, not names of columns', "1,2\n", "saliency")
        advice = "write decimal commas, if these are some, as points"
        self.expect(f"2: 1 column, but the first line has 2: {advice}", "1 2\n3\n", "2")
        self.expect(f"3: 1 column, but the first line has 2: {advice}", "x,s\n1,2\n3\n", "s")
        self.expect(f"1: {alone}", "1,2\n", "")
        self.expect(f"1: {alone}", "1,2.5\n", "")
        self.expect('2: "x" is not a number', "1\nx\n", "1")
        self.expect('1: "" is not a number', "1,\n2,3\n", "2")
        self.expect("3: the file has 2 values, but the mesh has 3 faces", "1\n\n2\n", "1", elements=Elements(3, "mesh", "face", "faces"))
        self.expect("1: the file has no values", "s\n", "1")
        self.expect(" the file has no values", "", "1")

    def test_words_that_are_no_numbers(self):
        for word, wrong in [("inf", "is not a finite number"), ("1e999", "is not a finite number"), ("+-1", "is not a number"), ("1_000", "is not a number"),
                            ("0x1", "is not a number"), ("1e", "is not a number"), (".", "is not a number"), ("--1", "is not a number"),
                            ("nan", "is not a finite number"), ("1\0", "is not a number"), ("\u0661", "is not a number"),
                            ("1\v", "is not a number"), ("1.#INF", "is not a number"), ("1\x1c", "is not a number"), ("1\xa0", "is not a number"), ("-1.#IND", "is not a number"), ("1.#QNAN", "is not a number"),
                            ("1.#SNAN", "is not a number"), ("-1.#INF00e+000", "is not a number"), ("-1.#J", "is not a number"), ("0.5#1", "is not a number")]:
            if "#" in word:
                self.assertRegex(outcome(f"{word}\n1\n", ("",)), rf'^a\.csv:1: ".*" {wrong}$')
            found = outcome(f"1,2\n{word},2\n", ("1",))
            if word != "1\v":  # a blank between words
                self.assertRegex(found, rf'^a\.csv:2: ".*" {wrong}$')

    def test_quotes_hold_a_cell_together(self):
        for text, column, expected in [
                ('"a,b",0.5\n"c, d",0.25\n', "2", [0.5, 0.25]), ('"x","s"\n"a ""q"", b","0.5"\n', "s", [0.5]), ('"a;b";1\n', "2", [1]),
                ('"x"  "the s"\n"1"\t0.5 \n', "the s", [0.5]), ('x,s\n5" pipe,1\n6",2\n', "s", [1, 2]),
                ('"a\tb"\t1\n', "2", [1]), ('# "one, two",s\n"1",2\n', "one, two", [1]), ('s\n"1"\n"2"\n', "", [1, 2]), ('# 5" pipes\n1\n', "", [1]),
                ('"1,5";2\n', "2", [2]), ('id,s\n1,"2",\n', "s", [2]), ('1, "2"\n', "2", [2])]:
            self.expect(expected, text, column)

    def test_quotes_that_hold_no_number_together(self):
        comma, quotes = " is not a number: write its decimal comma as a point", "but the first line has 2: close each quote on its line"
        for text, column, wrong in [
                ('"1,2","5,2"\n', "2", f'1: "5,2"{comma}'), ('"1,2","5,2"\n', "1", f'1: "1,2"{comma}'), ('x,s\n1,"0,5"\n', "s", f'2: "0,5"{comma}'),
                ('"1,2"\n"3,4"\n', "", f'1: "1,2"{comma}'), ('x,s\n\n"a,1\nb,2\n', "s", f"3: 1 column, {quotes}"),
                ('x,s\na,1\n"b"c,2\n', "s", f"3: 1 column, {quotes}"), ('x,s\n"two\nlines",1\n', "s", f"2: 1 column, {quotes}"),
                ('1,"2"3\n', "2", "1: the line has 1 column, expected column 2"), ("a,1\nb,1\xa0\n", "2", '2: "1??" is not a number')]:
            self.expect(wrong, text, column)

    def test_words_in_other_columns_may_have_any_bytes(self):
        for text in ("name,s\n\u00c5\u0160,1\n\xe0,2\n", "name s\n\u00c5\u0160 1\n\xe0 2\n", "name\ts\n\0\t1\n\x1c\t2\n"):
            self.expect([1, 2], text, "s")

    def test_commas_that_may_be_decimal_ones_are_named(self):
        wrong = "whole numbers between commas: write decimal commas, if these are some, as points, or name the columns in a first line"
        for column in "12":
            self.expect(f"2: {wrong}", "0,5\n0,05\n", column)
            self.expect(f"3: {wrong}", "0,5\n1,0\n0,7\n", column)
        self.expect(f"1: {wrong}", "-0,125,1,01,2,5,0,75\n", "4")
        for text, column, expected in [("0,5\n1,7\n", "2", [5, 7]), ("id,s\n007,0.5\n1,05\n", "s", [0.5, 5]), ("007,0.5\n011,1\n", "2", [0.5, 1]),
                                       ("x,s\n0,5\n0,7\n", "s", [5, 7]), ("1, 2,3\n1, 5,6\n", "2", [2, 5])]:
            self.expect(expected, text, column)

    def test_decimal_commas_are_named(self):
        for text, column, line, word in [("saliency\n0,5\n", "", 2, "0,5"), ("1\n-0,5e-3\n", "1", 2, "-0,5e-3")]:
            self.expect(f'{line}: "{word}" is not a number: write its decimal comma as a point', text, column)
        for separator in ";\t":
            named = ': "0,5" is not a number: write its decimal comma as a point'
            self.expect(f"1{named}", f"0,5{separator}1\n", "1")
            self.expect(f"1{named}", f"1{separator}0,5\n1{separator}0,7\n", "2")
            self.expect(f"2{named}", f"x{separator}s\n0,5{separator}7\n", "x")

    def test_a_first_row_of_numbers_is_no_header_whatever_names_are_in_it(self):
        self.expect([[3, 4], [1, 2]], "cat,1,3\ndog,2,4\n", "3", "2")
        self.expect([2], "cat,x,3\ndog,2,4\n", "2")
        self.expect([1, 2], "cat,1\ndog,2\n", "2")

    def test_lines_end_in_lf_crlf_or_cr_wherever_they_stand(self):
        for text in ("1\n2\n3", "1\r\n2\r\n3\r\n", "1\r2\r3\r", "1\r2\r3\n", "1\n2\r3\r\n", "1\r\r\n2\n\r3"):
            self.expect([1, 2, 3], text, "")
            self.expect([1, 2, 3], text.replace("1", "x,s\n9,1").replace("2", "9,2").replace("3", "9,3"), "s")


class RowsOfElements(Texts):
    """A column that numbers the elements is obeyed."""

    def test_by_its_name(self):
        expected = [0, 0.1, 0.2, 0.3]
        for name in ("vertex", "index", "id", "Vertex ID", "vertex_index", "VertexIdx", "point", "nr", "", "Unnamed: 0"):
            header = f"{name},saliency\n"
            self.expect(expected, header + "2,0.2\n0,0\n3,0.3\n1,0.1\n", "saliency", elements=VERTICES)
            self.expect(expected, header + "2,0.1\n1,0\n4,0.3\n3,0.2\n", "2", elements=VERTICES)
            self.expect(expected, header + "2.0,0.2\n0e0,0\n3,0.3\n1,0.1\n", "", elements=VERTICES)
        self.expect(expected, "s;vertex\n.2;2\n0;0\n.3;3\n.1;1\n", "", elements=VERTICES)

    def test_in_a_comment_as_numpy_writes_it(self):
        rows = "2 0.2\n0 0\n3 0.3\n1 0.1\n"
        self.expect([0, 0.1, 0.2, 0.3], "# vertex saliency\n" + rows, "saliency", elements=VERTICES)
        self.expect([0, 0.1, 0.2, 0.3], "# vertex saliency\n# of mesh 52, by gaze\n" + rows, "2", elements=VERTICES)
        self.expect([0.2, 0, 0.3, 0.1], "# of mesh 52, by gaze\n" + rows, "2", elements=VERTICES)
        self.expect('2: no column "saliency": the first line has numbers, not names of columns', "# gaze, of 52\n1 2\n", "saliency")

    def test_the_one_named_after_the_elements_first(self):
        rows = "0,9,2,0.2\n1,9,0,0\n2,9,3,0.3\n3,9,1,0.1\n"
        self.expect([0, 0.1, 0.2, 0.3], ",id,vertex,s\n" + rows, "s", elements=VERTICES)
        self.expect([0, 0.1, 0.2, 0.3], "vertex,x,face,s\n" + rows, "s", elements=FACES)
        self.expect([0.2, 0, 0.3, 0.1], "vertex,x,face,s\n" + rows, "s", elements=VERTICES)
        self.expect([2, 0, 3, 1], "x,y,id,s\n" + rows, "id", elements=VERTICES)
        self.expect([9, 7, 8], "vertex,x\n2,9\n0,7\n1,8\n", "x")

    def test_other_numbers_are_refused(self):
        rest = "; it numbers the vertices, expected each number from 0 to 3, or from 1 to 4, once: correct it, or rename it if it is something else"
        for rows, wrong in [("0,1\n1,1\n1,1\n3,1\n", "4: has 1 a second time"), ("1,1\n2,1\n0,1\n4,1\n", "5: has 4"),
                            ("1,1\n2,1\n3,1\n5,1\n", "5: has 5"), ("2,1\n3,1\n4,1\n5,1\n", "5: has 5"), ("0,1\n1.5,1\n2,1\n3,1\n", "3: has 1.5"),
                            ("-1,1\n1,1\n2,1\n3,1\n", "2: has -1"), ("1e300,1\n1,1\n2,1\n3,1\n", "2: has 1e+300")]:
            line, what = wrong.split(": ")
            self.expect(f'{line}: column "vertex" {what}{rest}', "vertex,s\n" + rows, "s", elements=VERTICES)
        self.expect('2: "v0" is not a number', "vertex,s\nv0,1\n1,1\n2,1\n3,1\n", "s", elements=VERTICES)
        self.expect("4: the file has 3 values, but the mesh has 4 vertices", "vertex,s\n0,1\n1,1\n2,1\n", "s", elements=VERTICES)
        self.expect('1: columns "id" and "index" both number the vertices: rename one', "id,index,s\n0,0,1\n", "s", elements=VERTICES)


class Picks(unittest.TestCase):
    def test_order_and_repetitions_are_kept(self):
        for text, base, expected in [(b"7\r\n0\r\n7\r\n", 0, [7, 0, 7]), (b"", 0, []), (b"# from 0\n7 # here\n+0\n", 0, [7, 0]),
                                     (b"7 #here\r0\r\n#1\n", 0, [7, 0]), (b"7\r0\n7\r\n1", 0, [7, 0, 7, 1]),
                                     (b"1\n8\n", 1, [0, 7])]:
            self.assertEqual(read_picks(text, "9_0.pid", Indices(base), Elements(8)).tolist(), expected)

    def test_file_and_line_of_a_bad_pick(self):
        for text, base, wrong in [
                (b"7\n8\n", 0, ":2: vertex 8 is out of range: the mesh has 8 vertices, numbered from 0"),
                (b"-1\n", 0, ":1: vertex -1 is out of range"),
                (b"3\n0\n", 1, ":2: vertex 0 is out of range: the mesh has 8 vertices, numbered from 1"), (b"1.5\n", 0, ':1: "1.5" is not a whole'),
                (b"1 2\n", 0, ":1: the line has more than one value"), (b"99999999999999999999\n", 0, "does not fit 64 bits"),
                (b"1_0\n", 0, "is not a whole number"), (b"7\n1#2\n", 0, ':2: "1#2" is not a whole'), (b"1.#INF", 0, ':1: "1.#INF" is not'),
                (b"-1.#IND 0", 0, ':1: "-1.#IND" is not'), (b"7 0#1\n", 0, ":1: the line has more than one value")]:
            with self.assertRaisesRegex(InputError, wrong):
                read_picks(text, "9_0.pid", Indices(base), Elements(8))


class Samples(unittest.TestCase):
    def test_lie_where_meshes_may(self):
        values = Values("point", "4")
        self.assertEqual(read_values(b"1 2 3 0.5\n-1e50 0 0 1e308\n", "9.csv", values, Elements(8))[0].tolist(), [0.5, 1e308])
        for far in ("1e51", "-1e300", "1.7e308"):
            for row in ("{} 0 0 1", "0 {} 0 1", "0 0 {} 1"):
                text = f"x y z s\n\n0 0 0 1\n{row.format(far)}\n0 0 0 1\n".encode()
                with self.assertRaisesRegex(InputError, "9.csv:4: a coordinate is larger than 1e50: scale the mesh"):
                    read_values(text, "9.csv", values, Elements(8))
