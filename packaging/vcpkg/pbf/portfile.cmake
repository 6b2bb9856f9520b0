# The tree that this port lies in. A registry's port would fetch a release here.
set(SOURCE_PATH "${CMAKE_CURRENT_LIST_DIR}/../../..")

set(backends "reference;serial;threads")
if("openmp" IN_LIST FEATURES)
  list(APPEND backends openmp)
endif()
if(VCPKG_LIBRARY_LINKAGE STREQUAL "static")
  set(static ON)
else()
  set(static OFF)
endif()

vcpkg_cmake_configure(SOURCE_PATH "${SOURCE_PATH}"
  OPTIONS
    "-DPBF_BACKENDS=${backends}" -DPBF_STATIC=${static}
    -DPBF_BUILD_BENCH=OFF -DPBF_BUILD_TESTS=OFF -DPBF_BUILD_EXAMPLES=OFF)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/pbf)
vcpkg_fixup_pkgconfig()
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE" "${SOURCE_PATH}/THIRD_PARTY_NOTICES.md")
