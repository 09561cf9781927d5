"""What our own simulation is worth as the approximation of a user's dearer model.

The stand-in is `examples/user_model.py`: the wheel motor with a drag that our model does not
have. Searched with our simulation's objective to lean on, with the linear model's, and with
nothing; all from the given motor, without theory's starts.

    python benchmarks/user_model.py [SEEDS] [BUDGET] [scbo or bayesian]
"""

import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from camring.evaluation.evaluator import MotorEvaluator, model_of
from camring.evaluation.strategy import FEWEST_TO_LEAN, first_points
from camring.evaluation.user_programs.command import UserCommand
from camring.evaluation.user_programs.evaluator import UserEvaluator, overlaid
from camring.files.motor import read_motor_file
from camring.search.bayesian import Bayesian
from camring.search.minimise import minimise
from camring.search.problem import Problem
from camring.search.scbo import Scbo
from camring.studies.coordinator import as_seen_by_search

MOTOR = Path(__file__).parents[1] / "examples" / "wheel_motor.toml"
DRAG = 15.0  # as in examples/user_model.py
NONE, LINEAR, OURS = "nothing", "linear model", "our simulation"


def evaluated(text, point):
    """Our simulation with the drag of the example, without the price of a process."""
    model = model_of(text)
    ours = MotorEvaluator(text)(point)
    plate = model.system_at(point).motor.valve_plate
    width = float(plate.supply.width + plate.return_.width)
    given = []
    for point_, results in zip(model.system.operating_points, ours.results, strict=True):
        torque = results["mean_torque"] - DRAG * width * float(point_.shaft_speed) / 31.4
        share = torque / results["mean_torque"]
        given.append(
            {
                "mean_torque": torque,
                "torque_ripple": results["torque_ripple"] / share,
                "efficiency": results["efficiency"] * share,
            }
        )
    found = overlaid(model.system_at(point), model.goal, ours, given)
    return found, ours.approximation


def run(motor_file, leaning, initial, seed, budget, search):
    """Best feasible objective after each evaluation."""
    text, space = motor_file.text, motor_file.design_space
    names = motor_file.goal.constraints.names()
    ours, own = MotorEvaluator(text), UserEvaluator(text, UserCommand(("none",), 1.0, "."))
    approximate = {NONE: None, LINEAR: ours.approximate, OURS: own.approximate}[leaning]

    def evaluate(points):
        found, linear = evaluated(text, points[0])
        if leaning == LINEAR:
            found = replace(found, approximation=linear)
        return [as_seen_by_search(found, names)]

    problem = Problem(space.dimension, len(names), evaluate)
    given = tuple(tuple(point) for point in first_points(motor_file, theory=False))
    settings = {"approximate": approximate, "given": given, "initial": initial}
    if search == "scbo":
        strategy = Scbo(space.dimension, **settings)
    else:
        strategy = Bayesian(space.dimension, **settings, convergence=None)
    history = minimise(problem, strategy, budget, seed).history
    values = [one.objective if one.feasible() else np.inf for one in history]
    return np.minimum.accumulate(values)


def first_within(best, target):
    reached = np.flatnonzero(best <= target)
    return str(reached[0] + 1) if len(reached) else "never"


def main():
    seeds, budget, search = (*sys.argv[1:], *("2", "160", "scbo")[len(sys.argv) - 1 :])
    seeds, budget = int(seeds), int(budget)
    motor_file = read_motor_file(MOTOR)
    runs = {}
    for (leaning, initial), evaluations in {
        (OURS, FEWEST_TO_LEAN): 40,
        (LINEAR, FEWEST_TO_LEAN): budget,
        (LINEAR, None): budget,
        (NONE, FEWEST_TO_LEAN): budget,
        (NONE, None): budget,
    }.items():
        for seed in range(seeds):
            began = time.perf_counter()
            key = f"{leaning}, {initial or 'usual'} first points, seed {seed}"
            runs[key] = run(motor_file, leaning, initial, seed, evaluations, search)
            took = (time.perf_counter() - began) / evaluations
            print(f"  {key}: {runs[key][-1]:.6g}, {took:.2f} s each", flush=True)
    best = min(values[-1] for values in runs.values())
    print(f"best {best:.6g}; evaluations to 10 %, 1 %, 0.1 % above it")
    for key, values in runs.items():
        reached = [first_within(values, best * (1 + share)) for share in (0.1, 0.01, 0.001)]
        print(f"  {key}: {', '.join(reached)}")


if __name__ == "__main__":
    main()
