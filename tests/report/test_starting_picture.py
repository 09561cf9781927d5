"""The report shows what the shaft starts with, both ways, where it is known."""

import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import numpy as np
from report_example import given_controls, make_design, zero_ripple_controls

from camring.presentation import records as data
from camring.report.pictures.starting import starting_figures

ANGLE = np.linspace(0, 0.26, 500)


def with_start(design, least, backwards):
    """The design with starts that swing by a tenth above their least."""
    swing = 1 + 0.05 * (1 + np.cos(24 * ANGLE))
    start = data.Start(ANGLE, least * swing, backwards * swing, 1.25 * least)
    return replace(design, results=tuple(replace(each, start=start) for each in design.results))


def test_both_directions_are_drawn_with_their_least_and_its_share():
    given = with_start(make_design("given", given_controls(), 0.47), 800.0, 790.0)
    best = with_start(make_design("best", zero_ripple_controls(), 0.46), 900.0, 880.0)
    forward, backward = starting_figures([given, best], 1)
    for figure in (forward, backward):
        ElementTree.fromstring(figure.picture)
        assert figure.picture.count('class="curve') >= 2
    assert "given: 800.0 N·m (80.0 % of ideal), best: 900.0 N·m (80.0 % of ideal)" in (
        forward.sentence
    )
    assert "790.0 N·m (79.0 % of ideal)" in backward.sentence


def test_nothing_is_drawn_where_a_start_is_not_known():
    design = make_design("motor", given_controls(), 0.47)
    assert starting_figures([design], 0) == []
