set(pbf_build_id "PBF_BUILD_ID=\"${PROJECT_VERSION}, ${CMAKE_C_COMPILER_ID} ${CMAKE_C_COMPILER_VERSION}, ${CMAKE_SYSTEM_PROCESSOR}, $<CONFIG>\"")

# pbf_add_backend(<name> <source>...)
# A backend is a module with hidden visibility and one exported symbol, where libpbf looks for it;
# with PBF_STATIC it is what lib/ links in.
function(pbf_add_backend name)
  set(target pbf_backend_${name})
  if(PBF_STATIC)
    pbf_add_linked_backend(${name} ${ARGN})
  else()
    pbf_add_plugin(${target} ${ARGN})
  endif()
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/backends)
  target_compile_definitions(${target} PRIVATE PBF_BACKEND_NAME="${name}" ${pbf_build_id})
  target_link_libraries(${target} PRIVATE pbf_compile m)
  pbf_link_as_c(${target})
endfunction()

# pbf_add_part(<target> <source>...)
# What several plugins share: a file beside them, which libpbf loads for them; with PBF_STATIC it is
# linked in, and of its names <target>_part alone is global.
function(pbf_add_part target)
  if(PBF_STATIC)
    pbf_add_linked_objects(${target} ${target}_part ${ARGN})
  else()
    pbf_add_plugin(${target} ${ARGN})
    set_property(GLOBAL APPEND PROPERTY PBF_PARTS ${target})
  endif()
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/backends)
  target_link_libraries(${target} PRIVATE pbf_compile m)
  pbf_link_as_c(${target})
endfunction()

# Without the libraries that CMake holds C++ objects to need.
macro(pbf_link_as_c target)
  set(CMAKE_CXX_IMPLICIT_LINK_LIBRARIES "" PARENT_SCOPE)
  set_target_properties(${target} PROPERTIES LINKER_LANGUAGE C)
endmacro()

function(pbf_add_plugin target)
  add_library(${target} MODULE ${ARGN})
  pbf_carry_runtime(${target})
  pbf_link_options(${target} ${PBF_NO_UNDEFINED} -Wl,--exclude-libs,ALL)
  set_target_properties(${target} PROPERTIES
    PREFIX "" OUTPUT_NAME ${target} SUFFIX ${PBF_PLUGIN_SUFFIX}
    LIBRARY_OUTPUT_DIRECTORY ${PBF_PLUGIN_DIR})
  foreach(configuration IN LISTS CMAKE_CONFIGURATION_TYPES CMAKE_BUILD_TYPE) # libpbf looks for one name in all of them
    string(TOUPPER ${configuration} configuration)
    set_target_properties(${target} PROPERTIES ${configuration}_POSTFIX "")
  endforeach()
  set_property(GLOBAL APPEND PROPERTY PBF_PLUGINS ${target})
  if(PBF_INSTALL)
    install(TARGETS ${target} LIBRARY DESTINATION ${PBF_PLUGIN_DESTINATION} COMPONENT runtime)
  endif()
endfunction()

function(pbf_add_linked_backend name)
  set(entry pbf_backend_negotiate_${name})
  pbf_add_linked_objects(pbf_backend_${name} ${entry} ${ARGN})
  target_compile_definitions(pbf_backend_${name} PRIVATE PBF_LINKED_ENTRY=${entry})
  set_property(GLOBAL APPEND PROPERTY PBF_LINKED_BACKENDS ${name})
endfunction()

# An archive of objects, of which lib/ makes one object with one global symbol.
function(pbf_add_linked_objects target symbol)
  add_library(${target} STATIC ${ARGN})
  target_compile_definitions(${target} PRIVATE PBF_LINKED)
  set_property(GLOBAL APPEND PROPERTY PBF_LINKED_TARGETS ${target})
  set_property(GLOBAL PROPERTY PBF_LINKED_SYMBOL_${target} ${symbol})
endfunction()

# pbf_variant_target(<out> <backend> <variant>): the target's name.
function(pbf_variant_target out name variant)
  string(REPLACE - _ variant ${variant})
  set(${out} pbf_${name}_${variant} PARENT_SCOPE)
endfunction()

# pbf_add_variant(<out> <backend> <variant> <source>...)
# The sources compiled for one of PBF_VARIANTS; its table is the symbol <backend>_<dimension>d_f<bits>.
# <out> gets the objects, to be listed among a backend's sources.
function(pbf_add_variant out name variant)
  pbf_variant_target(target ${name} ${variant})
  string(REGEX MATCH "^(.)d-f(..)$" _ ${variant})
  set(dim ${CMAKE_MATCH_1})
  set(bits ${CMAKE_MATCH_2})
  set(real float)
  if(bits EQUAL 64)
    set(real double)
  endif()
  add_library(${target} OBJECT ${ARGN})
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/backends)
  target_compile_definitions(${target} PRIVATE
    PBF_DIM=${dim} PBF_BITS=${bits} PBF_REAL=${real} PBF_VARIANT_API=${name}_${dim}d_f${bits})
  target_link_libraries(${target} PRIVATE pbf_compile)
  target_compile_options(${target} PRIVATE "$<$<COMPILE_LANGUAGE:CXX>:${pbf_backend_warnings}>")
  target_compile_options(${target} PRIVATE
    "$<$<AND:$<COMPILE_LANGUAGE:CXX>,$<NOT:$<CONFIG:MinSizeRel>>>:${pbf_backend_copies}>")
  set_property(GLOBAL APPEND PROPERTY PBF_VARIANT_OBJECTS $<TARGET_OBJECTS:${target}>)
  set(${out} $<TARGET_OBJECTS:${target}> PARENT_SCOPE)
endfunction()
