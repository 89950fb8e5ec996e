"""Remedies and the terms that they lower."""

from erlif.core.remedies import REMEDIES
from erlif.core.terms import SOURCES, TERMS


def test_a_fixture_after_the_run_lowers_what_lies_between_both():
    between = {key for key, term in TERMS.items() if term.between}
    assert set(REMEDIES["fixture_after"].leaves) == between


def test_each_term_that_a_file_states_has_a_remedy():
    stated = {key for key, term in TERMS.items() if term.file and not term.of_two}
    assert {key for remedy in REMEDIES.values() for key in remedy.leaves} == stated


def test_what_remains_is_a_width_a_source_or_a_share():
    for remedy in REMEDIES.values():
        for left in remedy.leaves.values():
            assert left in SOURCES or 0 <= float(left) < 1


def test_texts_fit_the_table_of_the_terminal():
    assert max(len(remedy.what) for remedy in REMEDIES.values()) <= 40
