"""What mutations are made of: numbers, words and bytes that programs stumble over."""

from random import Random

NUMBERS = """
0 -0 1 -1 2 3 4 -3 7 10 0.5 -0.5 0.25 0.3 0.49 0.499999999999 0.5000001 -0.999 -1.0 1.0 100
1000000000 2147483646 2147483647 2147483648 -2147483647 -2147483648 -2147483649 4294967296
9223372036854775807 9223372036854775808 -9223372036854775808 18446744073709551616
1e9 1e18 1e20 1e30 1e60 1e99 1e100 1e101 1e150 1e154 1e155 1e200 1e300 1e307 1e308 -1e308
1.7976931348623157e308 1.7976931348623159e308 1e309 -1e309 1e99999 1e99999999999 1e-5 1e-9 1e-15
1e-20 1e-60 1e-100 1e-150 1e-160 1e-200 1e-300 2.2250738585072014e-308 1e-308 1e-320 4.9e-324
1e-325 -1e-308 1e-99999999999 nan NaN -nan inf -inf +inf Infinity NaN(1) 0x10 1d5 1D-3 1q5 1e 1e+
e5 + - . -. 1. .5 1..2 1.2.3 --1 +-1 2*3. 1/3 / 1_dp 1,5 1;5 1'000 1e5e5 ١٢ ½
""".split()

LONG_NUMBERS = (
    "1" * 10000,
    "9" * 10000 + "e-9990",
    "0." + "0" * 10000 + "1",
    "0" * 10000 + "1",
    "-" + "3" * 310,
    "0." + "3" * 10000,
    "1e" + "9" * 10000,
    "1e-" + "9" * 10000,
    "1" + "0" * 10000 + "e-10000",
    "1." + "0" * 400 + "1e1",
)

WORDS = """
ALL X0 X1 Y0 Y1 Z0 Z1 BODY NONE YES NO SOIL CLAY NSET ELSET GENERATE STEP S U RF PEEQ LE PATCH
STANDARD FBAR METIS QUADRATIC ERROR REMOVE FREEZE CPE3 CPE6 C3D4 C3D10 S3 T3D2 T3D3 STRI65 GRAV P
TRVEC analytic frozen NEW MOD x y z
""".split()

PIECES = (
    '"', '""', '"""', "'", ",", ",,", ",,,,,,,,", "=", "==", "*", "**", " ** ", "***", "\t", " ",
    "_", "-", "--", "*STEP", "*END STEP", "*INCLUDE, INPUT=", "*MESH, FILE=", "/", "\\", "%s%n",
    "$(x)", "{", ";", ":", "\x1b[31m", "\u00e9", "\u202e", "\ufeff", "\U0001f480", "e\u0301", "",
)  # fmt: skip

BYTES = (
    b"\0", b"\r", b"\n", b"\r\n", b"\x7f", b"\x01", b"\x1a", b"\x1b", b"\x80", b"\xbf", b"\xc0\x80",
    b"\xc3", b"\xe2\x82", b"\xed\xa0\x80", b"\xf4\x90\x80\x80", b"\xf8\x88\x80\x80\x80", b"\xfe",
    b"\xff", b"\xff\xfe", b"\xef\xbb\xbf", b"\xef\xbb", b"\x0b", b"\x0c", b"\x85", b"\xc2\x85",
)  # fmt: skip


def number(random: Random) -> str:
    """A number, or what looks like one."""
    kind = random.random()
    if kind < 0.02:
        return random.choice(LONG_NUMBERS)
    if kind < 0.75:
        return random.choice(NUMBERS)
    if kind < 0.85:
        return str(random.randint(-(2 ** random.randint(1, 66)), 2 ** random.randint(1, 66)))
    return repr(random.uniform(-2, 2) * 10 ** random.uniform(-3, 3))


def word(random: Random) -> str:
    """A name, short or absurd."""
    kind = random.random()
    if kind < 0.8:
        return random.choice(WORDS)
    if kind < 0.83:
        return "N" * random.choice((79, 80, 81, 2047, 2048, 2049, 10000))
    return "".join(random.choice("ABCxyz019_- .*,=\"'\u00e9") for _ in range(random.randint(0, 12)))


def near(random: Random, text: str) -> str:
    """A number close to another one, in value or in writing."""
    kind = random.randrange(9)
    if kind == 0 or not text:
        return number(random)
    if kind < 4:
        return ("-" + text, text + random.choice("0e.,-+ d"), text[:-1])[kind - 1]
    try:
        value = float(text)
    except ValueError:
        return number(random)
    if "." not in text and abs(value) < 1e15 and kind < 7:
        return str(int(value) + random.choice((-2, -1, 1, 2)))
    return repr(value * random.choice((0.0, 0.5, 1.0000000000000002, 2.0, -1.0, 10.0, 1e-8, 1e8)))
