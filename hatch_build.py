"""Compiles the engine when hybond is built; without a compiler it is built without.

As a program, which needs nothing installed, it only compiles: `dev.py` has that done beside venv
and pip. That there is no library, and a note why, is no failure of it.
"""

import importlib
import os
import platform
import sys
import sysconfig
import types
from pathlib import Path

try:
    from hatchling.builders.hooks.plugin.interface import BuildHookInterface
except ImportError:  # as a program
    BuildHookInterface = object

PACKAGE = Path(__file__).parent / "src" / "hybond"


def _imported(name):
    """Import what builds, and nothing that hybond needs when it runs: it is not installed yet."""
    packages = ("engine", "engine.compiled", "engine.expressions", "translate")
    for package in ("hybond", *(f"hybond.{p}" for p in packages)):
        module = types.ModuleType(package)
        module.__path__ = [str(PACKAGE.joinpath(*package.split(".")[1:]))]
        sys.modules[package] = module
    return importlib.import_module(f"hybond.{name}")


def compiled():
    """Compile the engine; return the file that it is in, and why there is none.

    Then the file is the one that says so, for who asks hybond later: pip shows no warnings.
    """
    build = _imported("engine.compiled.build")
    try:
        build.HOME.unlink(missing_ok=True)
        build.NOTE.unlink(missing_ok=True)
        why = build.compile_into(build.HOME)
    except Exception as error:  # whatever it is, hybond runs without
        why = f"{type(error).__name__}: {error}"
    if not why:
        return build.HOME, ""
    build.NOTE.write_text(f"{why}\n", encoding="utf-8")
    return build.NOTE, f"hybond is built without its library: {why}"


class EngineHook(BuildHookInterface):
    """Puts what was compiled into wheels, and beside its sources for an editable install."""

    def dependencies(self):
        """Ask for the zig compiler where the system has none."""
        return ["ziglang"] if _imported("engine.compiled.compiler").wants_zig() else []

    def initialize(self, version, build_data):
        """Compile, and mark the wheel as one for this platform."""
        if self.target_name != "wheel":
            return
        if version == "editable" and os.environ.get("HYBOND_COMPILED_BESIDE"):
            return
        target, why = compiled()
        build_data["artifacts"].append(target.relative_to(PACKAGE.parents[1]).as_posix())
        if why:
            self.app.display_warning(why)
            return
        build_data["pure_python"] = False
        system = sysconfig.get_platform()
        # a Python for two processors: the library is for the one that it was compiled on
        system = system.replace("universal2", platform.machine())
        build_data["tag"] = f"py3-none-{system.replace('-', '_').replace('.', '_')}"


if __name__ == "__main__":
    _, said = compiled()
    if said:
        print(said)
