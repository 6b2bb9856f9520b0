# cmake -DWORK=FOLDER [-DLINKAGE=static] [-DOPTIONS=…] -P stand_in.cmake
#
# Runs the portfile where there is no vcpkg: the functions that it calls do here what vcpkg's own do, for a release build alone.
# What vcpkg would install is then in FOLDER/packages.
cmake_minimum_required(VERSION 3.25)
get_filename_component(WORK "${WORK}" ABSOLUTE BASE_DIR "$ENV{PWD}")
set(CURRENT_PACKAGES_DIR ${WORK}/packages)
set(VCPKG_LIBRARY_LINKAGE dynamic)
if(LINKAGE)
  set(VCPKG_LIBRARY_LINKAGE ${LINKAGE})
endif()
set(FEATURES openmp)

function(vcpkg_cmake_configure)
  cmake_parse_arguments(PARSE_ARGV 0 given "" "SOURCE_PATH" "OPTIONS")
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${given_SOURCE_PATH} -B ${WORK}/build -DCMAKE_BUILD_TYPE=Release
    -DCMAKE_INSTALL_PREFIX=${CURRENT_PACKAGES_DIR} ${given_OPTIONS} ${OPTIONS} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

function(vcpkg_cmake_install)
  execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/build --parallel 2 --target install COMMAND_ERROR_IS_FATAL ANY)
endfunction()

# Package files go to share/PORT, and count the folders up to the prefix anew.
function(vcpkg_cmake_config_fixup)
  cmake_parse_arguments(PARSE_ARGV 0 given "" "CONFIG_PATH" "")
  file(MAKE_DIRECTORY ${CURRENT_PACKAGES_DIR}/share/pbf)
  file(GLOB files ${CURRENT_PACKAGES_DIR}/${given_CONFIG_PATH}/*.cmake)
  if(NOT files)
    message(FATAL_ERROR "nothing is in ${given_CONFIG_PATH}")
  endif()
  foreach(file IN LISTS files)
    file(READ ${file} text)
    string(REPLACE "\${CMAKE_CURRENT_LIST_DIR}/../../../" "\${CMAKE_CURRENT_LIST_DIR}/../../" text "${text}")
    set(up "get_filename_component(_IMPORT_PREFIX \"\${_IMPORT_PREFIX}\" PATH)\n")
    string(REPLACE "${up}${up}${up}" "${up}${up}" text "${text}")
    get_filename_component(name ${file} NAME)
    file(WRITE ${CURRENT_PACKAGES_DIR}/share/pbf/${name} "${text}")
  endforeach()
  file(REMOVE_RECURSE ${CURRENT_PACKAGES_DIR}/${given_CONFIG_PATH})
endfunction()

function(vcpkg_fixup_pkgconfig)
  file(GLOB found ${CURRENT_PACKAGES_DIR}/lib/pkgconfig/*.pc)
  if(NOT found)
    message(FATAL_ERROR "there is no file for pkg-config")
  endif()
endfunction()

function(vcpkg_install_copyright)
  cmake_parse_arguments(PARSE_ARGV 0 given "" "" "FILE_LIST")
  file(MAKE_DIRECTORY ${CURRENT_PACKAGES_DIR}/share/pbf)
  foreach(file IN LISTS given_FILE_LIST)
    file(READ ${file} text)
    file(APPEND ${CURRENT_PACKAGES_DIR}/share/pbf/copyright "${text}\n")
  endforeach()
endfunction()

include(${CMAKE_CURRENT_LIST_DIR}/pbf/portfile.cmake)
