"""tools/bench: its decks, what it reads from a run, the figures, the limits and the page."""

import json
import math
import re
import subprocess
import sys

import numpy as np
import pytest
from benching import cases, page, post
from benching.__main__ import main
from benching.cases import CASES, DEFAULT, BenchError, Case, write_deck
from benching.judging import Limit, limits_of
from benching.kernels import BYTES, FLOPS, measure_kernel
from benching.measuring import (
    compare_solvers,
    exponents,
    growth,
    kernel_growth,
    kernel_sum,
    kernel_table,
    roofline,
    thread_speed_up,
    worst_increment,
)
from benching.plots import PLOTS, draw_plots
from benching.running import (
    KERNELS,
    PARTS,
    largest_difference,
    plastic_increments,
    read_history,
    run_deck,
)
from conftest import ROOT

PAPER = next(case for case in CASES if case.name == "footing-522")
SOLVERS = ["DIRECT", "RECYCLED"]


def run_of(size=1.0, linear=1.0, cpu=5.0, **values):
    """A run with parts that grow with the size as x, and linear algebra as x^2."""
    seconds = dict.fromkeys(PARTS, size) | {"point_loop": size, "output": 0.1}
    seconds |= {"factorisation": 0.9 * linear * size**2, "solve": 0.1 * linear * size**2}
    return {
        "cpu": cpu, "wall": cpu, "memory": 2**20, "points": int(40000 * size),
        "unknowns": int(2000 * size), "nonzeros": 9, "factor_memory": 1e6,
        "increments": 1, "outputs": 2, "iterations": 7, "plastic_iterations": 7, "seconds": seconds,
        "plastic": dict.fromkeys(KERNELS, 0.15),
        "linear": [{"iterations": 7, "seconds": linear * size**2}],
    } | values  # fmt: skip


def kernel_of(cost=0.1, largest=0.1):
    lines = [
        {"kind": kind, "way": way, "points": n, "plastic": 0, "wall": c * f, "cpu": c * f}
        for kind in FLOPS
        for way, f in (("batched", 1.0), ("residual", 0.6), ("pointwise", 5.0))
        for n, c in ((1000, 0.01), (10000, cost), (1000000, largest))
    ]
    return {"peak_gflops": 100.0, "triad_gbytes": 10.0, "lines": lines, "difference": 1e-14}


@pytest.fixture
def found():
    """Everything that a bench may find, all limits kept."""
    location = {"share_of_time": 1e-4, "share_of_tests": 1e-4, "disagreements": 0, "lost": 0}
    location |= dict.fromkeys(("points", "elements", "crossed", "walk_tests", "bin_tests"), 100.0)
    entries = {}
    for case, size in zip(CASES, (0.01, 0.02, 1, 2.5, 5, 15, 30)):
        runs = {"DIRECT/1": [run_of(size)], "RECYCLED/1": [run_of(size, 0.2)]}
        runs["RECYCLED/2"] = [run_of(size, 0.2)]
        runs["RECYCLED/2"][0]["seconds"]["point_loop"] /= 2.0
        entries[case.name] = {"n_runs": 1, "runs": runs, "difference": 1e-10}
    return {
        "processor": "Some Processor", "runs": 3, "solvers": SOLVERS, "cases": entries,
        "kernel": {"1": [kernel_of()], "2": [kernel_of(0.05)]},
        "location": [location | {"location_seconds": 1e-3}], "post_ok": True,
    }  # fmt: skip


def verdicts(found):
    return {limit.what: limit.verdict for limit in limits_of(found, CASES)}


# --- decks ---------------------------------------------------------------------------------------


def test_deck_of_the_paper_is_not_changed(tmp_path):
    text = write_deck(PAPER, DEFAULT, tmp_path / "paper", ROOT).read_text()
    mesh = ROOT / "input" / "footing" / "footing.msh"
    original = (ROOT / "input" / "footing" / "footing.inp").read_text()
    assert text == original.replace("footing.msh", str(mesh))


