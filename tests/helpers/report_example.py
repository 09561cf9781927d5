"""A study made of numbers alone, so that pictures can be tested without a solver or a store.

The motor is the wheel motor of the examples against a cam of zero geometric
ripple; its pressure comes from backward Euler steps, close enough to look at.
"""

from math import pi

import numpy as np

from camring.presentation import records as data

LOBES, PISTONS, BORE, ROLLER = 6, 8, 0.030, 0.012
AREA = pi * BORE**2 / 4
MODULUS, DENSITY, DEAD, MASS, DAMPING, LEAKAGE = 1.4e9, 870.0, 6e-6, 0.24, 8.5, 1.6e-13
PORT, DISCHARGE, LENGTH, CONTACT_MODULUS = 60e-6, 0.65, 0.028, 206e9 / (2 * 0.91)
PITCH = 2 * pi / LOBES
STROKE, INNER = 0.0118, 0.08500


def given_controls() -> np.ndarray:
    phase = 2 * pi * np.arange(16) / 16
    return 0.0909 - 0.0060536 * np.cos(phase)


def zero_ripple_controls() -> np.ndarray:
    """docs/theory.md section 11: a box of a quarter lobe convolved with a short kernel."""
    rise = np.convolve(np.ones(4), np.ones(3) / 3)
    slope = np.zeros(16)
    slope[2:8], slope[10:16] = rise, -rise
    return INNER + STROKE / rise.sum() * np.cumsum(slope)


def spline(controls: np.ndarray, angle: np.ndarray) -> list[np.ndarray]:
    """Radius and three derivatives of the periodic cubic spline."""
    n = len(controls)
    h = PITCH / n
    position = angle / h
    span = np.floor(position).astype(int)
    t = position - span
    c = [controls[(span + k) % n] for k in (-1, 0, 1, 2)]
    basis = [
        [
            (1 - t) ** 3 / 6,
            (3 * t**3 - 6 * t**2 + 4) / 6,
            (-3 * t**3 + 3 * t**2 + 3 * t + 1) / 6,
            t**3 / 6,
        ],
        [-((1 - t) ** 2) / 2, (3 * t**2 - 4 * t) / 2, (-3 * t**2 + 2 * t + 1) / 2, t**2 / 2],
        [1 - t, 3 * t - 2, 1 - 3 * t, t],
        [-np.ones_like(t), 3 + 0 * t, -3 + 0 * t, np.ones_like(t)],
    ]
    return [sum(w * v for w, v in zip(row, c, strict=True)) / h**k for k, row in enumerate(basis)]


def opening(angle: np.ndarray, centre: float, width: float, ramp: float = 0.35) -> np.ndarray:
    ahead = angle - centre
    distance = np.abs(ahead - PITCH * np.round(ahead / PITCH))
    return np.clip((width / 2 - distance) / (ramp * width / 2), 0, 1)


def pressure_orbit(point, angle, volume, volume_rate, supply, return_):
    """Three turns of backward Euler with Newton, the last one kept."""
    coefficient = DISCHARGE * PORT * np.sqrt(2 / DENSITY)

    def net(p, k):
        return (
            coefficient * supply[k] * signed_root(point.supply_pressure - p)
            + coefficient * return_[k] * signed_root(point.return_pressure - p)
            - LEAKAGE * (p - point.case_pressure)
            - volume_rate[k]
        )

    step, pressure, orbit = angle[1] - angle[0], point.supply_pressure, np.zeros_like(angle)
    for _ in range(3):
        for k in range(len(angle)):
            gain = MODULUS * step / (point.shaft_speed * volume[k])
            old = pressure
            for _ in range(12):
                value = pressure - old - gain * net(pressure, k)
                ahead = pressure + 10.0 - old - gain * net(pressure + 10.0, k)
                pressure -= 10.0 * value / (ahead - value)
                if abs(value) < 1.0:
                    break
            orbit[k] = pressure
    return orbit


def signed_root(drop):
    return drop / (drop * drop + 1e10) ** 0.25


