"""The stand-in for pFUnit must fail where pFUnit fails: a test that cannot fail proves nothing."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
FLAGS = (
    "-g -std=f2008 -Wall -Wextra -pedantic -Wno-uninitialized -Werror "
    "-fcheck=all -ffpe-trap=invalid,zero,overflow"
).split()

DECLARATIONS = """\
module {module}
  use, intrinsic :: iso_fortran_env, only: dp => real64, int64
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_signaling_nan
  use, intrinsic :: ieee_arithmetic, only: ieee_positive_inf
  use funit
  implicit none

  integer, parameter :: i1(3) = [1, 2, 3], i2(2, 2) = reshape([1, 2, 3, 4], [2, 2])
  integer, parameter :: i3(2, 2, 2) = reshape([1, 2, 3, 4, 5, 6, 7, 8], [2, 2, 2])
  integer(int64), parameter :: long = 5000000000_int64
  real(dp), parameter :: r1(3) = i1, r2(2, 2) = i2, r3(2, 2, 2) = i3
  logical, parameter :: l1(2) = [.true., .false.]
  character(3), parameter :: c1(2) = ["abc", "abd"]
contains
"""

# Every assertion must hold in one of these lists and fail in the other.
PASSING = """\
@assertEqual(1, 1)
@assertEqual(i1, i1)
@assertEqual(7, 0 * i2 + 7)
@assertEqual(i3, i3)
@assertEqual(long, long)
@assertEqual([5_int64], [5_int64])
@assertEqual(5, 5_int64)
@assertEqual(1.0_dp, 1.0_dp)
@assertEqual(1.0_dp, 1.1_dp, tolerance=0.11_dp)
@assertEqual(1.0_dp, 1.1_dp, 0.11_dp)
@assertEqual(r1, r1)
@assertEqual(r2, r2 + 0.1_dp, tolerance=0.2_dp)
@assertEqual(r3, r3)
@assertEqual(0.0_dp, 0.0_dp * r3)
@assertEqual(infinity(), infinity())
@assertEqual([real(dp) ::], [real(dp) ::])
@assertEqual("text", "text")
@assertEqual("text", "text  ")
@assertEqual(c1, c1)
@assertEqual(.true., .true.)
@assertEqual(l1, l1)
@assertNotEqual(1, 2)
@assertNotEqual(1.0_dp, 1.1_dp, tolerance=0.05_dp)
@assertNotEqual(.true., .false.)
@assertTrue(.true.)
@assertTrue([.true., .true.])
@assertFalse(.false.)
@assertFalse([.false., .false.])
@assertLessThan(1, 2)
@assertLessThan(0.0_dp, r2)
@assertLessThanOrEqual(r1, r1)
@assertGreaterThan(2.0_dp, 1.0_dp)
@assertGreaterThan(i1 + 1, i1)
@assertGreaterThanOrEqual(long, long)
""".splitlines()

FAILING = """\
@assertEqual(1, 2)
@assertEqual(i1, [1, 2, 4])
@assertEqual(i1, [1, 2])
@assertEqual(i1, [1, 2, 3, 4])
@assertEqual(1, i1)
@assertEqual(i2, transpose(i2))
@assertEqual(i2, reshape(i2, [4, 1]))
@assertEqual(i3, i3 + 1)
@assertEqual(long, 0_int64)
@assertEqual([5_int64], [6_int64])
@assertEqual(705032704, long)
@assertEqual(1.0_dp, 1.0_dp + epsilon(1.0_dp))
@assertEqual(1.0_dp, 1.1_dp, tolerance=0.09_dp)
@assertEqual(1.0_dp, 1.1_dp, 0.09_dp)
@assertEqual(r1, -r1)
@assertEqual(r1, r1(1:2))
@assertEqual(r2, r2 + 0.1_dp, tolerance=0.05_dp)
@assertEqual(r2, reshape(r2, [1, 4]))
@assertEqual(r3, r3(:, :, 2:1:-1))
@assertEqual(r3, r3(:, :, 1:1))
@assertEqual(0.0_dp, r3)
@assertEqual(1.0_dp, quiet_nan(), tolerance=1.0_dp)
@assertEqual(1.0_dp, signalling_nan(), tolerance=1.0_dp)
@assertEqual(quiet_nan(), quiet_nan())
@assertEqual(1.0_dp, infinity(), tolerance=1.0_dp)
@assertEqual([real(dp) ::], r1)
@assertEqual("text", "test")
@assertEqual("text", " text")
@assertEqual(c1, ["abc", "abc"])
@assertEqual(.true., .false.)
@assertEqual(l1, .not. l1)
@assertNotEqual(1, 1)
@assertNotEqual(1.0_dp, 1.1_dp, tolerance=0.2_dp)
@assertNotEqual(1.0_dp, quiet_nan())
@assertNotEqual(.true., .true.)
@assertTrue(.false.)
@assertTrue([.true., .false.])
@assertFalse(.true.)
@assertFalse([.false., .true.])
@assertFail("always")
@assertLessThan(2, 2)
@assertLessThan(1.0_dp, r1)
@assertLessThan(quiet_nan(), 1.0_dp)
@assertLessThan(r1, r1(1:2))
@assertLessThanOrEqual(3.0_dp, 2.0_dp)
@assertLessThanOrEqual(i1, i1 - 1)
@assertGreaterThan(2.0_dp, 2.0_dp)
@assertGreaterThan(i2, i2)
@assertGreaterThanOrEqual(0_int64, long)
@assertGreaterThanOrEqual(1.0_dp, quiet_nan())
""".splitlines()

FUNCTIONS = """\
  real(dp) function quiet_nan() result(x)
    x = ieee_value(x, ieee_quiet_nan)
  end function quiet_nan
  real(dp) function signalling_nan() result(x)
    x = ieee_value(x, ieee_signaling_nan)
  end function signalling_nan
  real(dp) function infinity() result(x)
    x = ieee_value(x, ieee_positive_inf)
  end function infinity