def test_solver_is_asked_for_in_every_deck(tmp_path):
    for case in CASES:
        small = Case(case.name, case.deck)
        text = write_deck(small, "RECYCLED", tmp_path / case.name, ROOT).read_text()
        assert text.count("\n*CONTROLS, LINEAR SOLVER=RECYCLED\n*BOUNDARY\n") == 1


def test_controls_of_a_case_stand_in_its_deck(tmp_path):
    case = Case("stretch", CASES[0].deck, controls="TOLERANCE=1e-10")
    text = write_deck(case, "DIRECT", tmp_path / "solver", ROOT).read_text()
    assert text.count("\n*CONTROLS, TOLERANCE=1e-10, LINEAR SOLVER=DIRECT\n*BOUNDARY\n") == 1
    text = write_deck(case, DEFAULT, tmp_path / "default", ROOT).read_text()
    assert text.count("\n*CONTROLS, TOLERANCE=1e-10\n*BOUNDARY\n") == 1


def test_finer_footing_takes_a_few_increments(tmp_path, monkeypatch):
    monkeypatch.setattr(cases, "make_mesh", lambda size, folder, root: folder / f"{size}.msh")
    case = Case("some", "footing/footing.inp", "fine", 4)
    text = write_deck(case, DEFAULT, tmp_path / "some", ROOT).read_text()
    assert f'FILE="{tmp_path}/meshes/fine.msh"' in text
    assert "\n0.05, 0.2\n" in text
    assert "FOOTING, 3, 3, -0.0004\n" in text
    assert "*OUTPUT, FIELD, FREQUENCY=4\nPEEQ\n" in text
    assert "*EXPECT" not in text
    assert text.endswith("*END STEP\n")


def test_deck_that_has_changed_is_told(tmp_path):
    with pytest.raises(BenchError, match=r"has changed: expected one 0\.05, 1\.0"):
        cases.shorten("*STATIC\n0.1, 1.0\n", 4)
    with pytest.raises(BenchError, match="expected \\*BOUNDARY without parameters"):
        cases.put_before("*BOUNDARY, OP=NEW\n", "*BOUNDARY", "*CONTROLS\n")


@pytest.mark.parametrize(
    ("parameters", "expected"),
    [
        ([], (DEFAULT,)),
        ([{"name": "LINEAR SOLVER", "choices": ["DIRECT", "RECYCLED", "MUMPS"]}], tuple(SOLVERS)),
        ([{"name": "LINEAR SOLVER", "choices": ["DIRECT"]}], ("DIRECT",)),
    ],
)
def test_solvers_are_those_of_the_schema(tmp_path, parameters, expected):
    schema = {"keywords": [{"keyword": "*CONTROLS", "parameters": parameters}]}
    program = tmp_path / "program"
    program.write_text(f"#!/bin/sh\ncat <<'END'\n{json.dumps(schema)}\nEND\n")
    program.chmod(0o755)
    assert cases.available_solvers(program) == expected


# --- runs ----------------------------------------------------------------------------------------


def test_run_tells_sizes_and_seconds(tessera_release, tmp_path):
    deck = write_deck(Case("stretch", "stretch/stretch.inp"), DEFAULT, tmp_path / "run", ROOT)
    run = run_deck(tessera_release, deck, 1)
    assert (run["points"], run["unknowns"], run["increments"]) == (440, 42, 17)
    assert run["nonzeros"] > run["unknowns"]
    assert run["iterations"] == sum(row["iterations"] for row in run["linear"])
    assert run["plastic_iterations"] == run["iterations"]  # it yields in the first increment
    scale = 1e6 / (440 * run["iterations"])
    for part in KERNELS:
        assert run["plastic"][part] == pytest.approx(run["seconds"][part] * scale)
    assert sum(run["seconds"][part] for part in PARTS) <= run["cpu"]
    assert run["memory"] > 2**20
    assert run["factor_memory"] > 0.0
    assert largest_difference(*[read_history(deck.with_suffix(".vtkhdf"))] * 2) == 0.0


