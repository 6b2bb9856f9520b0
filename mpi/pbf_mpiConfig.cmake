include(CMakeFindDependencyMacro)
find_dependency(pbf)
find_dependency(MPI COMPONENTS C)
include("${CMAKE_CURRENT_LIST_DIR}/pbf_mpiTargets.cmake")