def make_result(controls, point, width, shift, count=721) -> tuple[data.Profile, data.Result]:
    angle = np.linspace(0, PITCH, count)
    r, r1, r2, r3 = spline(controls, angle)
    w = point.shaft_speed
    lift = r - r.min()
    volume, volume_rate = DEAD + AREA * lift, AREA * w * r1
    supply = opening(angle, PITCH / 4 + shift, width)
    return_ = opening(angle, 3 * PITCH / 4 + shift, width)
    p = pressure_orbit(point, angle, volume, volume_rate, supply, return_)
    speed2 = r**2 + r1**2
    curvature = (speed2 + r1**2 - r * r2) / speed2**1.5
    undercut = 1 + curvature * ROLLER
    phi = np.arctan2(r1, r)
    force = AREA * (p - point.case_pressure) - MASS * w * w * r2 - DAMPING * w * r1
    normal = force / np.cos(phi)
    stress = np.sqrt(np.maximum(normal, 0) * CONTACT_MODULUS / (pi * LENGTH * ROLLER * undercut))
    one = (force * r1)[:-1]
    places = np.arange(PISTONS) * (count - 1) * LOBES // PISTONS
    ring = np.tile(one, LOBES)
    torque = sum(np.roll(ring, -int(k)) for k in places)
    spectrum = np.abs(np.fft.rfft(torque)) / len(torque)
    orders = np.arange(0, 601)
    coefficient = DISCHARGE * PORT * np.sqrt(2 / DENSITY)

    qs = coefficient * supply * signed_root(point.supply_pressure - p)
    qr = coefficient * return_ * signed_root(point.return_pressure - p)
    ql = LEAKAGE * (p - point.case_pressure)

    def mean(values):
        return float(values[:-1].mean())

    total = PISTONS * mean(qs)
    input_power, output = point.pressure_drop * total, float(torque.mean()) * w
    throttling = PISTONS * mean((point.supply_pressure - p) * qs + (point.return_pressure - p) * qr)
    leakage = PISTONS * mean((p - point.return_pressure) * ql)
    friction = PISTONS * mean(DAMPING * (w * r1) ** 2)
    displacement = PISTONS * LOBES * AREA * float(lift.max())
    ideal = point.pressure_drop * displacement / (2 * pi)
    ripple = float(np.sqrt((spectrum[1:601] ** 2).sum()) / torque.mean())
    metrics = {
        "mean_torque": float(torque.mean()),
        "torque_ripple": ripple,
        "torque_ripple_true_rms": ripple * 2**0.5,
        "torque_ripple_peak_to_peak": float(np.ptp(torque) / torque.mean()),
        "pressure_ripple": 0.68,
        "flow_ripple": 0.08,
        "return_flow_ripple": 0.09,
        "displacement": displacement,
        "stroke": float(lift.max()),
        "ideal_torque": ideal,
        "supply_flow": total,
        "case_drain": PISTONS * mean(ql),
        "efficiency": output / input_power,
        "volumetric_efficiency": displacement * w / (2 * pi) / total,
        "hydromechanical_efficiency": float(torque.mean()) / ideal,
        "energy_efficiency": output / input_power,
        "input_power": input_power,
        "output_power": output,
        "throttling_loss": throttling,
        "leakage_loss": leakage,
        "friction_loss": friction,
        "compression_loss": input_power - output - throttling - leakage - friction,
        "min_pressure": float(p.min()),
        "max_pressure": float(p.max()),
        "min_contact_force": float(force.min()),
        "max_contact_stress": float(stress.max()),
        "l10_life": 2.3e7,
        "min_undercut_factor": float(undercut.min()),
        "max_pressure_angle": float(np.abs(phi).max()),
        "max_velocity": float(np.abs(w * r1).max()),
        "max_acceleration": float(np.abs(w * w * r2).max()),
        "max_jerk": float(np.abs(w**3 * r3).max()),
        "min_volume": float(volume.min()),
        "natural_frequency": 16928.6,
        "damping_ratio": 0.00105,
        "jerk_objective": 0.127,
        "spectral_pressure": 0.117,
        "spectral_torque": 0.0066,
    }
    waves = data.Waves(
        angle,
        lift,
        w * r1,
        w * w * r2,
        w**3 * r3,
        volume,
        p,
        qs,
        qr,
        ql,
        normal,
        stress,
        np.append(torque, torque[0])[:count],
        supply,
        return_,
    )
    profile = data.Profile(angle, r, r1, curvature, phi, undercut)
    flow = sum(np.roll(np.tile(qs[:-1], LOBES), -int(k)) for k in places)
    flows = 2 * np.abs(np.fft.rfft(flow))[:601] / len(flow)
    result = data.Result(point, metrics, waves, orders, 2 * spectrum[:601], flows, 3e-9, 4e-6)
    return profile, result


def make_design(label, controls, width, shift=0.0) -> data.Design:
    points = (
        data.Point(10 * pi, 250e5, 10e5, 2e5, 0.6),
        data.Point(2 * pi, 350e5, 10e5, 2e5, 0.4),
    )
    parts = [make_result(controls, point, width, shift) for point in points]
    facts = data.Facts(PISTONS, LOBES, LOBES, BORE, ROLLER, 24, 4)
    return data.Design(label, facts, parts[0][0], tuple(result for _, result in parts))


