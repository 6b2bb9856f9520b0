# The version is set in project(); pbf.h, which programs are compiled with where there is no CMake,
# repeats it and must agree.
block()
  set(header ${PROJECT_SOURCE_DIR}/include/pbf/pbf.h)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${header})
  set(version)
  foreach(part MAJOR MINOR PATCH)
    file(STRINGS ${header} line REGEX "^#define PBF_VERSION_${part} [0-9]+$")
    string(REGEX REPLACE "^.* " "" number "${line}")
    list(APPEND version "${number}")
  endforeach()
  list(JOIN version "." version)
  if(NOT version STREQUAL PROJECT_VERSION)
    message(FATAL_ERROR "PBF_VERSION_… of include/pbf/pbf.h say \"${version}\"; "
      "project() in CMakeLists.txt says \"${PROJECT_VERSION}\"")
  endif()
endblock()
