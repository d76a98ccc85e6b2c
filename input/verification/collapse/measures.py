"""Energy of the collapsing block: work of the weight against stored and dissipated energy."""

import numpy as np

GRAVITY = 10.0  # m/s2 at time 1, reached in a ramp
STRENGTH = np.sqrt(1.5) * 20.0  # kPa, the radius as uniaxial strength


def work_of_weight(job):
    """Mean force times fall of the centre of mass, summed over the increments. [kJ/m]"""
    ledger = job.ledger
    weight = GRAVITY * ledger["time"] * ledger["mass"]
    fall = -np.diff(ledger["centre"][:, 1])
    return float(np.sum(0.5 * (weight[1:] + weight[:-1]) * fall))


def internal_energy(job):
    """Elastic energy and plastic work of all points at the end of the run. [kJ/m]"""
    last = job.points.n_steps - 1
    tau, strain = job.points.field("TAU", last), job.points.field("LE", last)
    shear_twice = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
    volume_0 = job.points.field("VOL", last) / job.points.field("JBAR", last)
    elastic = 0.5 * (tau * strain * shear_twice).sum(axis=1)
    return float(np.sum(volume_0 * (elastic + STRENGTH * job.points.field("PEEQ", last))))


def energy_ratio(job):
    """Internal energy over the work of the weight; 1 when energy is balanced."""
    return internal_energy(job) / work_of_weight(job)


def points_left(job):
    """Points at the end of the run."""
    return float(job.ledger["count"][-1] - job.ledger["lost"][-1])


def mass_ratio(job):
    """Mass at the end over that at the start."""
    return float(job.ledger["mass"][-1] / job.ledger["mass"][0])


def cuts(job):
    """Attempts that failed, over the whole run."""
    table = job.iterations
    increment = np.stack([table["step"], table["increment"]], axis=1)
    attempt = np.column_stack([increment, table["attempt"]])
    return float(len(np.unique(attempt, axis=0)) - len(np.unique(increment, axis=0)))
