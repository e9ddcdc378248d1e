"""The status of a solver as numbers and as sentences."""

import numpy as np

from symjax.l2e.status import Status, sentences


def test_every_number_has_its_sentence_and_a_batch_an_array_of_them():
    assert [member.value for member in Status] == list(range(len(Status)))
    for member in Status:
        assert sentences(member) == sentences(np.int32(member)) == member.sentence
    found = sentences(np.array([[Status.FLAT, Status.SUCCESSFUL]]))
    assert found.tolist() == [[Status.FLAT.sentence, Status.SUCCESSFUL.sentence]]


def test_a_sentence_says_first_whether_the_solve_converged():
    assert [member for member in Status if member.sentence.startswith("Converged")] == [Status.SUCCESSFUL]
