"""A Conan 2 recipe of these sources: `conan create packaging/conan` from their folder."""
import os
import re

from conan import ConanFile
from conan.tools.cmake import CMake, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load


class Pbf(ConanFile):
    name = "pbf"
    license = "MIT"
    description = "Position based fluids behind a stable C ABI"
    topics = ("fluid", "simulation", "physics")
    settings = "os", "arch", "compiler", "build_type"
    options = {"shared": [True, False], "openmp": [True, False]}
    default_options = {"shared": True, "openmp": True}
    package_type = "library"

    @property
    def _sources(self):
        return os.path.join(self.recipe_folder, "..", "..")

    def set_version(self):
        text = load(self, os.path.join(self._sources, "CMakeLists.txt"))
        self.version = re.search(r"project\(pbf VERSION ([\d.]+) ", text).group(1)

    def export_sources(self):
        for pattern in ("CMakeLists.txt", "LICENSE", "THIRD_PARTY_NOTICES.md", "cmake/*", "include/*", "lib/*",
                        "backends/*", "third_party/*"):
            copy(self, pattern, self._sources, self.export_sources_folder)

    def layout(self):
        cmake_layout(self)

    def generate(self):
        toolchain = CMakeToolchain(self)
        backends = ["reference", "serial", "threads"] + (["openmp"] if self.options.openmp else [])
        toolchain.cache_variables["PBF_BACKENDS"] = ";".join(backends)
        toolchain.cache_variables["PBF_STATIC"] = not self.options.shared
        for part in ("BENCH", "TESTS", "EXAMPLES"):
            toolchain.cache_variables[f"PBF_BUILD_{part}"] = False
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()

    def package_info(self):
        # The package has its own pbfConfig.cmake, which knows what a static library wants beside it.
        self.cpp_info.set_property("cmake_find_mode", "none")
        self.cpp_info.builddirs = [os.path.join("lib", "cmake", "pbf")]
        self.cpp_info.libs = ["pbf"]
        self.cpp_info.system_libs = ["m", "pthread"]
