"""Converters as textbooks and application notes have them, against their closed forms."""

import math
from dataclasses import dataclass

import pytest
from scipy.integrate import solve_ivp

import hybond as hb
from hybond.circuits.measured import measure

PARTS = """.model SWI SW(VT=2.5 VH=0.1 RON=1u ROFF=10meg)
.model DI D(RON=1u ROFF=1e9 VFWD=0)
"""


@dataclass(frozen=True)
class Deck:
    """A netlist, what its measurements come to, and how near."""

    rows: str
    values: dict[str, float]
    rel: float = 1e-3


PI = math.pi


def overlap() -> Deck:
    """Commutation takes 3 w L I/pi of the mean, and lasts until cos u = 1 - 2 w L I/(sqrt(3) V)."""
    volts, amps, reach = 325.0, 20.0, 100 * PI * 3.7e-3

    def angle(i: float) -> float:
        return math.acos(1 - 2 * reach * i / (math.sqrt(3) * volts))

    mean = 3 * math.sqrt(3) * volts / PI - 3 * reach * amps / PI
    rows = """Va a 0 SIN(0 325 50)
Vb b 0 SIN(0 325 50 0 0 -120)
Vc c 0 SIN(0 325 50 0 0 120)
La a a1 3.7m
Lb b b1 3.7m
Lc c c1 3.7m
D1 a1 p DI
D3 b1 p DI
D5 c1 p DI
D4 n a1 DI
D6 n b1 DI
D2 n c1 DI
Id p n 20
.tran 20u 60m 20m uic
.meas tran vd AVG v(p,n)
.meas tran u TRIG i(La) VAL=1m RISE=1 TARG i(La) VAL=19.999 RISE=1"""
    return Deck(rows, {"vd": mean, "u": (angle(19.999) - angle(1e-3)) / (100 * PI)}, 1e-5)


def leaking(angle: float, load: str) -> Deck:
    """A bridge with 10 ohm and no choke: two diodes carry, then three, and again after 60 degrees.

    Beside 50 A its nodes are held by 10 Mohm: the diodes without current have next to no digits.
    """
    w, line, coil, load_ohm, ohm, drop = (
        100 * PI,
        325 * math.sqrt(3),
        1e-3,
        10.0,
        258.65e-6,
        8.0792e-3,
    )

    def now(t: float) -> float:
        return line * math.cos(w * t)

    def later(t: float) -> float:
        return line * math.cos(w * t - PI / 3)

    def two(t, y):
        return [(now(t) - 2 * drop - (load_ohm + 2 * ohm) * y[0]) / (2 * coil), load_ohm * y[0]]

    def three(t, y):
        mean = (now(t) + later(t)) / 2 - 2 * drop
        rate = (mean - (load_ohm + 1.5 * ohm) * y[0]) / (1.5 * coil)
        return [rate, load_ohm * y[0], (later(t) - now(t) - ohm * y[2]) / coil]

    def begins(t, y):
        return later(t) - now(t) + coil * two(t, y)[0] + ohm * y[0]

    def ends(t, y):
        return y[0] - y[2]

    begins.terminal = ends.terminal = True
    begins.direction, ends.direction = 1, -1
    t, y, mean = 0.0, 50.0, 0.0
    for _ in range(4):
        a = solve_ivp(two, (t, t + 0.01), [y, 0.0], events=begins, rtol=1e-10, atol=1e-10)
        start, (y, area) = a.t[-1], a.y[:, -1]
        b = solve_ivp(
            three, (start, start + 0.01), [y, area, -y], events=ends, rtol=1e-10, atol=1e-10
        )
        mean = b.y[1, -1] / (b.t[-1] - t)
        t, y = b.t[-1] - 1 / 300, b.y[0, -1]
    rows = ""
    for k, n in enumerate("abc"):
        rows += f"V{n} s{n} 0 SIN(0 325 50 0 0 {angle - 120 * k})\nL{n} s{n} {n} 1m\n"
        rows += f"Rl{n} {n} 0 10meg\nD{n}1 {n} p DX\nD{n}2 m {n} DX\n"
    rows += f"""Ro {load} 10
.model DX D(N=0.01)
.tran 10u 60m uic
.meas tran vd AVG v(p,m) from=40m to=60m"""
    return Deck(rows, {"vd": float(mean)}, 1e-7)


