/* By what plugins know that the shared solver is of their own build: its options and its sources.
 */
#include "cpu/core.h"
#include "pbf_cpu_sources.h"

const char cpu_build[] = PBF_BUILD_ID ", " PBF_CPU_SOURCES;
