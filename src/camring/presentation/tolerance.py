"""A tolerance study as tables for people, one document for programs, and a folder."""

import json
from pathlib import Path

import numpy as np
from rich.markup import escape
from rich.table import Table

from camring.analyses.tolerance import ToleranceStudy
from camring.evaluation.built_motors import OBJECTIVE, labelled, shown, tolerances_of
from camring.files.csv_table import Decimal
from camring.files.json_numbers import finite
from camring.files.motor.document import printable
from camring.files.new_file import whole_folder, write_new_file
from camring.files.quantities import significant
from camring.files.visible import say
from camring.presentation.built_motors import (
    SHARES,
    kept_sentence,
    samples_csv,
    summary,
)
from camring.presentation.console import console
from camring.presentation.simulation import versions

TABLE, PICTURE = "samples.csv", "scatter.svg"
BLAMED = {
    "torque_ripple": "ripple",
    "efficiency": "efficiency",
    "max_contact_stress": "stress",
    "min_contact_force": "force",
}
"""Results whose scatter is traced to its causes in the table, with short words for them."""

NEGLIGIBLE = 5e-3  # of a variance
ESTIMATES_APART = 0.1  # of the variance, beyond which slopes do not tell it


def write(found: ToleranceStudy, folder: Path, decimal: Decimal = Decimal.POINT) -> None:
    """samples.csv, and scatter.svg where matplotlib is."""
    from camring.plots import drawable

    with whole_folder(folder) as draft:
        write_new_file(draft / TABLE, samples_csv(found.file, found.scatter, decimal))
        if drawable():
            from camring.plots import save, scatter_histograms

            save(scatter_histograms(found.scatter), draft / PICTURE)


def show(found: ToleranceStudy) -> None:
    """Prints what scatters, what comes of it and who is to blame."""
    out = console()
    out.print(_results(found))
    out.print()
    out.print(_causes(found))
    for sentence in sentences(found):
        out.print(sentence, markup=False)


def sentences(found: ToleranceStudy) -> list[str]:
    """Limits, and where slopes do not tell the whole story."""
    said = [kept_sentence(found.scatter)]
    bent = [
        words
        for name, words in BLAMED.items()
        if abs(found.by_slopes[name].explained - 1) > ESTIMATES_APART
        and np.nanstd(found.scatter.results[name]) > 0
    ]
    if bent:
        said.append(
            f"Slopes do not explain the scatter of {', '.join(bent)}: not linear that far. "
            "Go by the regression, the second number, and by the samples."
        )
    return said


def document(found: ToleranceStudy) -> str:
    """One JSON document, SI."""
    tolerances, scatter = tolerances_of(found.file), found.scatter
    results = summary(scatter)
    for name, values in results.items():
        values["standard_deviation_first_order"] = found.first_order(name)
    causes = {
        name: {
            "slopes": dict(zip(tolerances.names, slopes.variances.tolist(), strict=True)),
            "regression": dict(
                zip(
                    tolerances.names,
                    found.by_regression[name].variances.tolist(),
                    strict=True,
                )
            ),
            "explained_by_slopes": slopes.explained,
            "explained_by_regression": found.by_regression[name].explained,
        }
        for name, slopes in found.by_slopes.items()
    }
    return json.dumps(
        finite(
            {
                "input": printable(found.file.path),
                "versions": versions(),
                "samples": len(scatter.deviates),
                "seed": found.seed,
                "seconds": found.sampling_seconds,
                "tolerances": dict(zip(tolerances.names, tolerances.wording, strict=True)),
                "results": results,
                "variances": causes,
                "keep_every_limit": float(np.mean(scatter.keeps_limits)),
                "broken": scatter.broken_by(),
                "failed": int(np.count_nonzero(~scatter.sound)),
            }
        ),
        indent=1,
        allow_nan=False,
    )


def _results(found: ToleranceStudy) -> Table:
    table = Table(box=None, pad_edge=False)
    table.add_column("", no_wrap=True)
    for words in ("as drawn", "mean", "st. dev.", "by slopes"):
        table.add_column(words, justify="right")
    for share in SHARES:
        table.add_column(f"{100 * share:g} %", justify="right")
    for name, values in summary(found.scatter).items():
        how = shown(name)
        spread = [values["standard_deviation"], found.first_order(name)]
        table.add_row(
            labelled(name),
            how.written(values["nominal"]),
            how.written(values["mean"]),
            *(significant(each * how.factor, 3) for each in spread),
            *(how.written(values[f"quantile_{100 * share:g}"]) for share in SHARES),
        )
    return table


def _causes(found: ToleranceStudy) -> Table:
    """Per cent of each variance by each tolerance: by slopes, and by regression."""
    tolerances = tolerances_of(found.file)
    table = Table(
        title="Per cent of the variance, by slopes | by regression (· is less than half)",
        title_justify="left",
        box=None,
        pad_edge=False,
    )
    table.add_column("tolerance", no_wrap=True)
    names = [OBJECTIVE, *BLAMED]
    for name in names:
        table.add_column(BLAMED.get(name, name), justify="right")
    totals = {name: float(np.nanvar(found.scatter.results[name])) for name in names}
    order = np.argsort(-found.by_regression[OBJECTIVE].variances)
    for place in order:
        cells = [
            _pair(
                found.by_slopes[name].variances[place],
                found.by_regression[name].variances[place],
                totals[name],
            )
            for name in names
        ]
        name = tolerances.names[place].removeprefix("motor.")
        words = tolerances.wording[place].removesuffix(", uniform")
        table.add_row(escape(f"{name} {words}"), *cells)
    table.add_row(
        "together",
        *(
            f"{100 * found.by_slopes[name].explained:.0f} | "
            f"{100 * found.by_regression[name].explained:.0f}"
            for name in names
        ),
    )
    return table


def _pair(by_slopes: float, by_regression: float, total: float) -> str:
    if total == 0 or max(by_slopes, by_regression) < NEGLIGIBLE * total:
        return "·"
    return f"{100 * by_slopes / total:.0f} | {100 * by_regression / total:.0f}"


def print_files(folder: Path, *, as_json: bool) -> None:
    """Where the files are."""
    files = TABLE + f" and {PICTURE}" * (folder / PICTURE).exists()
    say(f"Wrote {files} in {folder}.", err=as_json)


__all__ = ["document", "print_files", "show", "write"]
