"""Small verification cases for the tests of tools/verify."""

from post_runs import bar_deck

README = "# Bar\n"
CASE = """\
title = "Plastic bar"
summary = "A bar flows."

[[deck]]
file = "bar.inp"
label = "quick"

[[deck]]
file = "long.inp"
label = "slow"

[[measure]]
name = "plastic strain"
function = "mean_strain"
arguments = {factor = 2.0}
decks = ["bar.inp", "long.inp"]
exact = 0.2
atol = 0.05
frozen = {"bar.inp" = 0.2, "long.inp" = 0.3}

[[study]]
name = "strain"
measure = "plastic strain"
decks = ["bar.inp", "long.inp"]
h = [1.0, 0.5]
order = 1.0

[[figure]]
file = "bar.png"
caption = "Force of the bar"
command = ["curve", "bar"]
"""
MEASURES = '''\
"""Measures of the bar."""


def mean_strain(job, factor):
    """Mean plastic strain of the points."""
    return factor * job.points.field("PEEQ", job.points.n_steps - 1).mean()


def text(job):
    """No number."""
    return "none"


def draw(jobs, path):
    """Writes the names of the jobs."""
    path.write_text(" ".join(jobs))
'''
EXPECT = """\
*EXPECT, QUANTITY=U, SET=X1, COMPONENT=1
analytic, 0.4, 1e-12
*EXPECT, QUANTITY=RF, SET=X1, COMPONENT=1
frozen, 20.0, 1e-6 ** of an earlier program
"""


def make_case(root, case=CASE, name="bar", expect=EXPECT):
    """Writes a case into a folder of cases; its folder."""
    folder = root / name
    folder.mkdir(parents=True)
    (folder / "case.toml").write_text(case)
    (folder / "README.md").write_text(README)
    (folder / "measures.py").write_text(MEASURES)
    for job, size in (("bar", 0.5), ("long", 0.25)):
        (folder / f"{job}.inp").write_text(bar_deck(size=size, expect=expect))
    return folder