def test_run_that_fails_is_told(tessera_release, tmp_path):
    (tmp_path / "bad.inp").write_text("*NO SUCH KEYWORD\n")
    with pytest.raises(BenchError, match=r"bad\.inp ended with exit code 2"):
        run_deck(tessera_release, tmp_path / "bad.inp", 1)


def test_last_attempt_says_whether_points_flow(tmp_path):
    log = tmp_path / "some.log"
    log.write_text(
        "step 1 increment 1 attempt 1, time 1\n"
        "  iteration    0 residual 1.0E+00 plastic points 0\n"
        "step 1 increment 2 attempt 1, time 2\n"
        "  iteration    1 residual 1.0E-09 plastic points 7 gmres 3\n"
        "step 1 increment 3 attempt 1, time 3\n"
        "  iteration    1 residual 1.0E+00 plastic points 7\n"
        "step 1 increment 3 attempt 2, time 3\n"
        "  iteration    1 residual 1.0E-10 plastic points 0\n"
    )
    assert plastic_increments(log) == [2]


def test_histories_are_compared_column_by_column():
    one = {"time": np.array([1.0, 2.0]), "RF1[A]": np.array([1.0, -4.0]),
           "RF2[A]": np.array([1e-15, 0.0]), "U1[A]": np.array([1e-6, 2e-6])}  # fmt: skip
    other = {name: column.copy() for name, column in one.items()}
    assert largest_difference(one, other) == 0.0
    other["RF1[A]"][0] += 4e-9
    assert largest_difference(one, other) == pytest.approx(1e-9)
    other["U1[A]"][0] += 2e-12
    assert largest_difference(one, other) == pytest.approx(1e-6)
    other["U1[A]"] = one["U1[A]"]
    other["RF2[A]"] = np.array([-1e-15, 0.0])  # rounding beside the 4 of RF1
    assert largest_difference(one, other) == pytest.approx(1e-9)
    assert largest_difference(one, {"time": one["time"]}) == math.inf


# --- figures -------------------------------------------------------------------------------------


def test_growth_is_an_exponent():
    assert growth([1.0, 2.0, 4.0], [3.0, 12.0, 48.0]) == pytest.approx(2.0)
    assert math.isnan(growth([1.0], [3.0]))
    assert math.isnan(growth([1.0, 2.0], [0.0, 3.0]))


def test_parts_grow_as_they_do(found):
    table = exponents(found, CASES, "DIRECT/1")
    assert table["stress"] == pytest.approx((1.0, 1.0))
    assert table["factorisation"] == pytest.approx((2.0, 2.0))


def test_seven_iterations_are_counted_in_factorisations():
    run = {"linear": [{"iterations": 3, "seconds": 2.0}, {"iterations": 14, "seconds": 3.0}]}
    assert worst_increment([run], 0.5) == pytest.approx(4.0)
    run["linear"][1]["seconds"] = 6.0
    assert worst_increment([run], 0.5) == pytest.approx(6.0)


def test_solvers_are_compared(found):
    row = compare_solvers(found["cases"]["footing-16000"])
    assert row["share"] == pytest.approx(0.2)
    assert row["iterations"] == [7, 7]
    assert row["factorisations"] == pytest.approx(0.2 * 7 / 0.9)
    del found["cases"]["stretch"]["runs"]["DIRECT/1"]
    assert compare_solvers(found["cases"]["stretch"]) is None


def test_threads_are_compared_by_wall_time(found):
    assert thread_speed_up(found["cases"]["stretch"], "RECYCLED") == pytest.approx(2.0)
    assert thread_speed_up(found["cases"]["stretch"], "DIRECT") is None
    assert kernel_sum([run_of()]) == pytest.approx(0.45)


