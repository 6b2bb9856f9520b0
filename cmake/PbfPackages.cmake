# Packages by CPack: a tarball of everything, and three for Debian: libpbf0.2 (the library with its
# backends), libpbf-dev and pbf-tools, of a build for /usr, as the preset `bindings` is.
set(PBF_PACKAGE_CONTACT "the pbf authors <authors@pbf.invalid>" CACHE STRING
  "Name and address of the packages' maintainer")
set(debian ${PROJECT_SOURCE_DIR}/packaging/debian)
set(generated ${PROJECT_BINARY_DIR}/packages)

# The time that the packages say: that of SOURCE_DATE_EPOCH, which string(TIMESTAMP) obeys.
string(TIMESTAMP PBF_PACKAGE_DATE "%a, %d %b %Y %H:%M:%S +0000" UTC)
configure_file(${debian}/changelog.in ${generated}/changelog @ONLY)
configure_file(${debian}/copyright ${generated}/copyright COPYONLY)

# What Debian asks of each package's folder of documents; in no other package.
find_program(PBF_GZIP gzip)
if(PBF_GZIP)
  foreach(file ${generated}/changelog ${debian}/pbf-bench.1)
    cmake_path(GET file FILENAME name)
    execute_process(COMMAND ${PBF_GZIP} -9nc ${file} OUTPUT_FILE ${generated}/${name}.gz COMMAND_ERROR_IS_FATAL ANY)
  endforeach()
  set(debian_runtime libpbf${PBF_SOVERSION})
  set(debian_dev libpbf-dev)
  set(debian_tools pbf-tools)
  foreach(component runtime dev tools)
    set(folder ${CMAKE_INSTALL_DATADIR}/doc/${debian_${component}})
    install(FILES ${generated}/copyright DESTINATION ${folder} COMPONENT debian_${component} EXCLUDE_FROM_ALL)
    install(FILES ${generated}/changelog.gz DESTINATION ${folder} RENAME changelog.Debian.gz
      COMPONENT debian_${component} EXCLUDE_FROM_ALL)
    set(debian_package ${debian_${component}})
    file(READ ${debian}/lintian-overrides.in overrides)
    if(component STREQUAL runtime)
      file(READ ${debian}/libpbf.lintian-overrides.in scripts)
      string(APPEND overrides "${scripts}")
    endif()
    file(CONFIGURE OUTPUT ${generated}/${debian_package} CONTENT "${overrides}" @ONLY)
    install(FILES ${generated}/${debian_package} DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides
      COMPONENT debian_${component} EXCLUDE_FROM_ALL)
  endforeach()
  install(FILES ${generated}/pbf-bench.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1
    COMPONENT debian_tools EXCLUDE_FROM_ALL)
endif()

set(CPACK_GENERATOR TGZ)
set(CPACK_PACKAGE_NAME pbf)
set(CPACK_PACKAGE_VENDOR "the pbf authors")
set(CPACK_PACKAGE_CONTACT "${PBF_PACKAGE_CONTACT}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "position based fluids behind a stable C ABI")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGE_FILE_NAME pbf-${PROJECT_VERSION}-linux-${CMAKE_SYSTEM_PROCESSOR})
set(CPACK_PACKAGE_CHECKSUM SHA256)
set(CPACK_STRIP_FILES ON)
set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_SOURCE_DIR}/cmake/PbfPackagesOfDebian.cmake)
# What dpkg-shlibdeps finds of the library in programs that are packaged with it.
file(WRITE ${generated}/shlibs "libpbf ${PBF_SOVERSION} libpbf${PBF_SOVERSION} (>= ${PROJECT_VERSION})\n")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA ${generated}/shlibs ${debian}/triggers)
set(CPACK_PBF_SOVERSION ${PBF_SOVERSION})
set(CPACK_PBF_LIBRARY_DIR ${PROJECT_BINARY_DIR}/lib)
set(CPACK_PBF_HAS_TOOLS ${PBF_BUILD_BENCH})
set(CPACK_VERBATIM_VARIABLES ON)
include(CPack)
