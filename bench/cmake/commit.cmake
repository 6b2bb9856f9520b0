# cmake -DSOURCE=<source tree> -DOUTPUT=<commit.h> -P commit.cmake
# Runs at every build; writes only when the commit has changed, so that nothing rebuilds for it.
cmake_minimum_required(VERSION 3.25)
execute_process(
  COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12 --match=
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(commit "unknown")
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "#define PBF_BENCH_COMMIT \"@commit@\"\n" @ONLY)
