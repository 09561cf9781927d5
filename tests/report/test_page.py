"""The page as a whole: complete, closed in itself, and honest about its verdict."""

import re
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from html.parser import HTMLParser
from math import pi

import numpy as np
import pytest
import report_example as example

from camring.drawing import palette
from camring.files.quantities import QUANTITIES
from camring.presentation.records import ReportData, Verdict
from camring.report.figure import around
from camring.report.page import render
from camring.report.pictures.cam import pitch_curve, working_surface
from camring.report.pictures.search import pareto

VOID = {"meta", "link", "input", "br", "hr", "img"}


@pytest.fixture(scope="module")
def study() -> ReportData:
    return example.make_report()


@pytest.fixture(scope="module")
def page(study) -> str:
    return render(study)


@pytest.fixture(scope="module")
def lone(study) -> str:
    """The report of a single motor: simulated, not searched."""
    return render(
        replace(
            study,
            designs=study.designs[:1],
            constraints=(),
            variables=(),
            search=None,
            verdict=None,
            sensitivities=(),
            provenance=replace(study.provenance, best_text=""),
        )
    )


class Reader(HTMLParser):
    """Checks that every element closes, and collects what the page refers to."""

    def __init__(self):
        super().__init__()
        self.open, self.ids, self.links, self.sources, self.text = [], [], [], [], []

    def handle_starttag(self, tag, attributes):
        held = dict(attributes)
        if "id" in held:
            self.ids.append(held["id"])
        if "href" in held:
            self.links.append(held["href"])
        self.sources += [held[key] for key in ("src", "srcset", "data", "action") if key in held]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        assert self.open, f"</{tag}> closes nothing"
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] not in ("script", "style"):
            self.text.append(data)


def read(page: str) -> Reader:
    reader = Reader()
    reader.feed(page)
    reader.close()
    assert reader.open == []
    return reader


def drawings(page: str) -> list[str]:
    return re.findall(r"<svg.*?</svg>", page, flags=re.DOTALL)


def test_every_element_closes_and_every_id_is_unique(page, lone):
    for each in (page, lone):
        ids = read(each).ids
        assert len(ids) == len(set(ids))


def test_the_page_asks_no_network_for_anything(page):
    reader = read(page)
    assert reader.sources == []
    assert all(link.startswith(("#", "data:,")) for link in reader.links)
    assert set(re.findall(r"https?://[^\"' )]+", page)) == {"http://www.w3.org/2000/svg"}
    assert not re.search(r"@import|url\((?!#)|fetch\(|XMLHttpRequest|import\(", page)


def test_links_inside_the_page_lead_somewhere(page):
    reader = read(page)
    ids = set(reader.ids)
    assert {link[1:] for link in reader.links if link.startswith("#")} <= ids
    assert set(re.findall(r"url\(#([\w-]+)\)", page)) <= ids


def test_every_drawing_is_valid_xml_without_holes(page, lone):
    for each in (page, lone):
        found = drawings(each)
        assert len(found) > 15
        for svg in found:
            ElementTree.fromstring(svg)
            numbers = re.sub(r"<(title|desc|text)\b.*?</\1>", "", svg, flags=re.DOTALL)
            assert not re.search(r"\b(nan|inf|None)\b", numbers)


def test_every_picture_has_a_title_a_sentence_and_words_for_the_blind(page):
    figures = re.findall(r"<figure.*?</figure>", page, flags=re.DOTALL)
    assert len(figures) > 20
    for figure in figures:
        assert re.search(r"<h3>.+?</h3>", figure)
        sentence = re.search(r"<figcaption>(.+?)</figcaption>", figure, flags=re.DOTALL)[1]
        assert sentence.endswith(".")
        assert 20 < len(sentence) < 500
        assert "<title" in figure
        assert "<desc" in figure


def test_the_file_is_small_enough_to_mail(page):
    assert len(page.encode()) < 2_000_000


def test_the_same_data_give_the_same_page(study, page):
    assert render(study) == page


def test_everything_a_reviewer_asks_for_is_there(page):
    text = " ".join(read(page).text)
    for wanted in (
        "Wheel motor, 0.4 L/rev",
        "Validated",
        "Torque ripple, true rms",
        "Highest contact stress",
        "Margins to the limits",
        "Inner dead centre, magnified",
        "Which orders survive",
        "orders 24, 48, 72",
        "% of mean supply flow",
        "Power balance",
        "Leave-one-out",
        "Convergence of the search",
        "Periodicity residual",
        "Numerical error: how far a finer resolution and an independent solver are",
        "by SciPy's stiff solver: largest difference 4.4e-06, in lowest contact force",
        "wheel_motor.toml",
        "0.10.2",
        "seed",
    ):
        assert wanted in text, wanted


