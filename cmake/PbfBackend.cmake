# pbf_add_backend(<name> <source>...)
# A backend is a module with hidden visibility and one exported symbol, where libpbf looks for it.
function(pbf_add_backend name)
  set(target pbf_backend_${name})
  add_library(${target} MODULE ${ARGN})
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/backends)
  target_compile_definitions(${target} PRIVATE PBF_BACKEND_NAME="${name}" PBF_BUILD_VERSION="${PROJECT_VERSION}")
  target_link_libraries(${target} PRIVATE pbf_compile m)
  target_link_options(${target} PRIVATE -Wl,--no-undefined -Wl,--exclude-libs,ALL)
  if(PBF_SANITIZE_ADDRESS OR PBF_SANITIZE_THREAD)
    # clang leaves the sanitizer's runtime to the program.
    if(CMAKE_C_COMPILER_ID MATCHES Clang)
      target_link_options(${target} PRIVATE -Wl,-z,undefs)
    endif()
  endif()
  set_target_properties(${target} PROPERTIES
    PREFIX "" OUTPUT_NAME ${target}
    LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib/pbf/backends)
  install(TARGETS ${target} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/pbf/backends)
endfunction()
