"""The head of the report: the motor's name, the verdict, and the few numbers that matter first."""

from math import isfinite

import numpy as np

from camring.drawing.svg import element, escape
from camring.files.quantities import QUANTITIES, change, significant
from camring.presentation.records import ReportData
from camring.report.pictures.margins import plain_name

__all__ = ["head"]

MOST_OTHERS = 3  # operating points beside the first that a tile has room for
_KEYS = ("torque_ripple", "efficiency", "max_contact_stress", "mean_torque")


def head(data: ReportData) -> str:
    """Name, verdict and key figures as markup."""
    kind = "design report" if data.is_study else "simulation report"
    if len(data.designs) > 1 and not data.is_study:
        kind = "comparison"
    return element(
        "header",
        element("p", f"camring · {kind}", class_="eyebrow"),
        element("h1", escape(data.title)),
        element("p", escape(data.subtitle), class_="subtitle"),
        _verdict(data),
        _envelope(data),
        _warnings(data),
        _keys(data),
    )


def _verdict(data: ReportData) -> str:
    if data.verdict is None:
        return ""
    good = data.verdict.validated
    word = "✓ Validated" if good else "✕ Not validated"
    return element(
        "div",
        element("strong", word),
        element("span", escape(data.verdict.sentence)),
        class_=f"verdict {'yes' if good else 'no'}",
        role="note",
    )


def _envelope(data: ReportData) -> str:
    """Where each design runs, for a file that says where its motor must."""
    envelope = data.envelope
    if envelope is None or not envelope.asked:
        return ""
    lines = [
        element("li", element("b", escape(f"{each.label}: ")) + escape(f"{each.sentence}."))
        for each in envelope.designs
    ]
    kept = not envelope.designs[-1].broken.any()
    return element(
        "div",
        element("strong", "Envelope"),
        element("ul", *lines),
        class_=f"verdict {'yes' if kept else 'no'} more",
    )


def _warnings(data: ReportData) -> str:
    if not data.warnings:
        return ""
    lines = [element("li", escape(sentence)) for sentence in data.warnings]
    return element(
        "div", element("strong", "⚠ Look at this"), element("ul", *lines), class_="verdict warn"
    )


def _keys(data: ReportData) -> str:
    """Four results, large at the first operating point; limits count at the worst point."""
    first = [design.results[0] for design in data.designs]
    keys = []
    for name in _KEYS:
        quantity = QUANTITIES[name]
        values = [result.metrics.get(name) for result in first]
        if any(value is None for value in values):
            continue
        numbers = [float(value) for value in values if value is not None]
        now = quantity.written(numbers[-1])
        shown = element(
            "span", escape(now) + element("span", f" {quantity.unit}", class_="unit"), class_="now"
        )
        was = ""
        if len(numbers) == 2:
            text, _ = change(quantity, *numbers)
            was = f"from {quantity.written(numbers[0])} {quantity.unit} ({text})"
            was = element("span", escape(was), class_="was")
        keys.append(
            element(
                "div",
                element("dt", escape(quantity.label)),
                element("dd", shown, was, *_elsewhere(data, name)),
                class_="key",
            )
        )
    margins = _margins(data)
    known = [(margin, name) for margin, name in margins if isfinite(margin)]
    if known:
        least, name = min(known)
        unknown = len(known) < len(margins)
        kept = "some margins are unknown" if unknown else "all limits kept"
        note = f"{name}: a limit is broken" if least < 0 else f"of the limit “{name}”; {kept}"
        text = significant(100 * least, 2)
        shown = element("span", text + element("span", " %", class_="unit"), class_="now")
        keys.append(
            element(
                "div",
                element("dt", "Tightest margin"),
                element("dd", shown, element("span", escape(note), class_="was")),
                class_="key",
            )
        )
    point = first[-1].point.name
    said = f"At the first operating point, {point}:"
    if others := len(data.designs[-1].results) - 1:
        small = "the other" if others == 1 else f"the next {min(others, MOST_OTHERS)}"
        said = f"At the first operating point, {point}, and small at {small}:"
    caption = element("p", escape(said), class_="lead small")
    return caption + element("dl", *keys, class_="keys", aria_label=f"Key figures at {point}")


def _margins(data: ReportData) -> list[tuple[float, str]]:
    """The last design's margins and whose they are: at the operating points, in the envelope."""
    found = [(each.margins[-1], plain_name(each.name)) for each in data.constraints]
    envelope = data.envelope
    if envelope is not None and envelope.asked:
        found += [
            (-float(np.max(values)), f"{plain_name(name)}, in the envelope")
            for name, values in envelope.designs[-1].limits.items()
        ]
    return found


def _elsewhere(data: ReportData, name: str) -> list[str]:
    """A line for each further operating point: what it was and what it is."""
    quantity = QUANTITIES[name]
    lines = []
    for place, result in enumerate(data.designs[-1].results[1 : 1 + MOST_OTHERS], start=1):
        numbers = [design.results[place].metrics.get(name) for design in data.designs]
        if any(number is None for number in numbers):
            continue
        # A number of four digits must not be parted at its thin space by the end of a line.
        written = [
            quantity.written(float(number)).replace("\u2009", "\u202f")
            for number in numbers
            if number is not None
        ]
        path = " → ".join(written) if len(written) == 2 else written[-1]
        text = f"{result.point.name}: {path} {quantity.unit}".rstrip()
        lines.append(element("span", escape(text), class_="was other"))
    return lines
