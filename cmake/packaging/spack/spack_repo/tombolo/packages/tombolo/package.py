# SPDX-License-Identifier: LGPL-2.1-or-later
from spack_repo.builtin.build_systems.cmake import CMakePackage, generator

from spack.package import *


class Tombolo(CMakePackage):
    """Explicit finite elements coupled with a Lagrangian particle method across shared nodes, for thermo-mechanical
    problems with large deformation, contact and failure."""

    # In a clone, with Spack 1.0 or newer:
    # spack repo add cmake/packaging/spack/spack_repo/tombolo && spack dev-build tombolo@main
    license("LGPL-2.1-or-later")
    version("main")

    variant("tests", default=False, description="Tests and benchmarks")
    variant("plots", default=True, description="What tombolo-plot, tombolo-report and tombolo-reflection-study need")

    depends_on("c", type="build")
    depends_on("cxx", type="build")
    depends_on("cmake@3.18:", type="build")
    depends_on("git", type="build")  # the program reports the commit
    depends_on("mpi")
    depends_on("dealii@9.4:+mpi+p4est+trilinos+hdf5+muparser")
    depends_on("eigen@3.3:3", type="build")
    # Headers of processes and outputs name its types.
    depends_on("nlohmann-json@3.9:", type=("build", "link"))
    # It makes the manual page, and runs the commands of an installation.
    depends_on("python@3.9:", type=("build", "run"))
    depends_on("googletest", type=("build", "link"), when="+tests")
    depends_on("benchmark", type=("build", "link"), when="+tests")
    with when("+plots"):
        depends_on("py-numpy", type="run")
        depends_on("py-scipy", type="run")
        depends_on("py-matplotlib", type="run")
        depends_on("py-h5py", type="run")
        depends_on("vtk@9:+python", type="run")

    generator("ninja")

    def cmake_args(self):
        return [
            self.define_from_variant("TOMBOLO_TESTS", "tests"),
            # Spack itself says for which processor the compiler works.
            self.define("TOMBOLO_ARCHITECTURE", ""),
            self.define("TOMBOLO_CCACHE", False),
        ]
