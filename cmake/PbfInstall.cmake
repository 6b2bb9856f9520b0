# A tree that works wherever it is moved: every path in it is relative, and libpbf looks for its
# backends from where it finds itself. The backends install themselves (PbfBackend.cmake). Components:
# runtime, dev, tools (bench/), and for all of them doc.
include(CMakePackageConfigHelpers)

set(PBF_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/pbf)
set(PBF_BACKEND_DIR ${PBF_PLUGIN_DESTINATION})
# From the folder of pbf.pc back to the prefix.
file(RELATIVE_PATH PBF_PC_PREFIX
  ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
string(REGEX REPLACE "/$" "" PBF_PC_PREFIX "${PBF_PC_PREFIX}")
# Below the prefix, or, where they are given whole, as distributions with a folder for each package do, those.
cmake_path(APPEND PBF_PC_LIBDIR "\${prefix}" "${CMAKE_INSTALL_LIBDIR}")
cmake_path(APPEND PBF_PC_INCLUDEDIR "\${prefix}" "${CMAKE_INSTALL_INCLUDEDIR}")
# The name that the library has in a build of one configuration, which may have an ending of its own.
string(TOUPPER "${CMAKE_BUILD_TYPE}" configuration)
set(PBF_PC_NAME pbf${CMAKE_${configuration}_POSTFIX})
get_property(PBF_LINKED_BACKENDS GLOBAL PROPERTY PBF_LINKED_BACKENDS)

install(TARGETS pbf EXPORT pbfTargets
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime NAMELINK_COMPONENT dev
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/pbf DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/THIRD_PARTY_NOTICES.md
  DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT doc)
install(EXPORT pbfTargets NAMESPACE pbf:: DESTINATION ${PBF_CMAKE_DIR} COMPONENT dev)

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/pbfConfig.cmake.in
  ${PROJECT_BINARY_DIR}/pbfConfig.cmake
  INSTALL_DESTINATION ${PBF_CMAKE_DIR} PATH_VARS PBF_BACKEND_DIR CMAKE_INSTALL_INCLUDEDIR)
# Before 1.0 the API may change with the minor version.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/pbfConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/pbfConfig.cmake ${PROJECT_BINARY_DIR}/pbfConfigVersion.cmake
  DESTINATION ${PBF_CMAKE_DIR} COMPONENT dev)

get_property(PBF_PC_LIBS GLOBAL PROPERTY PBF_PC_LIBS)
configure_file(${PROJECT_SOURCE_DIR}/cmake/pbf.pc.in ${PROJECT_BINARY_DIR}/pbf.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/pbf.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
