# cmake -D ROOT= -D BUILD= -D OUTPUT= -P sources.cmake
# Writes a hash of all that the CPU backends are compiled of, of what the build leaves out as well.
set(folders include backends/common backends/cpu backends/physics)
list(TRANSFORM folders PREPEND ${ROOT}/)
list(TRANSFORM folders APPEND /*)
file(GLOB_RECURSE files RELATIVE ${ROOT} ${folders})
file(READ ${BUILD} text)
foreach(file IN LISTS files)
  file(SHA256 ${ROOT}/${file} hash)
  string(APPEND text "${file} ${hash}\n")
endforeach()
string(SHA256 hash "${text}")
file(WRITE ${OUTPUT} "#define PBF_CPU_SOURCES \"${hash}\"\n")
