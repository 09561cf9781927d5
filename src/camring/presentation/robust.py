"""A robust design beside the nominal optimum: a folder, a table, one document."""

import json
from pathlib import Path

import numpy as np
import typer
from rich.table import Table

from camring.evaluation.built_motors import OBJECTIVE, Scatter, shown
from camring.files.csv_table import Decimal
from camring.files.json_numbers import finite
from camring.files.motor.document import printable
from camring.files.new_file import whole_folder, write_new_file
from camring.files.visible import say
from camring.presentation.built_motors import kept_sentence, samples_csv, summary
from camring.presentation.console import console
from camring.presentation.simulation import versions
from camring.studies.robust import GIVEN, NOMINAL, ROBUST, RobustDesign

PICTURE = "comparison.svg"
DESIGNS = {NOMINAL: "nominal", ROBUST: "robust"}
ROWS = (
    (OBJECTIVE, (0.95,)),
    ("torque_ripple", (0.95,)),
    ("flow_ripple", (0.95,)),
    ("efficiency", (0.05,)),
    ("max_contact_stress", (0.95,)),
    ("max_pressure", (0.95,)),
)
"""Results compared, each as drawn, in the mean and where only one motor in twenty is worse."""

NOT_CONFIRMED = 3
LOOSE = 0.01  # of a limit's scale; a limit broken by more at fresh samples was not kept


def write(found: RobustDesign, folder: Path, decimal: Decimal = Decimal.POINT) -> None:
    """Two motor files, their samples, and the picture where matplotlib is."""
    from camring.plots import drawable

    with whole_folder(folder) as draft:
        for name, word in DESIGNS.items():
            write_new_file(draft / f"{word}.toml", found.text_of(name))
            write_new_file(
                draft / f"{word}_samples.csv",
                samples_csv(found.file, found.scatters[name], decimal),
            )
        if drawable():
            from camring.plots import robust_comparison, save

            save(robust_comparison(found), draft / PICTURE)


def show(found: RobustDesign, folder: Path, *, as_json: bool) -> int:
    """Prints it; the exit code: 3 when fresh motors do not bear out what the search saw."""
    if as_json:
        typer.echo(json.dumps(document(found, folder), indent=1, allow_nan=False))
    else:
        out = console()
        out.print(_table(found))
        for sentence in sentences(found):
            out.print(sentence, markup=False)
    names = [f"{word}.toml" for word in DESIGNS.values()]
    files = ", ".join(names + [PICTURE] * (folder / PICTURE).exists())
    say(f"Wrote {files} and samples in {folder}.", err=as_json)
    return 0 if not broken(found) and better(found) else NOT_CONFIRMED


def better(found: RobustDesign) -> bool:
    """Whether fresh motors agree that the robust design's statistic is the lower one.

    A nominal optimum that does not keep the limits is no rival.
    """
    return at_fresh(found, ROBUST) <= at_fresh(found, NOMINAL) or bool(broken(found, NOMINAL))


def at_fresh(found: RobustDesign, name: str) -> float:
    """The statistic that was minimised, of a design's fresh motors."""
    values = found.scatters[name].results[OBJECTIVE]
    return found.statistic(values[np.isfinite(values)]).value


def broken(found: RobustDesign, name: str = ROBUST) -> dict[str, float]:
    """Limits that a design's fresh motors do not keep as was asked, and by how much."""
    at = {
        limit: found.of_limits(values[np.isfinite(values)]).value
        for limit, values in found.scatters[name].constraints.items()
    }
    return {limit: value for limit, value in at.items() if value > LOOSE}


