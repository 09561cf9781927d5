"""Figures: every axis says its unit, nothing of matplotlib's is changed, holes stay holes."""

import builtins
import re
import subprocess
import sys
from dataclasses import replace

import matplotlib
import numpy as np
import pytest
from motor_files import SOUND

import camring
from camring import plots
from camring.analyses.grid import Axis, Grid
from camring.files.errors import InputError
from camring.files.motor import parse_motor_file
from camring.files.result_names import result_names
from camring.programs.compiled import simulate

UNIT = re.compile(r"(^|, )(mm|cm³|deg|bar|kN|rpm|L/min|N·m|%|–)( \(absolute\))?$")
WITHOUT_UNIT = {"Order, per shaft revolution"}


@pytest.fixture(scope="module")
def cycles():
    system = parse_motor_file(SOUND).system
    return [simulate(system.motor, system.fluid, point) for point in system.operating_points]


def grid(shape=(12, 9)):
    """A map of smooth results with lift-off in one corner and a hole in another."""
    axes = (
        Axis("operating_points.speed", "rpm", np.linspace(10, 300, shape[0])),
        Axis("operating_points.supply_pressure", "bar", np.linspace(50, 350, shape[1])),
    )
    x, y = np.meshgrid(np.linspace(0, 1, shape[0]), np.linspace(0, 1, shape[1]), indexing="ij")
    results = dict.fromkeys(result_names(), 0.5 + 0.4 * x * (1 - y))
    results["min_contact_force"] = 1e3 * (y - 0.3 * x - 0.1)
    results["vapour_margin"] = 1e5 * (1 - x + y - 0.2)
    faults = np.zeros(shape, int)
    faults[0, -1] = 1
    results = {name: np.where(faults == 0, values, np.nan) for name, values in results.items()}
    return Grid(axes, results, faults, {"max_pressure": 0.7}, "A motor\nreturn 10 bar")


def line_grid():
    whole = grid()
    results = {name: values[:, 3] for name, values in whole.results.items()}
    return replace(whole, axes=whole.axes[:1], results=results, faults=whole.faults[:, 3])


FIGURES = {
    "waveforms": lambda cycles: plots.waveforms(*cycles),
    "one cycle": lambda cycles: plots.waveforms(cycles[0]),
    "torque": lambda cycles: plots.torque(*cycles, labels=("fast", "slow")),
    "pressure_volume": lambda cycles: plots.pressure_volume(*cycles),
    "spectrum": lambda cycles: plots.spectrum(*cycles),
    "flow spectrum": lambda cycles: plots.spectrum(cycles[0], of="supply_flow"),
    "cam": lambda cycles: plots.cam(cycles[0].motor),
    "efficiency_map": lambda cycles: plots.efficiency_map(grid()),
    "ripple_map": lambda cycles: plots.ripple_map(grid()),
    "sweep": lambda cycles: plots.sweep_curves(line_grid(), ["efficiency", "max_pressure"]),
}


@pytest.mark.parametrize("name", FIGURES)
def test_every_axis_says_its_unit(name, cycles):
    before = dict(matplotlib.rcParams)
    figure = FIGURES[name](cycles)
    assert figure.axes
    for axes in figure.axes:
        labels = [axes.get_ylabel(), axes.get_xlabel()]
        said = [label for label in labels if label and label not in WITHOUT_UNIT]
        assert said, "an axis without a label"
        assert all(UNIT.search(label) for label in said), said
    assert figure.axes[-1].get_xlabel() or figure.axes[0].get_xlabel()
    assert dict(matplotlib.rcParams) == before


def test_curves_are_distinguished_by_more_than_colour(cycles):
    lines = plots.torque(*cycles).axes[0].get_lines()
    assert len({line.get_linestyle() for line in lines}) == 2
    assert len({line.get_color() for line in lines}) == 2


