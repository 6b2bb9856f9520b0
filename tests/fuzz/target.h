/* The function that libFuzzer, or replay.c without it, calls with each input. */
#ifndef PBF_TESTS_FUZZ_TARGET_H
#define PBF_TESTS_FUZZ_TARGET_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#ifdef __cplusplus
}
#endif

#endif
