# Finds deal.II, and says in one sentence each what it lacks and where one comes from.
set(dealii_sources "Debian 12 and 13 and Ubuntu 24.04 have a suitable one (apt-get install libdeal.ii-dev), \
and so has Spack (spack install dealii)")

# Where one is named, no other one takes its place.
set(dealii_search)
if(DEAL_II_DIR OR DEFINED ENV{DEAL_II_DIR})
  set(dealii_search HINTS ${DEAL_II_DIR} $ENV{DEAL_II_DIR} NO_DEFAULT_PATH)
endif()
find_package(deal.II 9.4 QUIET ${dealii_search})
if(NOT deal.II_FOUND)
  if(deal.II_CONSIDERED_VERSIONS)
    message(FATAL_ERROR "Tombolo needs deal.II 9.4 or newer, and found ${deal.II_CONSIDERED_VERSIONS} "
      "(${deal.II_CONSIDERED_CONFIGS}). ${dealii_sources}; -DDEAL_II_DIR=DIRECTORY names the place of another one.")
  endif()
  message(FATAL_ERROR "Tombolo needs deal.II 9.4 or newer, and found none. ${dealii_sources}; "
    "-DDEAL_II_DIR=DIRECTORY names its place where it is not found.")
endif()

set(missing_features)
foreach(feature MPI P4EST TRILINOS HDF5 MUPARSER)
  if(NOT DEAL_II_WITH_${feature})
    list(APPEND missing_features ${feature})
  endif()
endforeach()
if(missing_features)
  list(JOIN missing_features ", " names)
  list(JOIN missing_features "=ON -DDEAL_II_WITH_" options)
  message(FATAL_ERROR "deal.II ${DEAL_II_VERSION} in ${DEAL_II_PATH} was configured without ${names}, which Tombolo needs. "
    "${dealii_sources}; a build of your own needs -DDEAL_II_WITH_${options}=ON.")
endif()
# Since deal.II 9.8 Trilinos may come without Epetra. The multigrid of static steps needs ML, which works on it.
if(DEAL_II_VERSION VERSION_GREATER_EQUAL 9.8 AND NOT DEAL_II_TRILINOS_WITH_EPETRA)
  message(FATAL_ERROR "deal.II ${DEAL_II_VERSION} in ${DEAL_II_PATH} uses a Trilinos without Epetra, which Tombolo needs. "
    "${dealii_sources}; a build of your own needs Trilinos 16 or older with Epetra and ML.")
endif()
