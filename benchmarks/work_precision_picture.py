"""The picture of benchmarks/work_precision.py: error against time, each solver's best."""

from pathlib import Path

# Okabe and Ito's colours, distinguished by every kind of sight.
STYLES = {
    "camring, one motor": ("#D55E00", "o", "-"),
    "camring, 256 in a batch": ("#D55E00", "s", "--"),
    "CasADi CVODES": ("#0072B2", "^", "-"),
    "CasADi IDAS": ("#56B4E9", "v", "-"),
    "diffrax Kvaerno3": ("#009E73", "D", "-"),
    "diffrax Kvaerno5": ("#009E73", "P", "-"),
    "diffrax Kvaerno3, 256 under vmap": ("#009E73", "D", "--"),
    "SciPy LSODA": ("#000000", "o", "-"),
    "SciPy Radau": ("#CC79A7", "X", "-"),
    "SciPy BDF": ("#7F7F7F", "h", "-"),
}
SHOWN = (3e-2, 1e-10)


def best_of(rows: list[dict], name: str) -> list[dict]:
    """The settings of a solver, in either way, that no other of its own beats in both."""
    batch = "in a batch" in name or "vmap" in name
    own = [r for r in rows if r["solver"].startswith(name) and (batch or "vmap" not in r["solver"])]
    own.sort(key=lambda row: row["seconds"])
    front: list[dict] = []
    for row in own:
        if not front or row["largest_error"] < front[-1]["largest_error"]:
            front.append(row)
    return [row for row in front if SHOWN[1] <= row["largest_error"] <= SHOWN[0]]


def draw(rows: list[dict], path: Path) -> None:
    """Writes the picture as SVG, its labels beside its lines."""
    import matplotlib

    matplotlib.use("svg")
    matplotlib.rcParams["svg.hashsalt"] = "camring"
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(9.5, 6))
    ends = []
    for name, (colour, marker, dashes) in STYLES.items():
        front = best_of(rows, name)
        if not front:
            continue
        errors = [row["largest_error"] for row in front]
        times = [1e3 * row["seconds"] for row in front]
        ours = name.startswith("camring")
        axes.plot(
            errors,
            times,
            color=colour,
            marker=marker,
            linestyle=dashes,
            linewidth=2.6 if ours else 1.4,
            markersize=6 if ours else 5,
        )
        ends.append((times[-1], errors[-1], name, colour))
    axes.set(xscale="log", yscale="log", xlim=(SHOWN[0], SHOWN[1] / 2000))
    # Labels stand at the right, in the order of their lines, none on another.
    low = 0.0
    ends.sort()
    for time, error, name, colour in ends:
        height = max(time, 1.4 * low)
        low = height
        axes.annotate(
            name,
            (error, time),
            (SHOWN[1] / 3, height),
            color=colour,
            va="center",
            fontsize=9.5,
            arrowprops={"arrowstyle": "-", "color": colour, "lw": 0.5, "alpha": 0.6},
        )
    axes.set_xlabel("largest error of pressure, of the supply–return difference (finer →)")
    axes.set_ylabel("milliseconds of a processor for one design")
    axes.set_title("Periodic chamber pressure: what a digit costs", loc="left")
    axes.set_xticks([10.0**-k for k in range(2, 11)])
    axes.grid(True, which="major", color="#dddddd", linewidth=0.7)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    figure.tight_layout()
    path.parent.mkdir(exist_ok=True)
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)