def make_search(seed: int = 7) -> data.Search:
    random = np.random.default_rng(seed)
    trials = []
    for k in range(140):
        phase = "initial design" if k < 32 else "Bayesian search" if k < 110 else "refinement"
        level = 0.17 if k < 32 else 0.11 * np.exp(-(k - 32) / 25) + 0.0445
        objective = float(level * np.exp(0.4 * abs(random.normal()) * (0.2 if k > 110 else 1)))
        feasible = bool(random.random() < (0.35 if k < 32 else 0.75)) or k == 0
        ripple = 0.006 + 0.4 * max(objective - 0.045, 0)
        trials.append(
            data.Trial(
                k,
                phase,
                0.1086 if k == 0 else objective,
                feasible,
                k == 57,
                {"supply_width": 28.4 - 2 * random.random(), "shift": random.normal()},
                {"torque_ripple": ripple, "efficiency": 0.95 + 0.3 * ripple * random.random()},
            )
        )
    return data.Search(
        tuple(trials),
        "objective gain below 0.1 % over the last 30 trials",
        {"plain": 0.021, "rho = 1": 0.0174, "rho fitted": 0.0121},
        "rho fitted",
        ("Starting designs from theory: 3 of 32.",),
        given=0,
        best=135,
    )


def make_report() -> data.ReportData:
    given = make_design("given", given_controls(), np.radians(28.4))
    best = make_design("best", zero_ripple_controls(), np.radians(28.4), np.radians(0.1))
    constraints = []
    for name, limit, metric, factor, unit, sense in (
        ("max_contact_stress", 1.9e9, "max_contact_stress", 1e-9, "GPa", 1),
        ("max_pressure", 420e5, "max_pressure", 1e-5, "bar", 1),
        ("min_pressure", 3e3, "min_pressure", 1e-5, "bar", -1),
        ("max_pressure_angle", pi / 6, "max_pressure_angle", 180 / pi, "deg", 1),
        ("min_undercut_factor", 0.25, "min_undercut_factor", 1, "", -1),
        ("min_contact_force", 0.0, "min_contact_force", 1e-3, "kN", -1),
    ):
        worst = [
            (max if sense > 0 else min)(r.metrics[metric] for r in d.results) for d in (given, best)
        ]
        scale = (
            abs(limit)
            if name not in ("min_pressure", "min_contact_force")
            else 240e5 * (1 if name == "min_pressure" else AREA)
        )
        constraints.append(
            data.Constraint(
                name,
                f"{'at most' if sense > 0 else 'at least'} {limit * factor:.4g} {unit}",
                tuple(f"{v * factor:.4g} {unit}" for v in worst),
                tuple(sense * (limit - v) / scale for v in worst),
            )
        )
    checks = (
        data.Check(
            "Agreement of the best motor at finer resolution",
            True,
            "largest difference 2.1e-06, in lowest pressure",
        ),
        data.Check(
            "Agreement of the best motor by SciPy's stiff solver",
            True,
            "largest difference 4.4e-06, in lowest contact force",
        ),
        data.Check("All constraints", True, "tightest margin 4.1 % (contact stress)"),
    )
    return data.ReportData(
        title="Wheel motor, 0.4 L/rev, 8 pistons on 6 lobes",
        subtitle="8 pistons on 6 lobes, bore 30 mm, stroke 11.8 mm",
        designs=(given, best),
        verdict=data.Verdict(
            True, "Every gain and every margin holds when looked at twice.", checks
        ),
        constraints=tuple(constraints),
        variables=(
            data.Variable("motor.valve_plate.supply_width", "deg", 24, 30, (28.4, 27.6)),
            data.Variable("motor.valve_plate.shift", "deg", -2, 2, (0.0, 0.4)),
        ),
        search=make_search(),
        sensitivities=(
            data.Sensitivity(
                "motor.valve_plate.shift", "torque_ripple", 0.009, 0.011, 0.006, "± 0.2 deg"
            ),
            data.Sensitivity(
                "motor.valve_plate.supply_width",
                "torque_ripple",
                0.0055,
                0.0071,
                0.006,
                "± 0.3 deg",
            ),
        ),
        provenance=data.Provenance(
            "wheel_motor.toml",
            '[motor]\nname = "Wheel motor <0.4 L/rev> & friends"\npistons = 8\n',
            '[motor]\nname = "better"\n',
            {"camring": "0.1.0", "jax": "0.10.2", "Python": "3.11.9"},
            {"seed": "7", "budget": "140 evaluations"},
            "22 November 2026",
        ),
    )
