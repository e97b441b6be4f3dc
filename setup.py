# SPDX-License-Identifier: MIT
"""The part of pyproject.toml that runs CMake."""

import os
import re
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = os.path.dirname(os.path.abspath(__file__))
with open(os.path.join(ROOT, "CMakeLists.txt"), encoding="utf-8") as cmake:
    VERSION = re.search(r"project\(gnomon VERSION ([0-9.]+)", cmake.read())[1]


class BuildWithCMake(build_ext):
    """Builds the package with its stub. A folder that CMake has configured before keeps its options."""

    def run(self):
        if not os.path.exists(os.path.join(self.build_temp, "CMakeCache.txt")):
            subprocess.run(["cmake", "-S", ROOT, "-B", self.build_temp, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DGNOMON_TESTS=OFF",
                            "-DGNOMON_PYTHON=ON", f"-DPython_EXECUTABLE={sys.executable}"], check=True)
        subprocess.run(["cmake", "--build", self.build_temp, "--target", "gnomon_python"], check=True)
        self.copy_tree(os.path.join(self.build_temp, "source", "python", "gnomon"), os.path.join(self.build_lib, "gnomon"))


setup(version=VERSION, packages=[], ext_modules=[Extension("gnomon._gnomon", [])], cmdclass={"build_ext": BuildWithCMake})
