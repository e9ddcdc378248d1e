"""Clouds as text, in any usual format."""

import numpy as np
import pytest

from symjax.errors import FileFormatError
from symjax.io.points import read_points
from tests.helpers.cloud_files import put


@pytest.mark.parametrize(
    ("text", "in_note"),
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
def test_usual_text_formats_are_read(tmp_path, text, in_note):
    back, note = read_points(put(tmp_path, "a.csv", text.encode()))
    np.testing.assert_array_equal(back, [[1, 2, 3], [4, 5, 6]])
    assert in_note in note
    assert in_note or note == "cloud of 2 points"


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("1,2,3,4\n5,6,7\n8,9,10,11\n", "line 2: expected 4 columns as in line 1, found 3 in '5,6,7'"),
        ("1 2 3\n4 5 67 8 9\n", "line 2: expected 3 columns as in line 1, found 5 in '4 5 67 8 9'"),
        ("x;y;z\n1;2\n3;4;5\n", "line 3: expected 2 columns as in line 2, found 3 in '3;4;5'"),
        ("1.5;2;3\n1,500;2;3\n", "line 2: '1,500;2;3' has a decimal comma, but other numbers have decimal points"),
        ("x y z\n", "it contains no points, only a header line: 'x y z'"),
        ("x y z w\n1 2\n", "line 2: expected at least 3 columns .x y z., found 2 in '1 2'"),
        ("# scan\n\na b c x y z\n1 2 three\n", "line 4: expected a number in column 3, found 'three'"),
        ('label,x,y,z\n"a, b",1,2,3\nc,4,5,six\n', "line 3: expected a number in column 4, found 'six'"),
    ],
)
def test_the_line_of_a_bad_row_is_named(tmp_path, text, why):
    with pytest.raises(FileFormatError, match=why):
        read_points(put(tmp_path, "a.txt", text.encode()))
