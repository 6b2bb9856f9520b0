# 64-bit macOS on Apple's processors, by Zig, which has the system's headers: compiled and linked, and
# not run. PBF_ZIG in the environment is the program; `pip install ziglang` has one.
set(CMAKE_SYSTEM_NAME Darwin)
set(CMAKE_SYSTEM_PROCESSOR arm64)
file(GLOB zig $ENV{PBF_ZIG} ${CMAKE_CURRENT_LIST_DIR}/../../build/zig/lib/python3*/site-packages/ziglang/zig)
list(GET zig 0 zig)
set(folder ${CMAKE_BINARY_DIR}/zig)
foreach(tool cc c++ ar ranlib) # CMake wants a program for each
  set(target)
  if(tool MATCHES "^c")
    set(target "-target aarch64-macos")
  endif()
  # Zig makes no bundles, which CMake links modules as; a dynamic library is loaded alike.
  file(WRITE ${folder}/${tool} "#!/bin/sh\n"
    "for word; do shift; [ \"$word\" != -bundle ] || word=-dynamiclib; set -- \"$@\" \"$word\"; done\n"
    "exec '${zig}' ${tool} ${target} \"$@\"\n")
  file(CHMOD ${folder}/${tool} PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)
endforeach()
set(CMAKE_C_COMPILER ${folder}/cc)
set(CMAKE_CXX_COMPILER ${folder}/c++)
set(CMAKE_AR ${folder}/ar)
set(CMAKE_RANLIB ${folder}/ranlib)
set(CMAKE_INSTALL_NAME_TOOL ${CMAKE_COMMAND})
set(CMAKE_OSX_SYSROOT "")
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH ${folder})