def test_roofline_counts_operations_and_bytes():
    rows = roofline([kernel_of(0.1, 0.2)])
    row = next(row for row in rows if (row["kind"], row["way"]) == ("plastic", "batched"))
    assert row["points"] == 1000000
    assert row["gflops"] == pytest.approx(FLOPS["plastic"] / 200.0)
    assert row["gbytes"] == pytest.approx(BYTES / 200.0)
    assert row["of_peak"] == pytest.approx(row["gflops"] / 100.0)
    assert row["of_triad"] == pytest.approx(row["gbytes"] / 10.0)
    assert kernel_growth(kernel_table([kernel_of(0.1, 0.2)])) == pytest.approx(2.0)


def test_kernel_program_is_read(tmp_path):
    program = tmp_path / "program"
    program.write_text(
        "#!/bin/sh\necho peak_gflops 90.5\necho triad_gbytes 11.5\n"
        'echo "kernel elastic batched 1782 0 .5 .6"\necho "difference elastic 1782 1.0E-14"\n'
    )
    program.chmod(0o755)
    found = measure_kernel(program, 1)
    assert (found["peak_gflops"], found["triad_gbytes"], found["difference"]) == (90.5, 11.5, 1e-14)
    assert found["lines"][0]["wall"] == 0.6


# --- limits --------------------------------------------------------------------------------------


def test_all_limits_are_kept(found):
    assert set(verdicts(found).values()) == {"ok"}


def spoil_points(found):
    found["cases"]["footing-8000"]["runs"]["RECYCLED/1"][0]["plastic"]["stress"] = 0.4


def spoil_growth(found):
    found["kernel"]["1"] = [kernel_of(0.1, 0.2)]


def spoil_paper(found):
    found["cases"]["footing-522"]["runs"]["RECYCLED/1"][0]["cpu"] = 7.0


def spoil_output(found):
    found["cases"]["footing-522"]["runs"]["RECYCLED/1"][0]["seconds"]["output"] = 1.0


def spoil_share(found):
    found["cases"]["footing-522"]["runs"]["RECYCLED/1"] = [run_of(1.0, 0.4)]


def spoil_increment(found):
    found["cases"]["footing-16000"]["runs"]["RECYCLED/1"] = [run_of(30, 0.4)]


def spoil_count(found):
    found["cases"]["strip"]["runs"]["RECYCLED/1"][0]["iterations"] = 9


def spoil_history(found):
    found["cases"]["strip"]["difference"] = 1e-7


def spoil_memory(found):
    found["cases"]["footing-16000"]["runs"]["RECYCLED/1"][0]["memory"] = 2**31


def spoil_exact(found):
    found["cases"]["footing-16000"]["runs"]["DIRECT/1"][0]["memory"] = 2**31


def spoil_threads(found):
    found["cases"]["footing-522"]["runs"]["RECYCLED/2"][0]["seconds"]["point_loop"] = 1.0


def spoil_location(found):
    found["location"][0]["share_of_time"] = 3e-4


def spoil_kernels(found):
    found["kernel"]["1"][0]["difference"] = 1e-6


SPOILT = {
    spoil_points: ["kinematics + stress + assembly, footing-8000",
                   "the same, largest of the series over footing-522"],
    spoil_growth: ["stress update, cost per point at a million over fewer"],
    spoil_paper: ["everything, footing-522"],
    spoil_output: ["output every increment, footing-522"],
    spoil_share: ["linear algebra of RECYCLED over DIRECT, footing-522"],
    spoil_increment: ["linear algebra of 7 iterations, footing-16000"],
    spoil_count: ["Newton iterations of RECYCLED over DIRECT"],
    spoil_history: ["histories of both"],
    spoil_memory: ["peak memory over 1.3 factors of UMFPACK + 600 bytes per point, footing-16000, "
                   "RECYCLED"],
    spoil_exact: ["peak memory over 1.3 factors of UMFPACK + 600 bytes per point, footing-16000, "
                  "DIRECT"],
    spoil_threads: ["point loop with two threads, footing-522"],
    spoil_location: ["location, CPU time over a naive search"],
    spoil_kernels: ["both kernels, largest difference"],
}  # fmt: skip


