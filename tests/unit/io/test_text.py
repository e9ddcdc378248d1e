"""Clouds as text, in any usual dress."""

import numpy as np
import pytest

from symjax.errors import FileFormatError
from symjax.io.points import read_points
from tests.helpers.cloud_files import put


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("x,y,z\n1,2,3\n4,5,6\n", ""),
        ("# a comment\n\n1 2 3\n# another\n  4   5\t6\n", ""),
        ("1;2;3\r\n4;5;6\r\n", ""),
        ("1,0;2,0;3,0\n4,0;5,0;6,0\n", "decimal commas"),
        ("1;2;3\n4,0;5;6,0\n", "decimal commas"),
        ("name;x;y;z\nno. 1;1;2;3\nno. 2;4,0;5;6\n", "decimal commas"),
        ("// x y z r\n1 2 3 9\n4 5 6 9\n", "4 columns, of which x, y, z"),
        ('"a, b",x,y,z\n"1, 2",1,2,3\n"3",4,5,6\n', "x, y, z by name"),
        ("1, 2, 3,\n4, 5, 6,\n", ""),
        ("//X Y Z R\n1 2 3 9\n4 5 6 9\n", "4 columns, of which x, y, z"),
        ("id,z,name,y,x\n7,3,chair,2,1\n8,6,table,5,4\n", "5 columns, of which x, y, z by name"),
        ("a b c d\n1 2 3 red\n4 5 6 blue\n", "4 columns, of which the first 3"),
        ('"x","y","z"\n"1","2","3"\n"4","5","6"\n', ""),
        ("\ufeffx y z\n1e0 2.0 +3\n.4e1 5. 6\n", ""),
        ("1 2 3\r4 5 6", ""),
    ],
)
def test_text_of_many_shapes(tmp_path, text, said):
    back, note = read_points(put(tmp_path, "a.csv", text.encode()))
    np.testing.assert_array_equal(back, [[1, 2, 3], [4, 5, 6]])
    assert said in note
    assert said or note == "cloud of 2 points"


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("1,2,3,4\n5,6,7\n8,9,10,11\n", "row 2 of its data, '5,6,7', has 3 columns: 4 expected"),
        ("1 2 3\n4 5 67 8 9\n", "row 2 of its data, '4 5 67 8 9', has 5 columns: 3 expected"),
        ("x;y;z\n1;2\n3;4;5\n", "row 2 of its data, '3;4;5', has 3 columns: 2 expected"),
        ("1.5;2;3\n1,500;2;3\n", "decimal points and commas in one file .row 2 of its data is '1,500;2;3'"),
        ("x y z\n", "no points: one line only, 'x'"),
        ("x y z w\n1 2\n", "2 column.s. in '1 2': at least 3 expected"),
        ("a b c x y z\n1 2 three\n", "row 1 of its data is '1 2 three': 3 numbers expected"),
    ],
)
def test_rows_that_are_no_points_are_named(tmp_path, text, why):
    with pytest.raises(FileFormatError, match=why):
        read_points(put(tmp_path, "a.txt", text.encode()))
