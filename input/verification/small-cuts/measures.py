"""What *EXPECT cannot say about the small cuts: eigenvalues of the tangent."""

from pathlib import Path

from tessera_post.job import Job
from tessera_post.style import COLORS, MARKERS, plt, save

YOUNG, POISSON = 1000.0, 0.3
HEIGHT = 0.8  # of the apex above its base: its gradient is 1/HEIGHT
CROSSED = {2: 1 / 4, 3: 1 / 12}  # volume of the points that crossed, over the depth of the sliver


def smallest_eigenvalue(job: Job) -> float:
    """Of the tangent in the last increment."""
    return float(job.ledger["eigen_min"][-1])


def depth_of(name: str) -> float:
    """Depth of the sliver in the name of a job."""
    return float("-".join(name.removesuffix("-far").split("-")[-2:]))


def over_that_of_the_cut(job: Job) -> float:
    """Smallest eigenvalue over that of the apex alone, sheared on a rigid body."""
    shear_modulus = YOUNG / (2 * (1 + POISSON))
    n_dim = int(job.name[0])
    volume = CROSSED[n_dim] * depth_of(job.name)
    return smallest_eigenvalue(job) / (shear_modulus * volume / HEIGHT**2)


def over_that_of_job(job: Job, other: str) -> float:
    """Smallest eigenvalue over that of another job."""
    reference = Job(job.folder / f"{other}.vtkhdf")
    try:
        return smallest_eigenvalue(job) / smallest_eigenvalue(reference)
    finally:
        reference.close()


def draw_eigenvalues(jobs: dict[str, Job], path: Path) -> None:
    """Smallest eigenvalue over the depth of the sliver, without and with the penalty."""
    figure, axes = plt.subplots(figsize=(7.0, 4.6))
    for i, n_dim in enumerate(CROSSED):
        for ghost, fill in (("off", "full"), ("on", "none")):
            kind = f"{n_dim}d-standard-{ghost}-"
            names = [name for name in jobs if name.startswith(kind) and not name.endswith("-far")]
            names.sort(key=depth_of)
            found = [smallest_eigenvalue(jobs[name]) for name in names]
            label = f"{n_dim}-D, {'with' if ghost == 'on' else 'without'} penalty"
            look = {"color": COLORS[i], "marker": MARKERS[i], "fillstyle": fill}
            axes.loglog([depth_of(name) for name in names], found, label=label, **look)
    axes.set(xlabel="depth of the sliver, in proportion to the filled part")
    axes.set(ylabel="smallest eigenvalue of the tangent")
    axes.set_xticks([1e-5, 1e-4, 1e-3, 1e-2], ["1e-5", "1e-4", "1e-3", "1e-2"])
    axes.set_yticks([1e-3, 1e-2, 1e-1, 1.0], ["0.001", "0.01", "0.1", "1"])
    axes.legend(loc="best", fontsize=9)
    save(figure, path)