@pytest.mark.parametrize("spoil", SPOILT, ids=lambda spoil: spoil.__name__)
def test_limit_that_is_passed_fails(found, spoil):
    spoil(found)
    failed = [what for what, verdict in verdicts(found).items() if verdict == "FAILED"]
    assert failed == SPOILT[spoil]


def test_what_was_not_run_is_not_judged(found):
    found |= {"cases": {}, "kernel": {}, "location": [], "solvers": [DEFAULT]}
    assert set(verdicts(found).values()) == {"not measured"}
    assert Limit("some", math.nan, 1.0).verdict == "FAILED"


def test_time_and_memory_of_pictures_are_judged(tmp_path, monkeypatch, capsys):
    measured = {"picture": (1.0, 100.0), "report": (59.0, 100.0)}
    monkeypatch.setattr(post, "make_results", lambda *arguments: tmp_path / "job")
    monkeypatch.setattr(post, "measure", lambda command, job: measured[command])
    assert post.bench_post(3, tmp_path / "bin" / "program", ROOT, {}) is True
    measured["picture"] = (1.0, 3000.0)
    assert post.bench_post(3, tmp_path / "bin" / "program", ROOT, {}) is False
    assert "3000   <= 5 s after import and 2048 MiB: FAILED" in capsys.readouterr().out


# --- the page and the program --------------------------------------------------------------------


def test_page_has_limits_tables_and_figures(found, tmp_path):
    draw_plots(found, CASES, tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {f"{name}.png" for name in PLOTS}
    text = page.page_text(found, CASES, limits_of(found, CASES))
    for name in PLOTS:
        assert f"](figures/{name}.png)" in text
    assert "\nProcessor: Some Processor. Medians of 3 runs (fewer of stretch, strip," in text
    assert "| everything, footing-522 | 5.00 | <= 6 s of CPU | ok |" in text
    assert f"| sum | {FLOPS['elastic']} | {FLOPS['plastic']} |" in text
    widths = [line.count("|") for line in text.splitlines() if line.startswith("| ")]
    assert min(widths) >= 4


def test_page_says_what_failed(found):
    spoil_paper(found)
    text = page.page_text(found, CASES, limits_of(found, CASES))
    assert "| everything, footing-522 | 7.00 | <= 6 s of CPU | **FAILED** |" in text


def test_page_without_solvers_to_compare(found, tmp_path):
    for entry in found["cases"].values():
        entry["runs"] = {f"{DEFAULT}/{n}": entry["runs"][f"RECYCLED/{n}"] for n in (1, 2)}
    found["solvers"] = [DEFAULT]
    draw_plots(found, CASES, tmp_path)
    assert not (tmp_path / "performance_solvers.png").exists()
    text = page.page_text(found, CASES, limits_of(found, CASES))
    assert "## DIRECT against RECYCLED" not in text


@pytest.mark.parametrize(
    ("value", "text"),
    [(None, "-"), (math.nan, "-"), (0.0, "0"), (0.012345, "0.0123"), (12345.6, "12,346"),
     (1.2345e-9, "1.23e-09")],
)  # fmt: skip
def test_numbers_have_three_digits(value, text):
    assert page.number(value) == text


def bench(*arguments):
    command = [sys.executable, ROOT / "tools" / "benching", *map(str, arguments)]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    return run.returncode, run.stdout, run.stderr


def test_figures_of_an_earlier_bench_are_judged(found, tmp_path):
    path = tmp_path / "bench.json"
    path.write_text(json.dumps(found))
    code, out, err = bench("--from", path)
    assert (code, err) == (0, "")
    assert re.search(r"^everything, footing-522 +5.00 +<= 6 s of CPU +ok$", out, re.MULTILINE)
    spoil_paper(found)
    path.write_text(json.dumps(found))
    assert bench("--from", path)[0] == 1


def test_wrong_options_are_told(tmp_path):
    code, _, err = bench("--case", "foo")
    assert code == 2
    assert "--case: expected some of stretch, strip, footing-522" in err
    assert main(["--from", str(tmp_path / "none.json")]) == 2
