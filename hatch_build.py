"""Compiles the kernel when hybond is built; without a compiler hybond is built without it."""

import importlib.util
import sysconfig
from pathlib import Path

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

ROOM = Path(__file__).parent / "src" / "hybond" / "kernel"


def _build():
    spec = importlib.util.spec_from_file_location("hybond_kernel_build", ROOM / "build.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class KernelHook(BuildHookInterface):
    """Puts the compiled kernel into wheels, and beside its sources for an editable install."""

    def dependencies(self):
        """Ask for the zig compiler where the system has none."""
        return ["ziglang"] if _build().wants_zig() else []

    def initialize(self, version, build_data):
        """Compile, and mark the wheel as one for this platform."""
        if self.target_name != "wheel":
            return
        build = _build()
        target = ROOM / build.NAME
        target.unlink(missing_ok=True)
        why = build.compile_kernel(target)
        if why:
            self.app.display_warning(f"hybond is built without its kernel: {why}")
            return
        build_data["artifacts"].append(f"src/hybond/kernel/{build.NAME}")
        build_data["pure_python"] = False
        platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
        build_data["tag"] = f"py3-none-{platform}"
