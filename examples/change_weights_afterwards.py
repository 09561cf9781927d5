"""A small study; then other weights, without simulating anything again."""

import tempfile
from pathlib import Path

import numpy as np

import camring

motor = Path(__file__).with_name("wheel_motor.toml")
with tempfile.TemporaryDirectory() as place:
    folder = Path(place) / "study"
    finished = camring.optimise(motor, folder, budget=30)
    print(finished.validation.sentence)

    study = camring.open_study(folder)
    for weights in (camring.Weights(), camring.Weights(torque_ripple=0.1, efficiency=100.0)):
        objectives = study.objectives(weights)
        kept = [record.feasible for record in study.records]
        best = study.records[int(np.nanargmin(np.where(kept, objectives, np.nan)))]
        results = best.outcome.results[0]
        print(
            f"ripple weighs {weights.torque_ripple}: trial {best.trial}, torque ripple "
            f"{100 * results['torque_ripple']:.2f} %, "
            f"efficiency {100 * results['efficiency']:.2f} %"
        )
