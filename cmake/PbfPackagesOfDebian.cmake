# Read by cpack for each generator: what only packages of Debian have.
if(NOT CPACK_GENERATOR STREQUAL DEB)
  return()
endif()
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_SET_DESTDIR OFF)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CPACK_PBF_LIBRARY_DIR})
set(CPACK_COMPONENTS_ALL runtime dev debian_runtime debian_dev)
if(CPACK_PBF_HAS_TOOLS)
  list(APPEND CPACK_COMPONENTS_ALL tools debian_tools)
endif()
# A package is a group: a component of the library's, and what Debian asks for.
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
foreach(package runtime dev tools)
  string(TOUPPER ${package} upper)
  set(CPACK_COMPONENT_${upper}_GROUP ${package})
  set(CPACK_COMPONENT_DEBIAN_${upper}_GROUP ${package})
endforeach()

set(same_version "= ${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}")
set(library libpbf${CPACK_PBF_SOVERSION})

set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME ${library})
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_RUNTIME_DESCRIPTION "A solver for incompressible fluids of particles in two and three dimensions,
with the same results in every run. This package has the library and its
backends, which it loads when it runs.")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME libpbf-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "${library} (${same_version})")
set(CPACK_DEBIAN_DEV_DESCRIPTION "A solver for incompressible fluids of particles in two and three dimensions,
with the same results in every run. This package has the headers for C and
C++, and what CMake and pkg-config find the library by.")

set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME pbf-tools)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SECTION science)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_TOOLS_PACKAGE_DEPENDS "${library} (${same_version}), python3:any")
set(CPACK_DEBIAN_TOOLS_PACKAGE_RECOMMENDS "python3-numpy, python3-scipy, python3-matplotlib")
set(CPACK_DEBIAN_TOOLS_DESCRIPTION "Runs scenes of particle fluids from files, writes frames and pictures, and
measures speed and error. This package has pbf-bench, its scenes, the checker
that judges the particles of a run, and pbf-bake, which makes solids of meshes.")
