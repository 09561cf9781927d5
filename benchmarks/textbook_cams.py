"""The best motor of a study beside every textbook cam with its windows tuned.

    python benchmarks/textbook_cams.py [--motors wheel] [--budget 120]

Each cam is put into the motor file in the given one's place, at the same stroke; then
`camring optimise` has all window variables of the file's design space, and none of the cam's.
Cams: sine, constant acceleration, modified trapezoid, and every spline of zero geometric ripple
for the motor's counts. The last row of a motor has the whole design space.
"""

import argparse
import json
import math
import re
import tempfile
from pathlib import Path

import numpy as np

from camring.programs.compilation_cache import keep_compiled_programs

EXAMPLES = Path(__file__).parents[1] / "examples"
RESULTS = Path(__file__).with_name("results")


def with_cam(text: str, radii: np.ndarray) -> str:
    """The motor file with this cam, and no variables of a cam."""
    listed = ", ".join(f'"{1e3 * radius:.6f} mm"' for radius in radii)
    text = re.sub(r"control_radii = \[.*?\]", f"control_radii = [{listed}]", text)
    return re.sub(r"\[design_space\.cam\].*?(?=\n\[)", "", text, flags=re.DOTALL)


def best_of(text: str, budget: int) -> tuple[float, float, int]:
    """Lowest feasible objective of a study, its largest torque ripple, and its evaluations."""
    import camring

    with tempfile.TemporaryDirectory() as scratch:
        motor, folder = Path(scratch) / "motor.toml", Path(scratch) / "study"
        motor.write_text(text)
        camring.optimise(motor, folder, budget=budget, theory=False)
        records = camring.open_study(folder).records
    sound = [each for each in records if each.feasible]
    if not sound:
        return math.inf, math.nan, len(records)
    best = min(sound, key=lambda each: each.outcome.physical_objective).outcome
    ripple = max(each["torque_ripple"] for each in best.results)
    return best.physical_objective, ripple, len(records)


def rivals(name: str) -> dict[str, str]:
    """Motor files by the name of their cam."""
    import camring
    from camring.geometry.profiles import LAWS, control_values, zero_ripple_cams

    text = (EXAMPLES / f"{name}_motor.toml").read_text()
    motor = camring.read_motor_file(EXAMPLES / f"{name}_motor.toml").system.motor
    count = motor.cam.control_count
    cams = {law: control_values(lift, count) for law, lift in LAWS.items()}
    quiet = enumerate(zero_ripple_cams(motor.pistons, motor.lobes, count), start=1)
    cams |= {f"zero ripple, number {k}": cam.control_values(count) for k, cam in quiet}
    radius = motor.cam.pitch_radius(np.linspace(0, motor.cam.period, 2000)).value
    inner, height = float(radius.min()), float(np.ptp(radius))
    return {cam: with_cam(text, inner + height * lift) for cam, lift in cams.items()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--motors", nargs="+", default=["wheel", "winch", "mill"])
    parser.add_argument("--budget", type=int, default=120)
    asked = parser.parse_args()
    keep_compiled_programs()  # before JAX is imported

    rows = []
    print("| motor | cam | best objective | above the best | torque ripple | evaluations |")
    print("|---|---|---|---|---|---|")
    for name in asked.motors:
        whole = best_of((EXAMPLES / f"{name}_motor.toml").read_text(), 300)
        found = {cam: best_of(text, asked.budget) for cam, text in rivals(name).items()}
        for cam, (objective, ripple, count) in {**found, "found by the search": whole}.items():
            above = objective / whole[0] - 1
            sound = math.isfinite(objective)
            rows.append({"motor": name, "cam": cam, "objective": objective if sound else None})
            numbers = f"{objective:.5f} | {100 * above:.1f} % | {100 * ripple:.2f} %"
            print(f"| {name} | {cam} | {numbers if sound else 'keeps no limits | |'} | {count} |")
    kept = RESULTS / "textbook_cams.json"
    others = json.loads(kept.read_text()) if kept.exists() else []
    rows = [each for each in others if each["motor"] not in asked.motors] + rows
    kept.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
