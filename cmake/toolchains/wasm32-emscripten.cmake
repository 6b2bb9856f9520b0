# WebAssembly, by Emscripten; programs run under node. One static module: there is nothing to load.
set(EMSCRIPTEN_SYSTEM_PROCESSOR wasm32)
find_program(emcc emcc REQUIRED)
file(REAL_PATH ${emcc} emcc)
cmake_path(GET emcc PARENT_PATH root)
include(${root}/cmake/Modules/Platform/Emscripten.cmake)
find_program(node node REQUIRED)
set(CMAKE_CROSSCOMPILING_EMULATOR ${node})
set(PBF_STATIC ON CACHE BOOL "Nothing to load")
