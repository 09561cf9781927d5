"""The report's tables: results before and after, variables, checks, search."""

from collections.abc import Iterable, Sequence

import numpy as np

from camring.drawing.svg import element, escape
from camring.files.quantities import GROUPS, Quantity, change, significant
from camring.metrics.efficiency import MOTOR, working_as
from camring.presentation.envelope import WholeEnvelope, worst
from camring.presentation.records import (
    Check,
    Constraint,
    Design,
    ReportData,
    Result,
    Search,
    Variable,
    Verdict,
)
from camring.report.pictures.losses import balance_residual
from camring.report.pictures.margins import plain_name

__all__ = [
    "check_table",
    "constraint_table",
    "envelope_table",
    "error_table",
    "leave_one_out_table",
    "pairs_table",
    "result_table",
    "variable_table",
    "view_table",
]


def _table(
    head: Sequence[tuple[str, str]], rows: Iterable[str], caption: str, kind: str = ""
) -> str:
    """A table; `head` holds (text, class) of the columns, rows are markup."""
    cells = "".join(
        element("th", escape(text), scope="col", class_=style or None) for text, style in head
    )
    table = element(
        "table",
        element("caption", escape(caption)),
        element("thead", element("tr", cells)),
        element("tbody", *rows),
        class_=kind or None,
    )
    return element("div", table, class_="scroll")


def _row(name: str, *cells: tuple[str, str]) -> str:
    head = element("th", escape(name), scope="row")
    return element(
        "tr", head, *(element("td", escape(text), class_=style or None) for text, style in cells)
    )


def result_table(designs: Sequence[Design], index: int) -> str:
    """Every result at one operating point; with two designs also the change."""
    columns = 2 + len(designs) + 2 * (len(designs) == 2)
    rows = []
    for title, group in GROUPS:
        held = [_result_row(q, [d.results[index] for d in designs]) for q in group]
        held = [row for row in held if row]
        if held:
            rows.append(
                element(
                    "tr",
                    element("th", escape(title), scope="rowgroup", colspan=columns, class_="group"),
                )
            )
            rows += held
    head = [("Result", ""), ("Unit", ""), *((d.label.capitalize(), "n") for d in designs)]
    if len(designs) == 2:
        head += [("Change", "n"), ("", "")]
    point = designs[-1].results[index].point
    caption = (
        f"Results at {point.name} supply, {1e-5 * point.return_pressure:.4g} bar return, "
        f"{1e-5 * point.case_pressure:.4g} bar case (absolute)"
    )
    for design in designs:
        metrics = design.results[index].metrics
        works_as = str(working_as(metrics["input_power"], metrics["output_power"]))
        if works_as != MOTOR:
            caption += f"; the {design.label} motor works as a {works_as}"
    return _table(head, rows, caption)


def _result_row(quantity: Quantity, results: Sequence[Result]) -> str:
    values = [result.metrics.get(quantity.name) for result in results]
    if any(value is None for value in values):
        return ""
    numbers = [float(value) for value in values if value is not None]
    if quantity.rare and not any(numbers):
        return ""
    cells = [(quantity.unit, "unit"), *((quantity.written(v), "n") for v in numbers)]
    if len(numbers) == 2:
        text, better = change(quantity, *numbers)
        word, style = {1: ("better", "better"), -1: ("worse", "worse"), 0: ("", "same")}[better]
        cells += [(text, f"n {style}"), (word, style)]
    return _row(quantity.label, *cells)


def constraint_table(constraints: Sequence[Constraint], designs: Sequence[Design]) -> str:
    """Limits with values and margins as text, for readers of numbers and of screens aloud."""
    head = [("Constraint", ""), ("Limit", "")]
    for design in designs:
        head += [(design.label.capitalize(), "n"), ("Margin", "n")]
    rows = []
    for constraint in constraints:
        cells = [(constraint.limit, "unit")]
        for value, margin in zip(constraint.values, constraint.margins, strict=True):
            broken = margin < 0
            text = f"{significant(100 * margin, 3)} %" + (" broken" if broken else "")
            cells += [(value, "n"), (text, "n broken" if broken else "n")]
        rows.append(_row(plain_name(constraint.name), *cells))
    return _table(head, rows, "Limits, worst values over the operating points, and margins")


def envelope_table(envelope: WholeEnvelope) -> str:
    """For each limit its least margin in the envelope, and where."""
    head = [("Limit in the envelope", "")]
    for design in envelope.designs:
        head += [(f"{design.label.capitalize()}, least margin", "n"), ("at", "")]
    rows = []
    for name in envelope.designs[-1].limits:
        cells = []
        for design in envelope.designs:
            values = design.limits.get(name)
            if values is None:
                cells += [("–", "n"), ("", "")]
                continue
            place = worst(values)
            broken = not values[place] <= 0
            margin = f"{significant(-100 * float(values[place]), 3)} %" + " broken" * broken
            cells += [(margin, "n broken" if broken else "n"), (envelope.place(place), "unit")]
        rows.append(_row(plain_name(name), *cells))
    return _table(head, rows, "The least margin of each limit in the envelope, and where")


