"""Efficiencies of a record, by the second solver."""


def efficiencies(found: dict[str, float], bench_power: float) -> dict[str, float]:
    """As a bench reads them, and of the balance of energy; turned over for a pump."""
    fed, out, ports = found["input_power"], found["output_power"], found["port_power"]
    if fed < 0:  # oil is what comes out, and the shaft is what drives
        total, energy = bench_power / out, fed / out
        torque_share = abs(found["ideal_torque"]) / -found["mean_torque"]
    else:
        total, energy = out / bench_power, out / fed
        torque_share = found["mean_torque"] / abs(found["ideal_torque"])
    return {
        "efficiency": total,
        "energy_efficiency": energy,
        "port_efficiency": ports / out if ports < 0 else out / ports,
        "hydromechanical_efficiency": torque_share,
        "volumetric_efficiency": total / torque_share,
    }