def test_torque_is_drawn_with_the_mean_that_the_summary_has(cycles):
    from camring.programs.compiled import summarise

    words = plots.torque(cycles[0], labels=["one"]).axes[0].get_legend().get_texts()[0].get_text()
    said = float(re.search(r"mean ([\d.e+]+) N·m", words)[1])
    assert said == pytest.approx(float(summarise(cycles[0]).mean_torque), rel=1e-3)


def test_the_loop_encloses_the_work_of_a_piston(cycles):
    """`<torque of pressure> = Np NL/(2 pi)` times the loop integral of p dV."""
    line = plots.pressure_volume(cycles[1]).axes[0].get_lines()[0]
    volume, pressure = (np.asarray(values) for values in line.get_data())
    work = 1e-6 * 1e5 * np.sum((pressure[1:] + pressure[:-1]) / 2 * np.diff(volume))
    motor = cycles[1].motor
    torque = motor.pistons * motor.lobes / (2 * np.pi) * work
    assert torque == pytest.approx(float(camring.summarise(cycles[1]).mean_torque), rel=0.01)


def test_limits_and_holes_are_in_the_legend_of_a_map():
    said = [text.get_text() for text in plots.efficiency_map(grid()).legends[0].get_texts()]
    assert said[:2] == ["roller lifts off", "oil cavitates"]
    assert said[-1] == "no result"
    assert any(words.startswith("limit: highest chamber pressure") for words in said)


def test_the_envelope_is_framed_where_the_map_goes_beyond_it():
    figure = plots.efficiency_map(replace(grid(), envelope=((30.0, 300.0), (70.0, 350.0))))
    (frame,) = (patch for patch in figure.axes[0].patches if patch.get_label() == "envelope")
    assert frame.get_bbox().extents.tolist() == [30, 70, 300, 350]
    assert "envelope" in [text.get_text() for text in figure.legends[0].get_texts()]
    inside = plots.efficiency_map(replace(grid(), envelope=((5.0, 300.0), (50.0, 400.0))))
    assert not [patch for patch in inside.axes[0].patches if patch.get_label() == "envelope"]


def labels_of(figure):
    """Of a drawn map: the numbers on its contours, where they stand, and the picture's box."""
    figure.canvas.draw()
    axes = figure.axes[0]
    return axes.texts, [text.get_window_extent() for text in axes.texts], axes.bbox


def side_in(box, frame):
    """Whether a side of a frame runs through a box."""
    (left, bottom), (right, top) = frame
    across = any(box.x0 < side < box.x1 for side in (left, right)) and box.y1 > bottom
    up = any(box.y0 < side < box.y1 for side in (bottom, top)) and box.x1 > left
    return (across and box.y0 < top) or (up and box.x0 < right)


@pytest.mark.parametrize("name", ["efficiency", "torque_ripple"])
def test_numbers_on_contours_are_whole_apart_and_read_from_one_side(name):
    framed = replace(grid((40, 40)), envelope=((30.0, 250.0), (70.0, 300.0)))
    figure = plots.result_map(framed, name)
    texts, boxes, picture = labels_of(figure)
    assert len(texts) >= 4
    frame = figure.axes[0].transData.transform([(30, 70), (250, 300)])
    for place, box in enumerate(boxes):
        assert not side_in(box, frame)
        assert picture.x0 <= box.x0
        assert box.x1 <= picture.x1
        assert picture.y0 <= box.y0
        assert box.y1 <= picture.y1
        assert not any(box.overlaps(other) for other in boxes[place + 1 :])
    assert all(not 180 < text.get_rotation() <= 280 for text in texts)


def test_numbers_on_contours_stand_beside_what_is_written_over_them():
    from matplotlib.figure import Figure

    from camring.plots.contours import label_places

    axes = Figure(figsize=(5, 4)).subplots()
    steps = np.linspace(0, 1, 21)
    lines = axes.contour(steps, steps, np.add.outer(steps, steps), [1.0])
    words = axes.text(0.5, 0.5, "drives\nforwards", ha="center", va="center", fontsize=12)
    box = words.get_window_extent()
    ((x, y),) = axes.transData.transform(label_places(axes, lines, 8))
    assert box.contains(x, y)
    ((x, y),) = axes.transData.transform(label_places(axes, lines, 8, words=[words]))
    assert not box.contains(x, y)