def sentences(found: RobustDesign) -> list[str]:
    """Who wins by how much, what it costs, which limits are kept."""
    robust, nominal = found.scatters[ROBUST], found.scatters[NOMINAL]
    said = [
        _compared("torque_ripple", robust, nominal),
        f"{str(found.statistic).capitalize()} of the objective at fresh motors: robust "
        f"{at_fresh(found, ROBUST):.5g}, nominal optimum {at_fresh(found, NOMINAL):.5g}; "
        f"the search saw {found.promised:.5g} at its {found.search_samples}.",
        f"Robust design: {kept_sentence(robust)}",
        f"Nominal optimum: {kept_sentence(nominal)}",
    ]
    said += [
        f"At its {found.of_limits} the robust design breaks {limit} by {100 * value:.2g} % of "
        "its scale: take more --samples."
        for limit, value in broken(found).items()
    ]
    if not better(found):
        said.append("The robust design is not better: the scatter is small, or more --samples.")
    said.append(
        f"{found.evaluations[0]} designs for the nominal optimum in {found.seconds[0]:.0f} s, "
        f"{found.evaluations[1]} of {found.search_samples} motors for the robust one in "
        f"{found.seconds[1]:.0f} s. {found.stopped}"
    )
    return said


def document(found: RobustDesign, folder: Path) -> dict:
    """Everything that a program may want to know; results in SI."""
    return finite(
        {
            "input": printable(found.file.path),
            "versions": versions(),
            "statistic": str(found.statistic),
            "files": {name: str(folder / f"{word}.toml") for name, word in DESIGNS.items()},
            "designs": {
                name: {
                    "results": summary(scatter),
                    "statistic": at_fresh(found, name),
                    "keep_every_limit": float(np.mean(scatter.keeps_limits)),
                    "broken": scatter.broken_by(),
                    "failed": int(np.count_nonzero(~scatter.sound)),
                    "variables": _described(found, name),
                }
                for name, scatter in found.scatters.items()
            },
            "promised": found.promised,
            "samples": found.search_samples,
            "checked": len(found.scatters[ROBUST].deviates),
            "evaluations": list(found.evaluations),
            "seconds": list(found.seconds),
            "better": better(found),
            "limits_not_kept": broken(found),
        }
    )


def _described(found: RobustDesign, name: str) -> dict[str, float]:
    space = found.file.design_space
    assert space is not None
    return space.describe(found.file.system, found.points[name])


def _compared(name: str, robust: Scatter, nominal: Scatter) -> str:
    """One result's worse end, in one sentence."""
    how = shown(name)
    ours, theirs = robust.quantile(name, 0.95), nominal.quantile(name, 0.95)
    drawn = robust.nominal[name], nominal.nominal[name]
    words = "less" if ours < theirs else "more"
    return (
        f"95 % of the robust design's motors have a {how.label.lower()} below "
        f"{how.written(ours)} {how.unit}, of the nominal optimum's below {how.written(theirs)} "
        f"{how.unit}: {100 * abs(1 - ours / theirs):.3g} % {words}. As drawn: "
        f"{how.written(drawn[0])} {how.unit} and {how.written(drawn[1])} {how.unit}."
    )


def _table(found: RobustDesign) -> Table:
    table = Table(box=None, pad_edge=False)
    table.add_column("")
    table.add_column("")
    for name in (GIVEN, NOMINAL, ROBUST):
        table.add_column(name, justify="right")
    scatters = [found.scatters[name] for name in (GIVEN, NOMINAL, ROBUST)]
    for name, shares in ROWS:
        how = shown(name)
        cells = [how.written(each.nominal[name]) for each in scatters]
        table.add_row(how.label, how.unit, *cells)
        cells = [how.written(float(np.nanmean(each.results[name]))) for each in scatters]
        table.add_row("  mean", "", *cells)
        for share in shares:
            cells = [how.written(each.quantile(name, share)) for each in scatters]
            table.add_row(f"  {100 * share:g} %", "", *cells)
    kept = [f"{100 * float(np.mean(each.keeps_limits)):.1f}" for each in scatters]
    table.add_row("Motors that keep every limit", "%", *kept)
    return table


__all__ = ["at_fresh", "better", "broken", "document", "sentences", "show", "write"]
