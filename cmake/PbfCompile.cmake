# One interface target with the compile rules that every target of the project follows.
add_library(pbf_compile INTERFACE)
target_include_directories(pbf_compile INTERFACE ${PBF_GENERATED_DIR})
set(CMAKE_C_STANDARD 17)
set(CMAKE_C_STANDARD_REQUIRED ON)
set(CMAKE_C_EXTENSIONS ON)
set(CMAKE_C_VISIBILITY_PRESET hidden)
set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS ON)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
if(NOT EMSCRIPTEN) # whose static module lies where it is linked
  set(CMAKE_POSITION_INDEPENDENT_CODE ON)
endif()
# Where a project that has pbf as a part, or a builder's flags, ask for what it can't bear: several files define functions of the
# same name, and libm is no target. Under -ffast-math bits differ and NaNs pass for numbers; linked with it by GCC before 13, a
# library flushes subnormal numbers in all programs that load it. Contraction is off first of all: clang warns where -fno-fast-math
# is what ends it, and a project's -Werror makes that an error.
set(CMAKE_UNITY_BUILD OFF)
set(CMAKE_LINK_LIBRARIES_ONLY_TARGETS OFF)
add_compile_options(
  "$<$<COMPILE_LANGUAGE:C,CXX>:SHELL:-ffp-contract=off -fno-fast-math>"
  "$<$<COMPILE_LANGUAGE:C,CXX>:-fno-finite-math-only;-fno-associative-math;-fno-reciprocal-math;-fsigned-zeros>")
add_link_options("$<$<LINK_LANGUAGE:C,CXX>:-fno-fast-math;-fno-unsafe-math-optimizations>")
foreach(language C CXX)
  set(CMAKE_${language}_FLAGS_RELEASE "-O3")
  set(CMAKE_${language}_FLAGS_MINSIZEREL "-Os -fno-asynchronous-unwind-tables")
endforeach()
# The same bytes wherever it is built: debug information names no folder. Elsewhere none is named.
if(NOT PBF_SANITIZE_ADDRESS AND NOT PBF_SANITIZE_THREAD)
  add_compile_options("$<$<AND:$<COMPILE_LANGUAGE:C,CXX>,$<CONFIG:RelWithDebInfo>>:-ffile-prefix-map=${PROJECT_SOURCE_DIR}=.>")
endif()
if(PBF_STATIC)
  # A program's linker can drop the functions that it does not reach.
  add_compile_options("$<$<COMPILE_LANGUAGE:C,CXX>:-ffunction-sections;-fdata-sections>")
endif()

# No contraction: what must be bit-equal is; a fused multiply-add stands where it is written.
target_compile_options(pbf_compile INTERFACE
  $<$<COMPILE_LANGUAGE:C>:-Wall -Wextra -Wpedantic -Wshadow -Wstrict-prototypes -Wmissing-prototypes
    -Wpointer-arith -Wvla -ffp-contract=off -fno-math-errno -fno-trapping-math>
  $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wno-missing-field-initializers -Wshadow
    -ffp-contract=off -fno-math-errno -fno-trapping-math>) # what a C++ initialiser leaves out is 0
if(MINGW) # the formats of C99, and a point in them
  target_compile_definitions(pbf_compile INTERFACE __USE_MINGW_ANSI_STDIO=1)
endif()
if(PBF_WERROR)
  target_compile_options(pbf_compile INTERFACE
    $<$<COMPILE_LANGUAGE:C,CXX>:-Werror> $<$<COMPILE_LANGUAGE:CUDA>:-Werror=all-warnings>)
endif()
if(PBF_SANITIZE_ADDRESS)
  add_compile_options($<$<COMPILE_LANGUAGE:C,CXX>:-fsanitize=address,undefined>
    $<$<COMPILE_LANGUAGE:C,CXX>:-fno-sanitize-recover=all> $<$<COMPILE_LANGUAGE:C,CXX>:-fno-omit-frame-pointer>
    # What is at null, or beyond an object, ASan finds; to look twice is two fifths of compiling.
    $<$<COMPILE_LANGUAGE:C,CXX>:-fno-sanitize=null,object-size>)
  if(CMAKE_C_COMPILER_ID MATCHES Clang)
    # clang alone holds null + 0 to be an overflow; what lies out of bounds ASan finds.
    add_compile_options($<$<COMPILE_LANGUAGE:C,CXX>:-fno-sanitize=pointer-overflow>)
    # These two want type information, which backends have not.
    add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fno-sanitize=function,vptr>)
  endif()
  add_link_options(-fsanitize=address,undefined)
endif()
if(PBF_SANITIZE_THREAD)
  add_compile_options($<$<COMPILE_LANGUAGE:C,CXX>:-fsanitize=thread> $<$<COMPILE_LANGUAGE:C,CXX>:-fno-omit-frame-pointer>)
  add_link_options(-fsanitize=thread)
endif()

# Libraries may lack a sanitizer's functions, which are in programs.
set(PBF_NO_UNDEFINED -Wl,--no-undefined)
get_directory_property(options COMPILE_OPTIONS)
if("${CMAKE_C_FLAGS} ${CMAKE_CXX_FLAGS} ${options}" MATCHES -fsanitize)
  set(PBF_NO_UNDEFINED)
endif()

# Backends clear and copy structs of some hundred bytes for each group of particles: by moves, as GCC's
# own choice, rep stos and rep movs, takes tens of cycles to begin.
set(pbf_backend_copies)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|i.86)$")
  set(moves unrolled_loop:1024:noalign,libcall:-1:noalign)
  set(pbf_backend_copies -mmemset-strategy=${moves} -mmemcpy-strategy=${moves})
endif()
# Of backends, and of tests that include their headers.
set(pbf_backend_warnings)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU) # false alarms inside its own AVX-512 intrinsics
  list(APPEND pbf_backend_warnings -Wno-uninitialized -Wno-maybe-uninitialized)
endif()