"""


def run(*command, cwd):
    command = [str(word) for word in command]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)


def must_run(*command, cwd):
    result = run(*command, cwd=cwd)
    assert result.returncode == 0, result.stdout + result.stderr


def one_test(name, *statements):
    body = "".join(f"    {statement}\n" for statement in statements)
    return f"  @test\n  subroutine {name}()\n{body}  end subroutine {name}\n"


@pytest.fixture(scope="module")
def funit(tmp_path_factory):
    """A directory with the compiled stand-in."""
    folder = tmp_path_factory.mktemp("funit")
    must_run(sys.executable, HERE / "make_funit.py", "funit.f90", cwd=folder)
    for source in (HERE / "pf_run.f90", HERE / "pf_compare.f90", "funit.f90"):
        must_run(os.environ.get("FC", "gfortran"), *FLAGS, "-c", source, cwd=folder)
    return folder


def translate(folder, text, module="test_sample"):
    """Runs the preprocessor on a suite."""
    source = folder / f"{module}.pf"
    source.write_text(text)
    return run(
        sys.executable, HERE / "pf_to_fortran.py", "suite", source, folder / "suite.f90", cwd=folder
    )


def build(funit, folder, body, module="test_sample"):
    """The executable of a suite."""
    folder.mkdir(exist_ok=True)
    text = DECLARATIONS.format(module=module) + body + FUNCTIONS + f"end module {module}\n"
    result = translate(folder, text, module)
    assert result.returncode == 0, result.stderr
    tool = HERE / "pf_to_fortran.py"
    must_run(sys.executable, tool, "driver", folder / f"{module}.pf", "driver.f90", cwd=folder)
    objects = [funit / f"{name}.o" for name in ("pf_run", "pf_compare", "funit")]
    must_run(
        os.environ.get("FC", "gfortran"), *FLAGS, f"-I{funit}", "suite.f90", "driver.f90", *objects,
        "-o", "suite", cwd=folder,
    )  # fmt: skip
    return folder / "suite"


@pytest.fixture(scope="module")
def assertions(funit, tmp_path_factory):
    """A suite with one test for every assertion of the two lists."""
    tests = [one_test(f"passing_{i}", line) for i, line in enumerate(PASSING)]
    tests += [one_test(f"failing_{i}", line) for i, line in enumerate(FAILING)]
    return build(funit, tmp_path_factory.mktemp("all") / "suite", "".join(tests))


def failures(output):
    return re.findall(r"^Failure in: test_sample_suite\.(\w+)$", output, re.MULTILINE)


def test_every_wrong_assertion_fails_and_no_right_one(assertions):
    result = run(assertions, cwd=assertions.parent)
    expected = [f"failing_{i}" for i in range(len(FAILING))]
    assert failures(result.stdout) == expected, result.stdout
    total = len(PASSING) + len(FAILING)
    assert f"Tests run: {total}, Failures: {len(FAILING)}, Errors: 0" in result.stdout
    assert result.returncode == 2


def test_right_assertions_pass_the_run(assertions):
    result = run(assertions, "-f", "passing", cwd=assertions.parent)
    assert result.returncode == 0
    assert result.stdout.endswith(f" OK\n ({len(PASSING)} tests)\n")
    assert failures(result.stdout) == []


def test_a_run_without_tests_fails(assertions):
    result = run(assertions, "-f", "no such name", cwd=assertions.parent)
    assert result.returncode == 2
    assert "No test ran." in result.stdout


def test_unknown_option_is_refused(assertions):
    assert run(assertions, "--fliter", "x", cwd=assertions.parent).returncode == 1


def test_failure_tells_where_and_what(funit, tmp_path):
    body = one_test(
        "wrong",
        '@assertEqual(r2, r2 + merge(0.5_dp, 0.0_dp, i2 == 3), tolerance=0.25_dp, message="words")',
    )
    result = run(build(funit, tmp_path / "s", body), cwd=tmp_path)
    line = DECLARATIONS.count("\n") + 3
    assert (
        "Failure in: test_sample_suite.wrong\n"
        f"  Location: [test_sample.pf:{line}]\n"
        "words\n"
        "ArrayAssertEqual failure:\n"
        "      Expected: <3.0000000000000000>\n"
        "        Actual: <3.5000000000000000>\n"
        "    Difference: <0.50000000000000000> (greater than tolerance of 0.25000000000000000)\n"
        "      at index: [1,2]\n"
    ) in result.stdout
    assert result.stdout.startswith(".F\n")


def test_shape_mismatch_tells_both_shapes(funit, tmp_path):
    body = one_test("wrong", "@assertEqual(r2, reshape(r2, [4, 1]))")
    result = run(build(funit, tmp_path / "s", body), cwd=tmp_path)
    assert "Expected shape: [2,2]\n      Actual shape: [4,1]\n" in result.stdout


def test_failing_assertion_stops_its_test_only(funit, tmp_path):
    body = one_test("first", "@assertTrue(.false.)", 'write (*, "(a)") "not reached"')
    body += one_test("second", 'write (*, "(a)") "reached"')
    result = run(build(funit, tmp_path / "s", body), cwd=tmp_path)
    assert "not reached" not in result.stdout
    assert "reached" in result.stdout
    assert "Tests run: 2, Failures: 1" in result.stdout


def test_assertion_in_a_helper_fails_the_test(funit, tmp_path):
    body = one_test("uses_helper", "call helper()")
    body += "  subroutine helper()\n    @assertTrue(.false.)\n  end subroutine helper\n"
    assert run(build(funit, tmp_path / "s", body), cwd=tmp_path).returncode == 2


def test_before_and_after_surround_every_test(funit, tmp_path):
    body = "".join(
        f'  @{role}\n  subroutine {role}_test()\n    write (*, "(a)") "{role}"\n'
        f"  end subroutine {role}_test\n"
        for role in ("before", "after")
    )
    body += one_test("first", 'write (*, "(a)") "first"', "@assertTrue(.false.)")
    body += one_test("second", 'write (*, "(a)") "second"')
    result = run(build(funit, tmp_path / "s", body), cwd=tmp_path)
    words = re.findall(r"before|after|first$|second$", result.stdout, re.MULTILINE)
    assert words[:6] == ["before", "first", "after", "before", "second", "after"]


def test_failing_preparation_fails_the_test(funit, tmp_path):
    body = "  @before\n  subroutine prepare()\n    @assertTrue(.false.)\n  end subroutine prepare\n"
    body += one_test("harmless", 'write (*, "(a)") "not reached"')
    result = run(build(funit, tmp_path / "s", body), cwd=tmp_path)
    assert result.returncode == 2
    assert "not reached" not in result.stdout


def suite_text(body, module="test_sample"):
    return f"module {module}\n  use funit\ncontains\n{body}end module {module}\n"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (suite_text(""), "no @test in this file"),
        (suite_text(one_test("a"), "test_other"), "the module must be named test_sample"),
        (suite_text(one_test("a" * 45)), "has 45 characters, 44 at most"),
        (suite_text(one_test("a") + one_test("A")), "a second test named A"),
        (suite_text(one_test("a", "@assertEquals")), "cannot translate '@assertEquals'"),
        (suite_text(one_test("a", "@assertEqual(1, &")), "one macro on one line"),
        (suite_text(one_test("a", "@disable")), "cannot translate '@disable'"),
        (suite_text("@test\n  function a()\n  end function a\n"), "must follow @test"),
        (suite_text("@test\n@test\n  subroutine a()\n  end subroutine a\n"), "must follow @test"),
        (suite_text("@test(npes=[1])\n"), "@test takes no options"),
    ],
)
def test_what_cannot_be_translated_is_an_error(tmp_path, text, words):
    result = translate(tmp_path, text)
    assert result.returncode == 1
    assert words in result.stderr
    assert not (tmp_path / "suite.f90").exists()
