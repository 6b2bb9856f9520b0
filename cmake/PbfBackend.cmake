# pbf_add_backend(<name> <source>...)
# A backend is a module with hidden visibility and one exported symbol, where libpbf looks for it.
function(pbf_add_backend name)
  set(target pbf_backend_${name})
  add_library(${target} MODULE ${ARGN})
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/backends)
  target_compile_definitions(${target} PRIVATE PBF_BACKEND_NAME="${name}"
    PBF_BUILD_ID="${PROJECT_VERSION}, ${CMAKE_C_COMPILER_ID} ${CMAKE_C_COMPILER_VERSION}, ${CMAKE_SYSTEM_PROCESSOR}, ${CMAKE_BUILD_TYPE}")
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

# pbf_add_variant(<out> <backend> <dimension> <bits> <source>...)
# The sources compiled for one dimension and one real type; the variant's table is the symbol
# <backend>_<dimension>d_f<bits>. <out> gets the objects, to be listed among a backend's sources.
function(pbf_add_variant out name dim bits)
  set(target pbf_${name}_${dim}d_f${bits})
  set(real float)
  if(bits EQUAL 64)
    set(real double)
  endif()
  add_library(${target} OBJECT ${ARGN})
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/backends)
  target_compile_definitions(${target} PRIVATE PBF_DIM=${dim} PBF_REAL=${real} PBF_VARIANT_API=${name}_${dim}d_f${bits})
  target_link_libraries(${target} PRIVATE pbf_compile)
  set(${out} $<TARGET_OBJECTS:${target}> PARENT_SCOPE)
endfunction()