def variable_table(variables: Sequence[Variable], designs: Sequence[Design]) -> str:
    """Design variables with bounds and values; a little bar shows where between them."""
    labels = [d.label.capitalize() for d in designs]
    head = [("Variable", ""), ("Unit", ""), ("From", "n"), ("To", "n")]
    head += [(label, "n") for label in labels]
    head.append(("Place between the bounds", ""))
    rows = []
    for variable in variables:
        cells = [
            element("td", escape(variable.unit), class_="unit"),
            element("td", escape(_plainly(variable.low)), class_="n"),
            element("td", escape(_plainly(variable.high)), class_="n"),
        ]
        cells += [element("td", escape(_plainly(v)), class_="n") for v in variable.values]
        cells.append(element("td", _place(variable) + escape(_at_bound(variable))))
        name = element("th", element("code", escape(variable.name)), scope="row")
        rows.append(element("tr", name, *cells))
    return _table(head, rows, "What the search was allowed to change")


def _at_bound(variable: Variable) -> str:
    """Whether the last design stands on a bound, which may be worth widening."""
    span = variable.high - variable.low
    if span == 0:
        return ""
    part = (variable.values[-1] - variable.low) / span
    return " at a bound" if min(part, 1 - part) < 1e-3 else ""


def _plainly(value: float) -> str:
    return f"{value:.5g}".replace("-", "−") if np.isfinite(value) else "–"


def _place(variable: Variable) -> str:
    span = variable.high - variable.low
    ticks = []
    for k, value in enumerate(variable.values[:2]):
        part = float(np.clip((value - variable.low) / span, 0, 1)) if span > 0 else 0.5
        was = "was" if k == 0 and len(variable.values) > 1 else None
        ticks.append(element("i", class_=was, style=f"left:{117 * part:.0f}px"))
    return element("span", *ticks, class_="bar", aria_hidden="true")


def check_table(checks: Sequence[Check], caption: str) -> str:
    """What validation looked at, one line each."""
    rows = [
        _row(
            c.name,
            ("passed" if c.passed else "failed", "" if c.passed else "broken"),
            (c.detail, ""),
        )
        for c in checks
    ]
    return _table([("Check", ""), ("Outcome", ""), ("Found", "")], rows, caption)


def leave_one_out_table(search: Search) -> str:
    """How well each surrogate foretold designs it had not seen."""
    rows = [
        _row(
            name,
            (significant(error, 3), "n"),
            ("used" if name == search.surrogate_used else "", ""),
        )
        for name, error in search.leave_one_out.items()
    ]
    head = [("Surrogate", ""), ("Leave-one-out error", "n"), ("", "")]
    return _table(
        head,
        rows,
        "Surrogates of the objective tested on designs left out (0 perfect, 1 as good as the mean)",
        "narrow",
    )


def view_table(verdict: Verdict) -> str:
    """The same designs through other eyes."""
    rows = [
        _row(
            f"{view.design.capitalize()}, {view.eye}",
            (significant(view.objective, 6), "n"),
            (significant(100 * view.torque_ripple, 5), "n"),
            (significant(100 * view.efficiency, 6), "n"),
            (significant(100 * view.margin, 4), "n"),
        )
        for view in verdict.views
    ]
    head = [
        ("Design", ""),
        ("Objective J", "n"),
        ("Torque ripple, %", "n"),
        ("Efficiency, %", "n"),
        ("Tightest margin, %", "n"),
    ]
    return _table(
        head,
        rows,
        "The same designs through other eyes, weighted over the operating points; the search's "
        "margins are those of the envelope too",
    )


def error_table(data: ReportData) -> str:
    """Numerical quality of every simulation behind the report."""
    results = [(design, result) for design in data.designs for result in design.results]
    # An estimate that nobody made gets no column of dashes.
    estimated = any(np.isfinite(result.numerical_error) for _, result in results)
    rows = []
    for design, result in results:
        cells = [
            (_small(result.periodicity_residual), "n"),
            (_small(balance_residual(dict(result.metrics))), "n"),
        ]
        if estimated:
            cells.insert(0, (_small(result.numerical_error), "n"))
        rows.append(_row(f"{design.label.capitalize()}, {result.point.name}", *cells))
    head = [("Simulation", ""), ("Periodicity residual", "n"), ("Power balance residual", "n")]
    if estimated:
        head.insert(1, ("Estimated error", "n"))
    return _table(head, rows, "Numerical quality, relative")


def _small(value: float) -> str:
    """A residual as 4.0·10⁻⁶."""
    if not np.isfinite(value):
        return "–"
    if value == 0:
        return "0"
    digits, _, power = f"{abs(value):.1e}".partition("e")
    raised = str(int(power)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"{digits}·10{raised}"


def pairs_table(pairs: Iterable[tuple[str, str]]) -> str:
    """Names and values, such as versions, without a head."""
    rows = [_row(name, (value, "")) for name, value in pairs]
    return element("table", element("tbody", *rows), class_="narrow")
