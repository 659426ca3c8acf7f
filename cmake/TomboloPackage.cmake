# cpack: a package for Debian of what is installed. Its dependencies are computed from the libraries
# that programs and library load.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME tombolo)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_VENDOR "The authors of Tombolo")
set(CPACK_PACKAGE_CONTACT "The authors of Tombolo <authors@tombolo.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY
  "explicit finite elements coupled with a Lagrangian particle method")
set(CPACK_PACKAGE_DESCRIPTION
"Tombolo couples explicit hexahedral finite elements with momentum-consistent meshfree particles across
shared nodes, for thermo-mechanical problems with large deformation, contact and failure. It runs on any
number of MPI ranks from one parameter file.")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# The programs load the library from the package itself.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS
  "openmpi-bin, python3, python3-numpy, python3-scipy, python3-matplotlib, python3-vtk9, python3-h5py")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "libdeal.ii-dev, nlohmann-json3-dev, cmake, g++, paraview")
include(CPack)