DECKS = {
    "overlap of a bridge of six diodes": overlap(),
    "a bridge of six diodes at leaking nodes": leaking(17.3, "p m"),
    "the same, its load turned": leaking(17.3, "m p"),
    "the same at another instant": leaking(3.1, "p m"),
    "the same at a third one": leaking(41, "p m"),
    "a hysteresis that reads a current": Deck(
        # between the limits the output is a source of 7.5 V
        """V1 in 0 24
Hs cs 0 Vs -1
S1 in sw cs 0 SWH
.model SWH SW(VT=-3 VH=0.4 RON=1u ROFF=10meg)
D1 0 sw DI
L1 sw s 120u
Vs s out 0
V2 out 0 7.5
.tran 0.1u 1m 0.1m uic
.meas tran il AVG i(L1) FROM=200u TO=800u
.meas tran t TRIG i(L1) VAL=3 RISE=1 TARG i(L1) VAL=3 RISE=11""",
        {"il": 3.0, "t": 10 * 120e-6 * 0.8 * (1 / 16.5 + 1 / 7.5)},
        3e-3,
    ),
    "a relay that opens its own coil": Deck(
        """V1 in 0 24
S1 in m c 0 SR
.model SR SW(VT=-0.35 VH=0.15 RON=1u ROFF=10meg)
Hc c 0 Vm -1
Lc m x 0.2
Rc x y 30
Vm y 0 0
Df 0 m DI
.tran 10u 100m uic
.meas tran p TRIG i(Lc) VAL=0.3 RISE=2 TARG i(Lc) VAL=0.3 RISE=5""",
        {"p": 3 * 0.2 / 30 * (math.log(0.5 / 0.2) + math.log(0.6 / 0.3))},
        1e-5,
    ),
    "a crowbar that a current fires": Deck(
        """V1 in 0 PWL(0 10 1m 10 1.1m 30 5m 30)
R1 in a 2
Vs a b 0
RL b 0 8
W1 b cr Vs WM
Rcr cr 0 0.1
.model WM CSW(IT=2 IH=0.5 RON=0.02 ROFF=10meg)
.tran 1u 5m uic
.meas tran t WHEN i(Vs)=3 RISE=1
.meas tran i FIND i(Vs) AT=4m""",
        {"t": 1.075e-3, "i": 30 / (2 + 8 * 0.12 / 8.12)},
        1e-6,
    ),
    "a timer that charges and discharges": Deck(
        """V1 vcc 0 9
Ra vcc d 4.7k
Rb d c 10k
C1 c 0 10n
S1 d 0 c 0 S555
.model S555 SW(VT=4.5 VH=1.5 RON=1u ROFF=1e12)
.tran 0.5u 2m uic
.meas tran t TRIG v(c) VAL=4 RISE=2 TARG v(c) VAL=4 RISE=6""",
        {"t": 4 * (14.7e3 + 10e3) * 10e-9 * math.log(2)},
        1e-6,
    ),
    "a bridge that a current feeds": Deck(
        # all switches are open until their gates are read; R and C to a square wave of current
        """I1 0 p 10
S1 p a g 0 SWI
S2 a 0 h 0 SWI
S3 p b h 0 SWI
S4 b 0 g 0 SWI
Ct a b 1u
Rt a b 2
Vg g 0 PULSE(0 5 0 20n 20n 9.98u 20u)
Vh h 0 PULSE(5 0 0 20n 20n 9.98u 20u)
.tran 50n 200u 100u uic
.meas tran top MAX v(a,b)
.meas tran pin AVG v(p)""",
        {
            "top": 20 * math.tanh(10 / 4),
            # the mean of |v| from -top to top
            "pin": 20 * (1 - math.tanh(2.5) / 2.5),
        },
        5e-3,
    ),
    "six steps into a star": Deck(
        """Vp p 0 155
Vn 0 n 155
.subckt leg p n a g
S1 p a g 0 SWI
S2 a n 0 g SWJ
.model SWJ SW(VT=-2.5 VH=0.1 RON=1u ROFF=10meg)
.ends
XA p n a ga leg
XB p n b gb leg
XC p n c gc leg
RA a s 5
RB b s 5
RC c s 5
Va ga 0 PULSE(0 5 0 1n 1n {10m-1n} 20m)
Vb gb 0 PULSE(0 5 {20m/3} 1n 1n {10m-1n} 20m)
Vc gc 0 PULSE(0 5 {-20m/3} 1n 1n {10m-1n} 20m)
.tran 20u 60m 20m
.meas tran va RMS v(a,s)
.meas tran vs RMS v(s)""",
        {"va": 310 * math.sqrt(2) / 3, "vs": 310 / 6},
        1e-5,
    ),
    "a boost converter whose coil is tapped": Deck(
        """V1 in 0 12
L1 in x 20u
L2 x y 180u
K1 L1 L2 1
S1 x 0 g 0 SWI
D1 y out DI
V2 out 0 80
Vg g 0 PULSE(0 5 0 1n 1n 3.999u 10u)
.tran 50n 100u 50u uic
.meas tran is MAX i(L1)
.meas tran vs MAX v(x)
.meas tran q AVG i(V2)""",
        {
            "is": 12 / 20e-6 * 4e-6,
            "vs": 12 + 68 / 4,
            # flux of 12 V and 4 us leaves through four times the turns: a triangle
            "q": 0.5 * (2.4 / 4) * (320e-6 * 0.6 / 68) / 10e-6,
        },
        3e-3,
    ),
    "current-fed push-pull, its switches overlapping": Deck(
        """V1 in 0 24
Lf in ct 1m IC=1.9
L1 a ct 40m
L2 ct b 40m
L3 s r 360m
K1 L1 L2 L3 1
S1 a 0 g 0 SWI
S2 b 0 h 0 SWI
D1 s out DI
D2 r out DI
D3 0 s DI
D4 0 r DI
V2 out 0 96
Vg g 0 PULSE(5 0 6.249u 1n 1n 3.749u 10u)
Vh h 0 PULSE(5 0 1.249u 1n 1n 3.749u 10u)
.tran 50n 60u 20u uic
.meas tran il AVG i(Lf)
.meas tran slope PP i(Lf)
.meas tran io AVG i(V2)""",
        # 24 V = (1 - D) 2 V2/(2*3): nothing is left over a period; 2 (D - 1/2) T of it rise
        {"il": 1.9 + 24 / 1e-3 * 1.25e-6 / 2, "slope": 24 / 1e-3 * 1.25e-6},
        1e-3,
    ),
    "an output stage of class D": Deck(
        """Vp p 0 18
Vtri tri 0 PULSE(-1 1 0 {0.5/fsw} {0.5/fsw-1p} 1p {1/fsw})
.param fsw=40k
Vm m 0 0.37
B1 g 0 V = V(m) > V(tri) ? 5 : 0
B2 h 0 V = V(m) > V(tri) ? 0 : 5
S1 p a g 0 SWI
S2 a 0 h 0 SWI
S3 p b h 0 SWI
S4 b 0 g 0 SWI
Rl a b 8
.tran 0.1u 200u
.meas tran vo AVG v(a,b)
.meas tran t TRIG v(a,b) VAL=0 RISE=1 TARG v(a,b) VAL=0 RISE=5""",
        {"vo": 18 * 0.37, "t": 100e-6},
        1e-6,
    ),
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", DECKS)
def test_a_converter_comes_to_its_closed_form(tmp_path, name):
    deck = DECKS[name]
    path = tmp_path / "deck.cir"
    path.write_text(f"{name}\n{deck.rows}\n{PARTS}.end\n")
    read = hb.read_circuit(path)
    run = hb.simulate(read.model)
    assert run.status == "ok"
    assert run.audit().holds()
    found = measure(run, read.measures)
    assert {key: found[key] for key in deck.values} == pytest.approx(deck.values, rel=deck.rel)