def test_the_tiles_tell_of_every_operating_point(study, page):
    tiles = page[page.index('class="keys"') : page.index("</dl>")]
    assert len(study.designs[-1].results) > 1
    for result in study.designs[-1].results:
        assert result.point.name in tiles
    ripple = [design.results[1].metrics["torque_ripple"] for design in study.designs]
    first, last = (QUANTITIES["torque_ripple"].written(value) for value in ripple)
    assert f"{first} → {last} %" in tiles


def test_text_from_files_is_shown_and_never_obeyed(page):
    assert "<0.4 L/rev>" not in page
    assert "&lt;0.4 L/rev&gt; &amp; friends" in page


def test_a_report_that_is_not_validated_says_why(study):
    verdict = Verdict(False, "The gain in ripple shrinks to 2 % at finer resolution.")
    page = render(replace(study, verdict=verdict))
    assert "Not validated" in page
    assert "shrinks to 2 %" in page
    assert "✓" not in page


def test_a_broken_limit_is_said_in_words(study):
    broken = replace(study.constraints[0], margins=(0.04, -0.07))
    page = render(replace(study, constraints=(broken, *study.constraints[1:])))
    assert "One limit is broken" in page
    assert "a limit is broken" in page
    assert "broken by 7.0 %" in page
    assert "−7.0 % broken" not in page


def test_a_lone_motor_is_not_compared_with_anything(lone):
    text = " ".join(read(lone).text)
    assert "simulation report" in text
    for absent in ("better", "best", "Validated", "Search"):
        assert absent not in text, absent


def test_three_motors_stand_side_by_side(study):
    third = replace(study.designs[1], label="third")
    several = replace(
        study, designs=(*study.designs, third), constraints=(), search=None, verdict=None
    )
    page = render(several)
    read(page)
    assert "comparison" in page
    assert ">Third</th>" in page


def test_without_its_script_the_page_hides_nothing(page):
    body = page[: page.index("<script>")]
    assert not re.search(r"<div[^>]*\shidden", body)
    assert body.count('class="operating-point"') >= 2
    style = re.search(r"<style>(.*?)</style>", page, flags=re.DOTALL)[1]
    on_screen = style[: style.index("@media print")]
    hiding = re.findall(r"([^{}]+)\{[^{}]*display: none", on_screen)
    # What the script alone can work (its buttons) may be hidden until it is there.
    allowed = (".scripted", ".operating-points", ".controls", ".readout:empty")
    assert [rule for rule in hiding if not any(word in rule for word in allowed)] == []


def test_a_single_operating_point_needs_no_choice(study):
    designs = tuple(replace(d, results=d.results[:1]) for d in study.designs)
    page = render(replace(study, designs=designs))
    assert 'class="operating-points"' not in page
    assert 'class="operating-point"' not in page


def test_a_free_ring_is_drawn_over_the_whole_turn(study):
    ring = []
    for design in study.designs:
        facts = replace(design.facts, repeats=1)
        profile = _whole_turn(design.profile)
        results = tuple(replace(r, waves=_whole_turn(r.waves)) for r in design.results)
        ring.append(replace(design, facts=facts, profile=profile, results=results))
    page = render(replace(study, designs=tuple(ring)))
    assert 'data-x-label="Shaft angle"' in page
    assert len(page.encode()) < 2_000_000
    for svg in drawings(page):
        ElementTree.fromstring(svg)


def _whole_turn(record):
    values = vars(record)
    angle = values["angle"]
    fields = {name: around(angle, v, 0, 2 * pi - 1e-9)[1] for name, v in values.items()}
    fields["angle"] = around(angle, angle, 0, 2 * pi - 1e-9)[0]
    return type(record)(**fields)


def test_numbers_that_do_not_exist_leave_a_dash(study):
    first = study.designs[0]
    metrics = {**first.results[0].metrics, "pressure_ripple": float("nan")}
    metrics.pop("jerk_objective")
    results = (replace(first.results[0], metrics=metrics), *first.results[1:])
    page = render(replace(study, designs=(replace(first, results=results), study.designs[1])))
    read(page)
    assert "–" in page


