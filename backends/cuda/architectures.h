/* Which devices a build has code for, by its architectures as CMake lists them, with commas
 * between: "80-real,90". Of a real one there is machine code, for devices of its generation from it
 * on; of a virtual one code that a driver compiles, for all from it on; else of both. */
#ifndef PBF_CUDA_ARCHITECTURES_H
#define PBF_CUDA_ARCHITECTURES_H

#include <stdlib.h>
#include <string.h>

/* `capability` is of a device, 80 for 8.0. The names that are no numbers, as "all", are of whatever
 * a compiler makes of them. */
static inline bool pbf_cuda_has_code(const char *architectures, int capability) {
  for (const char *at = architectures; *at;) {
    char *kind = nullptr;
    const size_t length = strcspn(at, ",");
    const int architecture = (int)strtol(at, &kind, 10);
    const size_t left = length - (size_t)(kind - at);
    if (kind == at && length > 0) return true;
    if (*kind == 'a' && left > 0) { /* for that device alone */
      if (architecture == capability) return true;
    } else if (left == 5 && memcmp(kind, "-real", left) == 0) {
      if (architecture / 10 == capability / 10 && architecture <= capability) return true;
    } else if (architecture <= capability && length > 0) {
      return true;
    }
    at += length;
    at += *at == ',';
  }
  return false;
}

#endif
