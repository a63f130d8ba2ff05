"""What a developer runs: `python3 dev.py studio`, `demo`, `test`, `test --all`, `site` or `bench`.

Needs Python 3.11 and nothing else: it makes a virtual environment in .venv and installs there.
"""

import hashlib
import os
import runpy
import shutil
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

ROOT = Path(__file__).resolve().parent
VENV = ROOT / ".venv"
PYTHON = VENV / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
STAMP = VENV / "hybond-installed"
# One thread for linear algebra: the matrices are small, and the tests run beside each other.
ENV = {
    **os.environ,
    "MPLBACKEND": "Agg",
    "PYTHONUTF8": "1",
    "PIP_DISABLE_PIP_VERSION_CHECK": "1",
    "OPENBLAS_NUM_THREADS": "1",
}
# The tests start many programs: what one of them has compiled, the next need not.
ENV.pop("PYTHONDONTWRITEBYTECODE", None)
PROBE = "import sys, pip; sys.exit(sys.version_info < (3, 11))"
NO_VENV = """\
Cannot make a virtual environment with {python}: neither its venv module nor virtualenv works.
Any one of these helps:  sudo apt install python3-venv    (Debian, Ubuntu)
                         python3 -m pip install --user virtualenv
                         a Python from https://www.python.org/downloads/"""


def run(*command):
    """Run one command in the repository, its output shown; return its exit code."""
    return subprocess.run([str(part) for part in command], cwd=ROOT, env=ENV).returncode


def quiet(*command, **more):
    """Run one command, its output kept, with more variables; return its exit code and output."""
    done = subprocess.run(
        [str(part) for part in command],
        cwd=ROOT,
        env={**ENV, **more},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
        errors="replace",
    )
    return done.returncode, done.stdout


def compiling():
    """Begin to compile the engine, which needs nothing installed; None if pip is to do that.

    A C compiler takes one core for as long as what makes the environment takes another: they go
    beside each other, unless pip has to fetch the compiler.
    """
    compiler = ROOT / "src" / "hybond" / "engine" / "compiled" / "compiler.py"
    if runpy.run_path(str(compiler))["wants_zig"]():
        return None
    return subprocess.Popen(
        [sys.executable, str(ROOT / "hatch_build.py")],
        cwd=ROOT,
        env=ENV,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
        errors="replace",
        process_group=0,  # with the C compiler that it starts: see end()
    )


def end(engine):
    """End what compiles the engine, and the C compiler that it has started."""
    if os.name == "nt":
        quiet("taskkill", "/F", "/T", "/PID", engine.pid)
    else:
        with suppress(ProcessLookupError, PermissionError):  # it is at its end already
            # not SIGKILL: a C compiler removes its files then
            os.killpg(engine.pid, signal.SIGTERM)
    engine.wait()


def make_venv():
    """Make .venv anew, by whichever module does; exit where none does."""
    for module in ("venv", "virtualenv"):
        quiet(sys.executable, "-m", module, "--clear", VENV)
        if PYTHON.exists() and quiet(PYTHON, "-c", PROBE)[0] == 0:
            return
    sys.exit(NO_VENV.format(python=sys.executable))


def install(wanted, **more):
    """Install what is wanted; exit with what pip says where it cannot."""
    # what is never imported is never compiled: that took pip half of its time
    code, output = quiet(PYTHON, "-m", "pip", "install", "--quiet", "--no-compile", *wanted, **more)
    if code:
        sys.exit(f"{output}\npip could not install hybond (exit code {code}).")