def test_a_map_goes_into_axes_of_the_callers(cycles):
    from matplotlib.figure import Figure

    figure = Figure()
    left, right = figure.subplots(1, 2)
    assert plots.result_map(grid(), "mean_torque", axes=left) is figure
    plots.torque(cycles[0], axes=right)
    assert right.get_ylabel() == "Shaft torque, N·m"


def test_a_name_is_no_formula(cycles, tmp_path):
    named = replace(grid(), title="boo $\\frac{$ x\nreturn 10 bar")
    plots.save(plots.efficiency_map(named), tmp_path / "map.svg")
    plots.save(plots.torque(cycles[0], labels=("a$_{$",)), tmp_path / "torque.svg")
    plots.save(plots.waveforms(cycles[0], labels=("a$_{$",)), tmp_path / "waves.svg")


def test_maps_of_two_motors_have_one_scale():
    """Each level stands for one colour, and a panel without a contour says its range."""
    better = grid()
    better.results["efficiency"][:] = 0.97 + 0.001 * better.results["efficiency"]
    figure = plots.result_maps([grid(), better], "efficiency")
    left, right, _ = figure.axes
    fills = [
        next(each for each in axes.collections if len(each.get_facecolor()) > 2)
        for axes in (left, right)
    ]
    assert fills[0].levels.tolist() == fills[1].levels.tolist()
    assert fills[0].norm.boundaries.tolist() == fills[1].norm.boundaries.tolist()
    assert [text.get_text() for text in right.texts] == ["97.05 to 97.09 %"]
    assert not left.texts or "to" not in left.texts[0].get_text()


def test_a_result_that_is_the_same_everywhere_is_said_so():
    even = grid()
    even.results["stroke"][:] = 0.0118
    figure = plots.result_map(even, "stroke")
    assert any("11.8 mm everywhere" in text.get_text() for text in figure.axes[0].texts)


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_a_picture_is_saved_by_its_ending_and_twice_the_same(tmp_path, ending):
    first = plots.save(plots.efficiency_map(grid()), tmp_path / f"a.{ending}")
    second = plots.save(plots.efficiency_map(grid()), tmp_path / f"b.{ending}")
    assert first.read_bytes() == second.read_bytes()
    assert {path.name for path in tmp_path.iterdir()} == {f"a.{ending}", f"b.{ending}"}


def test_a_notebook_shows_a_figure_without_pyplot():
    assert plots.ripple_map(grid())._repr_png_().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("draw", "words"),
    [
        (lambda place: plots.save(plots.ripple_map(grid()), place / "a.gif"), "end it in .png"),
        (lambda place: plots.save(plots.ripple_map(grid()), place / "b" / "a.png"), "not exist"),
        (lambda place: plots.sweep_curves(grid(), ["efficiency"]), "needs one number that varies"),
        (lambda place: plots.result_map(line_grid(), "efficiency"), "needs two numbers"),
        (lambda place: plots.waveforms(), "without a cycle"),
    ],
)
def test_what_cannot_be_drawn_is_refused_in_a_sentence(tmp_path, draw, words):
    with pytest.raises(InputError, match=words):
        draw(tmp_path)


def test_a_missing_matplotlib_names_the_extra(monkeypatch):
    found = builtins.__import__
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ImportError, match=r'pip install "camring\[plot\]"'):
        plots.require_matplotlib()
    assert builtins.__import__ is found


def test_matplotlib_is_not_loaded_before_a_figure_is_asked_for():
    program = (
        "import sys, camring; camring.plots; camring.operating_map; camring.sweep\n"
        "print('matplotlib' in sys.modules, 'matplotlib.pyplot' in sys.modules)\n"
        "camring.plots.torque\n"
        "print('matplotlib' in sys.modules, 'matplotlib.pyplot' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.stdout.split() == ["False", "False", "True", "False"]
