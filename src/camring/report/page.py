"""The page: head, sections in reading order, style and script inside."""

from collections.abc import Callable, Sequence
from importlib.resources import files

from camring.drawing.strips import patterns
from camring.drawing.svg import element, escape
from camring.presentation.limits import MARGIN_BASES
from camring.presentation.records import ReportData
from camring.report import tables
from camring.report.figure import Figure
from camring.report.head import head
from camring.report.pictures.cam import cam_figures
from camring.report.pictures.contact import contact_figures
from camring.report.pictures.envelope import letters, margin_figures, ripple_figures
from camring.report.pictures.losses import loss_figure
from camring.report.pictures.machine import machine_figure
from camring.report.pictures.margins import margin_figure, plain_name
from camring.report.pictures.motion import motion_figures
from camring.report.pictures.pressure import pressure_figures
from camring.report.pictures.search import convergence_figure, pareto_figure
from camring.report.pictures.sensitivity import tornado_figures
from camring.report.pictures.starting import starting_figures
from camring.report.pictures.torque import torque_figures

__all__ = ["render"]


def _asset(name: str) -> str:
    return files("camring.report").joinpath(name).read_text(encoding="utf-8")


def plate(figure: Figure | None) -> str:
    """One figure as markup; nothing for a figure that had nothing to show."""
    if figure is None:
        return ""
    shape = " ".join(word for word in ("wide", "tall") if getattr(figure, word))
    return element(
        "figure",
        element("h3", escape(figure.title)),
        element("div", figure.picture, class_="picture"),
        element("figcaption", escape(figure.sentence)),
        class_=shape or None,
        id=f"figure-{figure.name}",
    )


def plates(figures: Sequence[Figure | None]) -> str:
    drawn = "".join(plate(figure) for figure in figures)
    return element("div", drawn, class_="plates") if drawn else ""


def _by_point(data: ReportData, content: Callable[[int], str]) -> str:
    """One block for each operating point; the script shows one at a time, paper all."""
    points = [result.point for result in data.designs[-1].results]
    if len(points) == 1:
        return content(0)
    blocks = []
    if not any(contents := [content(k) for k in range(len(points))]):
        return ""
    for k, point in enumerate(points):
        title = element(
            "h3", escape(f"Operating point {k + 1}: {point.name}"), class_="operating-point-name"
        )
        blocks.append(
            element("div", title, contents[k], class_="operating-point", data_operating_point=k)
        )
    return "".join(blocks)


def _results(data: ReportData) -> str:
    parts = [_by_point(data, lambda k: tables.result_table(data.designs, k))]
    shares = [r.metrics.get("volumetric_efficiency", 0.0) for d in data.designs for r in d.results]
    if max(shares) > 1:
        parts.append(element("p", _ABOVE_ONE, class_="lead small"))
    return "".join(parts)


_ABOVE_ONE = (
    "A volumetric efficiency above 100 %: between the ports the piston presses the oil in its "
    "chamber up to supply pressure itself, so the supply port need not deliver it. The shaft "
    "pays for that, in the hydromechanical efficiency. With the constant oil flow is counted by "
    "volume at port and chamber pressure alike, which makes the number larger still."
)


def _limits(data: ReportData) -> str:
    figure = margin_figure(data.constraints, data.designs)
    if figure is None:
        return element("p", "The motor file sets no limits.", class_="lead")
    table = element(
        "details",
        element("summary", "The same as a table"),
        tables.constraint_table(data.constraints, data.designs),
    )
    return plates([figure]) + element("p", MARGIN_BASES, class_="lead small") + table


def _envelope(data: ReportData) -> str:
    envelope = data.envelope
    if envelope is None:
        return ""
    conditions, same = envelope.conditions()
    keys = ", ".join(
        element("b", letter) + escape(f" {plain_name(name)}")
        for name, letter in letters(envelope).items()
    )
    about = _IN_ENVELOPE if envelope.asked else _WITHOUT_ENVELOPE
    text = escape(f"{about.format(envelope.span)} {_CELLS} ") + f"{keys}. {same}".strip()
    figures = [
        figure
        for pictures in (margin_figures, ripple_figures)
        for row, condition in enumerate(conditions)
        for figure in pictures(envelope, row, condition)
    ]
    sentences = "".join(
        element("li", element("b", escape(f"{each.label}: ")) + escape(f"{each.sentence}."))
        for each in envelope.designs
    )
    return "".join(
        (
            "" if envelope.asked else element("ul", sentences, class_="lead small"),
            element("p", text, class_="lead small"),
            plates(figures),
            tables.envelope_table(envelope),
        )
    )


_IN_ENVELOPE = "The range in which the motor must keep every limit: {}."
_WITHOUT_ENVELOPE = (
    "The motor file has no [envelope], so nothing was asked outside its operating points. This is "
    "how its designs do from a tenth to all of their pressure: {}."
)
_CELLS = (
    "Each cell is one point, with the letter of the limit that binds there and its margin in per "
    "cent of the limit's own scale; a cell framed in red breaks it."
)


def _cam(data: ReportData) -> str:
    return plates(cam_figures(data.designs))


def _machine(data: ReportData) -> str:
    return _by_point(data, lambda k: plates([machine_figure(data.designs, k)]))


def _motion(data: ReportData) -> str:
    return _by_point(data, lambda k: plates(motion_figures(data.designs, k)))


def _pressure(data: ReportData) -> str:
    return _by_point(data, lambda k: plates(pressure_figures(data.designs, k)))


def _torque(data: ReportData) -> str:
    def figures(point: int) -> list[Figure]:
        return [*torque_figures(data.designs, point), *starting_figures(data.designs, point)]

    return _by_point(data, lambda k: plates(figures(k)))


