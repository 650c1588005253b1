# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the module by the project's own CMakeLists.txt, and says where the checkout is: scenes and the
program stay there. What is written goes into BUILD/python of the checkout, nothing beside the sources."""
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext
from setuptools.command.build_py import build_py

ROOT = Path(__file__).resolve().parents[2]
# another Python than Debian's has a build of its own: CMake remembers the one that it found
OWN = "" if Path(sys.executable).resolve() == Path("/usr/bin/python3").resolve() else "-%d.%d" % sys.version_info[:2]
BUILD = ROOT / (os.environ.get("DYNWITNESS_BUILD") or f"build{OWN}")  # of the checkout, unless it is absolute
SCRATCH = BUILD / "python" / "pip"
VERSION = re.search(r"project\(dynwitness\s+VERSION\s+([\d.]+)", (ROOT / "CMakeLists.txt").read_text()).group(1)


class Compiled(build_ext):
    def build_extension(self, extension):
        if not (BUILD / "CMakeCache.txt").exists():
            subprocess.check_call(["cmake", "-S", str(ROOT), "-B", str(BUILD), "-DCMAKE_BUILD_TYPE=Release",
                                   f"-DPython_EXECUTABLE={sys.executable}"])
        subprocess.check_call(["cmake", "--build", str(BUILD), "--target", "dynwitness_python", "-j",
                               str(os.cpu_count() or 1)])
        built = BUILD / "python" / "dynwitness" / Path(self.get_ext_filename("_core")).name
        if not built.exists():
            raise SystemExit(f"{BUILD} was configured for another Python: {built.name} is not there; "
                             "DYNWITNESS_BUILD names another folder to build in")
        to = Path(self.get_ext_fullpath(extension.name))
        to.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(built, to)


class WithCheckout(build_py):
    def run(self):
        super().run()
        folder = Path(self.build_lib) / "dynwitness"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "_checkout.py").write_text(f"ROOT = {str(ROOT)!r}\n")


SCRATCH.mkdir(parents=True, exist_ok=True)
setup(version=VERSION, ext_modules=[Extension("dynwitness._core", sources=[])],
      cmdclass={"build_ext": Compiled, "build_py": WithCheckout},
      options={"build": {"build_base": str(SCRATCH)}, "egg_info": {"egg_base": str(SCRATCH)},
               "bdist_wheel": {"bdist_dir": str(SCRATCH / "wheel")}})
