"""The options of verbs that run a model: what is set, how it is solved, where it stops."""

from __future__ import annotations

from argparse import ArgumentParser

IMPACTS = "law of multiple impacts: newton, newton_simultaneous, poisson, lzb, lzb_hertz"


def settings_words(parser: ArgumentParser) -> None:
    """Add what changes a model before it runs."""
    parser.add_argument(
        "--set",
        dest="settings",
        metavar="PATH=VALUE",
        action="append",
        default=[],
        help="change a parameter (m=2kg), an element (ball.I=2kg) or a start (ball.f='1 m/s')",
    )


def solver_words(parser: ArgumentParser) -> None:
    """Add how a run is made, and when it ends."""
    parser.add_argument(
        "--until",
        metavar="T",
        action="append",
        help="end time, as 3 or '50 ms', or a condition, as 'v.f < 0'; "
        "several times: what is first ends the run",
    )
    names = "auto, rk45, radau, exact, rk4, euler, qss1-3, liqss1-3, moreau-jean"
    parser.add_argument("--solver", metavar="NAME", help=names)
    parser.add_argument("--rtol", metavar="R", type=float, help="relative tolerance")
    parser.add_argument("--atol", metavar="A", type=float, help="absolute tolerance, SI")
    parser.add_argument("--step", metavar="H", help="step of rk4, euler and moreau-jean")
    parser.add_argument(
        "--theta", metavar="W", type=float, help="of moreau-jean, 0.5 to 1: weight of a step's end"
    )
    parser.add_argument("--max-step", metavar="H", help="longest step")
    parser.add_argument(
        "--fmus", action="store_true", help="run the code of the FMUs that the model names"
    )
    parser.add_argument("--impact", metavar="NAME", help=IMPACTS)
    parser.add_argument(
        "--sliding",
        metavar="WAY",
        help="where both sides push into a switching surface: filippov, hysteresis, refuse",
    )
    parser.add_argument("--hysteresis", metavar="H", help="half the band of --sliding hysteresis")


def limits_words(parser: ArgumentParser) -> None:
    """Add where a run stops, and what it keeps."""
    parser.add_argument(
        "--max-events", metavar="N", type=int, help="stop there (default: 1,000,000)"
    )
    parser.add_argument(
        "--max-steps", metavar="N", type=int, help="steps between two events (default: 4,000,000)"
    )
    parser.add_argument(
        "--keep", metavar="N", type=int, help="keep the last N segments and events only"
    )
    parser.add_argument(
        "--journal", metavar="FILE", help="write events as .csv as they happen, also with --keep"
    )
