# CUDA for the cuda backend: nvcc of the machine, or of the wheels in PBF_CUDA_WHEELS (see
# cmake/fetch-nvcc.sh). Sets PBF_CUDA_FOUND, or PBF_CUDA_REASON. CMake's FindCUDAToolkit is not
# asked: it does not accept the folders of the wheels, and the language alone is enough.
option(PBF_REQUIRE_CUDA "No nvcc is an error instead of a build without the cuda backend" OFF)
set(PBF_CUDA_WHEELS "" CACHE PATH "Folder into which cmake/fetch-nvcc.sh has put nvcc; empty: the machine's")
set(architectures "80-real;90")
if(DEFINED ENV{CUDAARCHS}) # CMake's own variable for this
  set(architectures "$ENV{CUDAARCHS}")
endif()
set(PBF_CUDA_ARCHITECTURES "${architectures}" CACHE STRING
  "Machine code for each -real architecture, and code that a driver can compile for later ones")

set(PBF_CUDA_FOUND FALSE)
if(CMAKE_CROSSCOMPILING AND NOT CMAKE_CUDA_COMPILER)
  set(PBF_CUDA_REASON "nvcc found here is for this system; CMAKE_CUDA_COMPILER can name one")
  return()
endif()
if(NOT CMAKE_CUDA_COMPILER)
  if(DEFINED ENV{CUDACXX}) # CMake's own variable, too
    find_program(PBF_NVCC "$ENV{CUDACXX}")
  elseif(PBF_CUDA_WHEELS)
    find_program(PBF_NVCC nvcc PATHS "${PBF_CUDA_WHEELS}/nvidia/cu13/bin" NO_DEFAULT_PATH)
  else()
    find_program(PBF_NVCC nvcc PATHS ENV CUDA_HOME ENV CUDA_PATH /usr/local/cuda PATH_SUFFIXES bin)
  endif()
  if(PBF_NVCC)
    set(CMAKE_CUDA_COMPILER ${PBF_NVCC})
  endif()
endif()
if(NOT CMAKE_CUDA_COMPILER)
  set(PBF_CUDA_REASON "no nvcc in CUDACXX, PBF_CUDA_WHEELS, on PATH, in CUDA_HOME or /usr/local/cuda; cmake/fetch-nvcc.sh can fetch one")
  return()
endif()

set(CMAKE_CUDA_ARCHITECTURES ${PBF_CUDA_ARCHITECTURES})
set(CMAKE_CUDA_RUNTIME_LIBRARY Static)
enable_language(CUDA)
set(PBF_CUDA_FOUND TRUE)
set(pbf_cuda_compress)
if(CMAKE_CUDA_COMPILER_VERSION VERSION_GREATER_EQUAL 12.8)
  set(pbf_cuda_compress --compress-mode=size)
endif()

# pbf_cuda_target(<target>): the compile rules of CUDA code.
function(pbf_cuda_target target)
  set_target_properties(${target} PROPERTIES
    CUDA_STANDARD 17 CUDA_STANDARD_REQUIRED ON CUDA_VISIBILITY_PRESET hidden
    CUDA_SEPARABLE_COMPILATION OFF LINKER_LANGUAGE CUDA)
  target_compile_options(${target} PRIVATE
    $<$<COMPILE_LANGUAGE:CUDA>:-ftz=true ${pbf_cuda_compress} -Xcompiler=-Wall,-Wextra,-Wno-missing-field-initializers,-fno-exceptions,-fno-rtti>)
endfunction()
