# cmake -D COMPILER= -D HEADER= -D OUTPUT= -P preprocess.cmake
# Writes the header as cffi reads it: C declarations and integer constants, without comments,
# attributes and what stdint.h has, which cffi knows.
cmake_path(GET OUTPUT PARENT_PATH folder)
cmake_path(GET HEADER PARENT_PATH headers)
file(WRITE ${folder}/empty/stdint.h "")
execute_process(
  COMMAND ${COMPILER} -E -P -dD -undef -nostdinc -I${folder}/empty -I${headers}/.. "-D__attribute__(x)=" ${HEADER}
  OUTPUT_VARIABLE text COMMAND_ERROR_IS_FATAL ANY)
file(REMOVE_RECURSE ${folder}/empty)
string(REGEX REPLACE "#define (PBF_[A-Z0-9_]+) (0x[0-9a-f]+|[0-9]+)u?\n" "@define \\1 \\2\n" text "${text}")
string(REGEX REPLACE "#[^\n]*\n" "" text "${text}")
string(REPLACE "@define" "#define" text "${text}")
file(WRITE ${OUTPUT} "${text}")