def make_environment(extras):
    """Make .venv and install hybond with some extras there, unless that is done already."""
    usable = PYTHON.exists() and quiet(PYTHON, "-c", PROBE)[0] == 0
    sources = [ROOT / "pyproject.toml", ROOT / "src" / "hybond" / "_version.py"]
    package = ROOT / "src" / "hybond"
    sources += [ROOT / "hatch_build.py"]
    for room in ("engine", "translate"):  # what the library is made of
        sources += sorted((package / room).rglob("*.py")) + sorted((package / room).rglob("*.c"))
    text = b"".join(path.read_bytes() for path in sources) + str(ROOT).encode()
    digest = hashlib.sha256(text).hexdigest()
    installed = STAMP.read_text().split() if usable and STAMP.exists() else []
    if installed[:1] == [digest] and extras <= {*installed}:
        return
    print("Installing hybond into .venv (the first time takes a minute or two) ...", flush=True)
    known = installed[:1] == [digest]
    if known:
        # what is compiled is there already: only extras are missing
        import tomllib  # not in the Pythons that main() refuses

        with (ROOT / "pyproject.toml").open("rb") as file:
            optional = tomllib.load(file)["project"]["optional-dependencies"]
        install([package for extra in sorted(extras) for package in optional[extra]])
    else:
        wanted = ["--editable", f"{ROOT}[{','.join(sorted(extras))}]" if extras else str(ROOT)]
        STAMP.unlink(missing_ok=True)  # compiling begins with removing the library of before
        engine = compiling()
        said = ""
        try:
            if not usable:
                make_venv()
            install(wanted, **({"HYBOND_COMPILED_BESIDE": "1"} if engine else {}))
            if engine:
                said = engine.communicate()[0]
        except BaseException:
            if engine:
                end(engine)
            raise
        print(said, end="", flush=True)
        if engine and engine.returncode:
            sys.exit(f"The engine could not be compiled (exit code {engine.returncode}).")
    there = extras | ({*installed[1:]} if known else set())
    STAMP.write_text(" ".join([digest, *sorted(there)]))


def test():
    """Check format, lint and types and run the tests; only tests where some are chosen."""
    chosen = [word for word in sys.argv[2:] if word != "--all"]
    options = chosen or ["-n", "auto", "--dist", "loadscope"]
    if "--all" in sys.argv and "-m" in chosen:
        sys.exit("--all takes the tests with any mark: leave it or -m out")
    if "--all" in sys.argv:
        options += ["-m", ""]  # also those marked slow
    if chosen:
        return run(PYTHON, "-m", "pytest", *options)
    codes = {}
    with ThreadPoolExecutor() as beside:
        # mypy takes what the tests leave: they often wait for browsers and other programs
        behind = ("nice", "-n", "10") if shutil.which("nice") else ()
        types = beside.submit(quiet, *behind, PYTHON, "-m", "mypy")
        # once, before each of those that run tests would do it for itself
        compiled = beside.submit(quiet, PYTHON, "-m", "compileall", "-q", "src", "tests")
        codes["ruff format"] = run(PYTHON, "-m", "ruff", "format", "--check")
        codes["ruff check"] = run(PYTHON, "-m", "ruff", "check")
        compiled.result()
        # where nothing fails, nobody reads what asserts compared: to have them say it takes longer
        # than a thousand tests, and those that fail are asked again
        codes["pytest"] = run(PYTHON, "-m", "pytest", "--assert=plain", *options)
        if codes["pytest"] == 1:
            again = ("--last-failed", "--last-failed-no-failures=none", "--maxfail=20")
            run(PYTHON, "-m", "pytest", "-m", "", *again, "-n", "auto", "--dist", "loadscope")
        codes["mypy"], said = types.result()
    print(said, end="")
    for name, code in codes.items():
        print(f"{name:12} {'FAILED' if code else 'ok'}", flush=True)
    return max(codes.values(), key=abs)


def main():
    if sys.version_info < (3, 11):  # noqa: UP036 - this file starts where hybond does not
        sys.exit("hybond needs Python 3.11 or newer; this is " + sys.version.split()[0])
    task = sys.argv[1] if len(sys.argv) > 1 else ""
    if task not in ("studio", "demo", "test", "site", "bench"):
        sys.exit(
            "usage: python3 dev.py studio [FILE] | demo | site | bench"
            " | test [--all] [pytest options]"
        )
    # what the continuous integration needs for several tasks is fetched while the engine compiles
    extras = {*os.environ.get("HYBOND_EXTRAS", "").split()}
    extras |= {"test": {"dev"}, "studio": {"studio"}, "site": {"site"}}.get(task, set())
    make_environment(extras)
    if task == "site":
        return run(PYTHON, ROOT / "website" / "build.py", *sys.argv[2:])
    if task == "studio":
        return run(PYTHON, "-m", "hybond", "studio", *sys.argv[2:])
    if task == "demo":
        code = run(PYTHON, "-m", "hybond", "demo", "--examples", "examples", "--out", "out")
        print("draw, run and look at them in the browser:  python3 dev.py studio")
        return code
    if task == "test":
        return test()
    codes = [run(PYTHON, path) for path in sorted(ROOT.glob("benchmarks/*.py"))]
    return max(codes, key=abs, default=0)


if __name__ == "__main__":
    sys.exit(main())
