#ifndef PBF_TESTS_SOAK_LIMITS_H
#define PBF_TESTS_SOAK_LIMITS_H

#include <stdint.h>

/* Lowers RLIMIT_AS to as many bytes more as the process has now. */
void limit_addresses(uint64_t more);

/* Lowers RLIMIT_NPROC for good: as an ordinary user, for root has no such limit. */
void limit_threads(uint64_t threads);

#endif
