"""The exact homogeneous state under dead tractions, and how far a job is from it."""

import numpy as np
from tessera_post.job import FORMULATIONS, Job
from tessera_post.style import COLORS, MARKERS, plt, save
from verification.figures import number_errors

YOUNG, POISSON = 1000.0, 0.3
VOIGT = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))

# First Piola stress P of the loads: what is on and above the diagonal. The rest follows from the
# balance of moments when no side rotates that the supports hold.
LOADS = {
    "pressure": [[-120.0, 0.0, 0.0], [0.0, -120.0, 0.0], [0.0, 0.0, -120.0]],
    "oblique": [[120.0, 60.0, -30.0], [0.0, -80.0, 45.0], [0.0, 0.0, 50.0]],
    "diagonal": [[120.0, 0.0, 0.0], [0.0, -80.0, 0.0], [0.0, 0.0, 100.0]],
}


def kirchhoff(f):
    """(3, 3) Kirchhoff stress of a deformation gradient: Hencky's law, theory.md (7)."""
    bulk, shear = YOUNG / (3 * (1 - 2 * POISSON)), YOUNG / (2 * (1 + POISSON))
    stretch, axes = np.linalg.eigh(f @ f.T)
    strain = 0.5 * np.log(stretch)
    principal = (bulk - 2 * shear / 3) * strain.sum() + 2 * shear * strain
    return axes @ np.diag(principal) @ axes.T


def piola(f):
    """(3, 3) first Piola stress P = tau F^-T."""
    return kirchhoff(f) @ np.linalg.inv(f).T


def exact_deformation(load, n_dim):
    """(3, 3) upper triangular F whose P has the given entries on and above the diagonal."""
    rows, columns = np.triu_indices(n_dim)
    wanted = np.array(LOADS[load])[rows, columns]
    f = np.eye(3)
    for _ in range(50):
        error = piola(f)[rows, columns] - wanted
        slope = np.empty((len(rows), len(rows)))
        for k in range(len(rows)):
            step = np.zeros((3, 3))
            step[rows[k], columns[k]] = 1e-6
            slope[:, k] = (piola(f + step) - piola(f - step))[rows, columns] / 2e-6
        change = np.linalg.solve(slope, error)
        f[rows, columns] -= change
        if np.abs(change).max() < 1e-15:
            break
    assert np.abs(piola(f)[rows, columns] - wanted).max() < 1e-11 * np.abs(wanted).max()
    return f


def exact_cauchy(load, n_dim):
    """(6) Cauchy stress in Voigt order."""
    f = exact_deformation(load, n_dim)
    stress = kirchhoff(f) / np.linalg.det(f)
    return np.array([stress[place] for place in VOIGT])


def stress_error(job: Job, load: str) -> float:
    """Largest difference of the Cauchy stress of any point over the exact stress."""
    exact = exact_cauchy(load, job.n_dim)
    found = job.points.field("S", job.output_of())
    return float(np.abs(found - exact).max() / np.abs(exact).max())


def stress_norm(job: Job, load: str) -> float:
    """Root of the mean square of the difference of the Cauchy stress over the exact stress."""
    exact = exact_cauchy(load, job.n_dim)
    found = job.points.field("S", job.output_of())
    volume = job.points.field("VOL", 0)
    square = volume @ np.square(found - exact).sum(axis=1) / volume.sum()
    return float(np.sqrt(square) / np.linalg.norm(exact))


def displacement_error(job: Job, load: str) -> float:
    """Largest difference of the displacement of any point over the largest exact one."""
    gradient = exact_deformation(load, job.n_dim) - np.eye(3)
    last = job.output_of()
    found = job.points.field("U", last)
    exact = (job.points.points(last) - found) @ gradient.T
    return float(np.abs(found - exact).max() / np.abs(exact).max())


def draw_crossing(jobs: dict[str, Job], path) -> None:
    """Error of the stress over the spacing of the points, with both carriers."""
    figure, axes = plt.subplots(figsize=(7.0, 4.6))
    for i, (n_dim, formulation) in enumerate(((2, "standard"), (2, "fbar"), (3, "standard"))):
        label = f"{n_dim}-D, {FORMULATIONS[formulation]}"
        start = f"crossing-{n_dim}d-points-{formulation}-"
        found = sorted(
            (int(name.removeprefix(start)) ** (-1 / n_dim), stress_norm(job, "diagonal"))
            for name, job in jobs.items()
            if name.startswith(start)
        )
        axes.loglog(*zip(*found, strict=True), marker=MARKERS[i], color=COLORS[i], label=label)
        left_behind = jobs[f"crossing-{n_dim}d-mesh-{formulation}-064"]
        axes.loglog(
            [64 ** (-1 / n_dim)],
            [stress_norm(left_behind, "diagonal")],
            marker=MARKERS[i],
            markerfacecolor="none",
            linestyle="none",
            color=COLORS[i],
            label=label + ", load on the mesh",
        )
    ticks = [1 / 2, 1 / 4, 1 / 8, 1 / 16]
    axes.set_xticks(ticks, ["1/2", "1/4", "1/8", "1/16"])
    axes.set_xticks([], minor=True)
    number_errors(axes)
    axes.set(xlabel="spacing of points over edge of element", ylabel="error norm of the stress")
    figure.legend(loc="outside upper center", ncols=2, fontsize=9)
    save(figure, path)
