# The backends in a static libpbf, and what they share. Each is linked into one object, in which
# everything but its entry is local: two backends, or a backend and the program, may have functions of
# one name. The sections stay apart, so that a program's linker can drop what it does not reach.

# pbf_linked_objects(<out>): the objects' paths; writes pbf_linked.h.
function(pbf_linked_objects out)
  get_property(names GLOBAL PROPERTY PBF_LINKED_BACKENDS)
  if(NOT names)
    message(FATAL_ERROR "PBF_STATIC is on, and no backend of PBF_BACKENDS (${PBF_BACKENDS}) can be built")
  endif()
  list(LENGTH names count)
  if(EMSCRIPTEN AND count GREATER 1)
    message(FATAL_ERROR "PBF_BACKENDS is ${PBF_BACKENDS}; for WebAssembly it must name one, "
      "for functions of one name in two can't be kept apart")
  endif()
  set(PBF_EACH_LINKED)
  foreach(name IN LISTS names)
    string(APPEND PBF_EACH_LINKED " DO(${name})")
  endforeach()
  get_property(targets GLOBAL PROPERTY PBF_LINKED_TARGETS)
  set(linked)
  foreach(target IN LISTS targets)
    pbf_link_into_one(object ${target})
    list(APPEND linked ${object})
  endforeach()
  configure_file(${PROJECT_SOURCE_DIR}/cmake/pbf_linked.h.in ${PBF_GENERATED_DIR}/pbf_linked.h @ONLY)
  set(${out} ${linked} PARENT_SCOPE)
endfunction()

function(pbf_link_into_one out target)
  set(object ${CMAKE_CURRENT_BINARY_DIR}/${target}.o)
  get_property(archives GLOBAL PROPERTY PBF_LINKED_ARCHIVES_${target})
  get_property(symbol GLOBAL PROPERTY PBF_LINKED_SYMBOL_${target})
  set(apart -Wl,--unique)
  set(keep_entry COMMAND ${CMAKE_OBJCOPY} --keep-global-symbol=${symbol} ${object})
  if(EMSCRIPTEN) # whose linker keeps sections apart, and which has no objcopy: one backend alone
    set(apart)
    set(keep_entry)
  endif()
  add_custom_command(OUTPUT ${object}
    COMMAND ${CMAKE_C_COMPILER} -r -nostdlib ${apart} -o ${object}
            -Wl,--whole-archive $<TARGET_FILE:${target}> -Wl,--no-whole-archive ${archives}
    ${keep_entry}
    DEPENDS ${target} COMMAND_EXPAND_LISTS VERBATIM)
  set_source_files_properties(${object} PROPERTIES EXTERNAL_OBJECT TRUE GENERATED TRUE)
  set(${out} ${object} PARENT_SCOPE)
endfunction()

# What a program must link beside libpbf.a.
function(pbf_link_for_linked_backends target)
  get_property(names GLOBAL PROPERTY PBF_LINKED_BACKENDS)
  set(PBF_PC_LIBS -lm -pthread)
  if(openmp IN_LIST names)
    find_package(OpenMP REQUIRED COMPONENTS C)
    target_link_libraries(${target} PRIVATE OpenMP::OpenMP_C)
    list(TRANSFORM OpenMP_C_LIB_NAMES PREPEND -l OUTPUT_VARIABLE omp)
    list(APPEND PBF_PC_LIBS ${omp})
  endif()
  if(cuda IN_LIST names)
    target_link_libraries(${target} PRIVATE ${CMAKE_DL_LIBS} rt stdc++)
    list(APPEND PBF_PC_LIBS -ldl -lrt -lstdc++)
  endif()
  list(JOIN PBF_PC_LIBS " " libs)
  set_property(GLOBAL PROPERTY PBF_PC_LIBS ${libs})
endfunction()
