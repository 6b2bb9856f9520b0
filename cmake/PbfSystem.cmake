# What of the build differs between systems.
if(WIN32)
  set(PBF_SYSTEM windows)
  set(PBF_PLUGIN_SUFFIX .dll)
  set(PBF_PLUGIN_FOLDER bin) # beside libpbf, which looks for them from where it is
  set(PBF_PLUGIN_DESTINATION ${CMAKE_INSTALL_BINDIR}/pbf/backends)
  set(PBF_IMAGE_SOURCES plugin/image_pe.c)
else()
  set(PBF_SYSTEM posix)
  set(PBF_PLUGIN_SUFFIX .so)
  set(PBF_PLUGIN_FOLDER lib)
  set(PBF_PLUGIN_DESTINATION ${CMAKE_INSTALL_LIBDIR}/pbf/backends)
  set(PBF_IMAGE_SOURCES plugin/image.c plugin/image_file.c plugin/image_tables.c)
  if(APPLE)
    set(PBF_PLUGIN_SUFFIX .dylib)
    set(PBF_IMAGE_SOURCES plugin/image_unchecked.c)
  elseif(EMSCRIPTEN AND threads IN_LIST PBF_BACKENDS)
    set(PBF_SYSTEM wasm)
    set(PBF_WASM_THREADS ON)
    add_compile_options(-pthread) # all objects of a module share its memory, or none
  endif()
endif()
# Where a build puts plugins: beside libpbf, which generators of several configurations put into a folder for each.
set(PBF_PLUGIN_DIR ${PROJECT_BINARY_DIR}/${PBF_PLUGIN_FOLDER})
get_property(several GLOBAL PROPERTY GENERATOR_IS_MULTI_CONFIG)
if(several)
  string(APPEND PBF_PLUGIN_DIR /$<CONFIG>)
endif()
string(APPEND PBF_PLUGIN_DIR /pbf/backends)
# Of libpbf, and of plugins that start threads or ask for the time.
set(PBF_SYSTEM_SOURCES ${PROJECT_SOURCE_DIR}/backends/common/system_${PBF_SYSTEM}.c)
if(NOT WIN32)
  list(APPEND PBF_SYSTEM_SOURCES ${PROJECT_SOURCE_DIR}/backends/common/waits.c)
endif()

include(CheckLinkerFlag)

# pbf_link_options(<target> <flag>...): those of the flags that the linker knows.
function(pbf_link_options target)
  foreach(flag IN LISTS ARGN)
    string(MAKE_C_IDENTIFIER "PBF_LINKER_HAS${flag}" known)
    check_linker_flag(C "${flag}" ${known})
    if(${known})
      target_link_options(${target} PRIVATE "${flag}")
    endif()
  endforeach()
endfunction()

# pbf_carry_runtime(<target>): of mingw-w64's libraries nothing is left beside it.
function(pbf_carry_runtime target)
  if(MINGW)
    target_link_options(${target} PRIVATE -static)
  endif()
endfunction()
