# SPDX-License-Identifier: LGPL-2.1-or-later
from spack.package import *


class Tombolo(CMakePackage):
    """Explicit finite elements coupled with a Lagrangian particle method across shared nodes, for thermo-mechanical
    problems with large deformation, contact and failure."""

    # In a clone: spack repo add cmake/packaging/spack && spack dev-build tombolo@main
    version("main")

    variant("tests", default=False, description="Tests and benchmarks")

    depends_on("cxx", type="build")
    depends_on("c", type="build")
    depends_on("cmake@3.18:", type="build")
    depends_on("ninja", type="build")
    depends_on("dealii@9.4: +mpi+p4est+trilinos+hdf5+muparser")
    depends_on("eigen@3")
    depends_on("nlohmann-json@3.9:")
    depends_on("googletest", when="+tests")
    depends_on("benchmark", when="+tests")
    depends_on("py-numpy", type="run")
    depends_on("py-matplotlib", type="run")
    depends_on("py-h5py", type="run")

    generator("ninja")

    def cmake_args(self):
        return [
            self.define_from_variant("TOMBOLO_TESTS", "tests"),
            # Spack itself says for which processor the compiler works.
            self.define("TOMBOLO_ARCHITECTURE", ""),
            self.define("TOMBOLO_CCACHE", False),
        ]