def test_the_working_surface_lies_one_roller_radius_outside(study):
    design = study.designs[1]
    inside = np.stack(pitch_curve(design.profile))
    surface = np.stack(working_surface(design.profile, design.facts.roller_radius))
    np.testing.assert_allclose(
        np.hypot(*(surface - inside)), design.facts.roller_radius, rtol=1e-12
    )
    # No other roller position reaches the surface: the nearest pitch point is one radius away.
    away = np.hypot(*(surface[:, ::50, None] - inside[:, None, :])).min(axis=1)
    np.testing.assert_allclose(away, design.facts.roller_radius, rtol=1e-3)


def test_around_lays_periods_end_to_end():
    angle = np.linspace(0, 1, 11)
    long_angle, values = around(angle, np.sin(2 * pi * angle), -0.3, 2.2)
    assert long_angle[0] <= -0.3
    assert long_angle[-1] >= 2.2
    assert (np.diff(long_angle) > 0).all()
    np.testing.assert_allclose(values, np.sin(2 * pi * long_angle), atol=1e-12)


def test_nobody_beats_a_design_on_the_front():
    random = np.random.default_rng(3)
    x, y = random.random(200), random.random(200)
    front = pareto(x, y)
    for k in range(200):
        beaten = ((x <= x[k]) & (y <= y[k]) & ((x < x[k]) | (y < y[k]))).any()
        assert front[k] == (not beaten)


def test_an_undercut_ring_has_gaps_and_a_sentence_and_no_false_margin(study):
    design = study.designs[1]
    results = []
    for result in design.results:
        stress = result.waves.contact_stress.copy()
        stress[100:140] = np.nan
        metrics = {**result.metrics, "max_contact_stress": float("nan")}
        waves = replace(result.waves, contact_stress=stress)
        results.append(replace(result, waves=waves, metrics=metrics))
    unknown = replace(study.constraints[0], margins=(0.04, float("nan")))
    page = render(
        replace(
            study,
            designs=(study.designs[0], replace(design, results=tuple(results))),
            constraints=(unknown, *study.constraints[1:]),
        )
    )
    assert "the ring is undercut" in page
    assert "some margins are unknown" in page
    for svg in drawings(page):
        ElementTree.fromstring(svg)


def test_a_simulation_that_failed_is_still_drawn(study):
    """Geometry stands; all that hangs on pressure is not a number."""
    hollow = (
        "chamber_pressure supply_flow return_flow leakage_flow contact_force contact_stress torque"
    )
    designs = []
    for design in study.designs:
        results = []
        for result in design.results:
            nothing = {name: np.full_like(result.waves.angle, np.nan) for name in hollow.split()}
            results.append(
                replace(
                    result,
                    waves=replace(result.waves, **nothing),
                    metrics=dict.fromkeys(result.metrics, float("nan")),
                    torque_amplitudes=np.full_like(result.torque_amplitudes, np.nan),
                    flow_amplitudes=np.full_like(result.flow_amplitudes, np.nan),
                )
            )
        designs.append(replace(design, results=tuple(results)))
    page = render(replace(study, designs=tuple(designs)))
    read(page)
    for svg in drawings(page):
        ElementTree.fromstring(svg)
    assert "NaN" not in page[: page.index("<script>")]


def test_a_supply_line_has_its_rows_and_its_piece_of_the_loss_bar(study, page):
    """Rare results: shown for a motor with a manifold, absent for one without."""
    rows = ("Loss in the supply line", "Supply pressure, peak to peak")
    assert not any(row in page for row in rows)
    assert palette.LOSSES["line_loss"] not in page
    first, second = study.designs
    with_line = render(replace(study, designs=(_fed(first, 512.0, 3e5), _fed(second, 0.0, 0.0))))
    assert all(row in with_line for row in rows)
    bars = [svg for svg in drawings(with_line) if "Where the power goes" in svg]
    assert len(bars) == len(first.results)
    for bar in bars:
        assert bar.count(palette.LOSSES["line_loss"]) == 2  # the key and one design's piece
        assert "loss in the supply line" in bar
        assert "512 W" in bar


def _fed(design, line_loss, swing):
    """The design with what a supply line would add to its results."""
    more = {"line_loss": line_loss, "supply_pressure_swing": swing}
    results = (replace(each, metrics={**each.metrics, **more}) for each in design.results)
    return replace(design, results=tuple(results))