def _power(data: ReportData) -> str:
    return _by_point(data, lambda k: plates([loss_figure(data.designs, k)]))


def _contact(data: ReportData) -> str:
    return _by_point(data, lambda k: plates(contact_figures(data.designs, k, data.constraints)))


_MODES = (
    "“cam cos k” and “cam sin k” are harmonic k of the lobe, added to the control radii with "
    "this amplitude."
)


def _search(data: ReportData) -> str:
    if data.search is None:
        return ""
    parts = [plates([convergence_figure(data.search), pareto_figure(data)])]
    if data.variables:
        parts.append(tables.variable_table(data.variables, data.designs))
        if any(variable.name.startswith("cam ") for variable in data.variables):
            parts.append(element("p", _MODES, class_="lead small"))
    if data.search.leave_one_out:
        parts.append(tables.leave_one_out_table(data.search))
    parts += [element("p", escape(note), class_="lead small") for note in data.search.notes]
    return "".join(parts)


def _sensitivity(data: ReportData) -> str:
    return plates(tornado_figures(data.sensitivities))


_AGREES = "Agreement of the "  # as verdicts.py words it
_APART = (
    "Numerical error: how far a finer resolution and an independent solver are from the "
    "simulation in any result, relative"
)


def _numerical_error(data: ReportData) -> str:
    """The last design's, in words; empty where nobody looked twice."""
    if data.verdict is None:
        return ""
    best = f"{_AGREES}{data.designs[-1].label} motor "
    said = [
        f"{check.name.removeprefix(best)}: {check.detail}"
        for check in data.verdict.checks
        if check.name.startswith(best)
    ]
    return "; ".join(said)


def _validation(data: ReportData) -> str:
    parts = []
    verdict = data.verdict
    if verdict is not None and verdict.views:
        parts.append(tables.view_table(verdict))
    if verdict is not None and verdict.checks:
        agreement = [check for check in verdict.checks if check.name.startswith(_AGREES)]
        if agreement:
            parts.append(tables.check_table(agreement, _APART))
        passed = sum(check.passed for check in verdict.checks)
        text = f"{passed} of {len(verdict.checks)} checks passed"
        parts.append(
            element(
                "details",
                element("summary", text),
                tables.check_table(verdict.checks, "All checks"),
                # What failed is not to be folded away.
                open=None if passed == len(verdict.checks) else "open",
            )
        )
    parts.append(tables.error_table(data))
    return "".join(parts)


def _provenance(data: ReportData) -> str:
    source = data.provenance
    pairs = [("Date", source.date), ("Motor file", source.input_name)]
    pairs += [*source.settings.items(), ("Numerical error", _numerical_error(data))]
    pairs += source.versions.items()
    parts = [tables.pairs_table([p for p in pairs if p[1]])]
    for title, text in (
        ("The motor file as given", source.input_text),
        ("The best motor as a motor file", source.best_text),
    ):
        if text:
            parts.append(
                element(
                    "details", element("summary", title), element("pre", escape(text), tabindex=0)
                )
            )
    return "".join(parts)


_SECTIONS: tuple[tuple[str, str, Callable[[ReportData], str]], ...] = (
    ("machine", "The machine", _machine),
    ("results", "Results", _results),
    ("limits", "Limits", _limits),
    ("envelope", "Envelope", _envelope),
    ("cam", "Cam ring", _cam),
    ("motion", "Piston motion", _motion),
    ("pressure", "Chamber pressure", _pressure),
    ("torque", "Torque", _torque),
    ("power", "Power", _power),
    ("contact", "Roller contact", _contact),
    ("search", "Search", _search),
    ("sensitivity", "Sensitivity", _sensitivity),
    ("validation", "Checks", _validation),
    ("provenance", "Provenance", _provenance),
)


def _point_buttons(data: ReportData) -> str:
    points = [result.point for result in data.designs[-1].results]
    if len(points) == 1:
        return ""
    buttons = [
        element(
            "button",
            escape(point.name),
            type="button",
            data_operating_point=k,
            aria_pressed="false",
        )
        for k, point in enumerate(points)
    ]
    label = element("span", "Operating point")
    return element(
        "div",
        label,
        *buttons,
        class_="operating-points",
        role="group",
        aria_label="Operating point",
    )


def render(data: ReportData) -> str:
    """The whole report as one HTML text; the same data give the same text."""
    contents, sections = [], []
    for name, title, content in _SECTIONS:
        body = content(data)
        if not body:
            continue
        contents.append(element("li", element("a", escape(title), href=f"#{name}")))
        heading = element("h2", element("span", str(len(contents)), class_="count") + escape(title))
        sections.append(element("section", heading, body, id=name))
    navigation = element(
        "nav", element("ol", *contents), _point_buttons(data), aria_label="Contents"
    )
    body = element(
        "div",
        element("a", "Skip to the results", href="#results", class_="skip"),
        head(data),
        navigation,
        element("main", *sections),
        element("footer", escape(_foot(data))),
        class_="sheet",
    )
    return "".join(
        (
            '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f"<title>{escape(data.title)}: design report</title>",
            # An empty icon, or browsers would ask a server for one.
            '<link rel="icon" href="data:,">',
            f"<style>{_asset('report.css')}</style></head>\n<body>",
            patterns(),
            body,
            f"<script>{_asset('report.js')}</script></body></html>\n",
        )
    )


def _foot(data: ReportData) -> str:
    version = data.provenance.versions.get("camring", "")
    made = f"Made by camring {version}".rstrip()
    date = f" on {data.provenance.date}" if data.provenance.date else ""
    return f"{made}{date}. This file holds everything it shows and asks no network for anything."
