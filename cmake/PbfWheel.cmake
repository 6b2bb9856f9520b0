# What a wheel's build has from its own requirements (pyproject.toml) where the machine has it not:
# DLPack's header.
if(PBF_DLPACK_INCLUDE_DIR AND NOT EXISTS ${PBF_DLPACK_INCLUDE_DIR}/dlpack/dlpack.h)
  unset(PBF_DLPACK_INCLUDE_DIR CACHE) # pip's environment of an earlier build, which is gone
endif()
find_path(PBF_DLPACK_INCLUDE_DIR dlpack/dlpack.h)
if(NOT PBF_DLPACK_INCLUDE_DIR)
  find_package(Python3 REQUIRED COMPONENTS Interpreter)
  execute_process(
    COMMAND ${Python3_EXECUTABLE} -c
      "import importlib.util as u, os; print(os.path.dirname(u.find_spec('tvm_ffi').origin))"
    OUTPUT_VARIABLE folder OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  find_path(PBF_DLPACK_INCLUDE_DIR dlpack/dlpack.h
    PATHS ${folder}/include ${folder}/3rdparty/dlpack/include NO_DEFAULT_PATH)
endif()
if(NOT PBF_DLPACK_INCLUDE_DIR)
  message(FATAL_ERROR "dlpack/dlpack.h is missing: install libdlpack-dev, or what this system calls it")
endif()
