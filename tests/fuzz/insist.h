/* What a fuzz target holds to be true: a violation is told and ends the process, as a crash does.
 */
#ifndef PBF_TESTS_FUZZ_INSIST_H
#define PBF_TESTS_FUZZ_INSIST_H

#include <stdio.h>
#include <stdlib.h>

static inline void insist_at(int holds, const char *text, const char *file, int line) {
  if (holds) return;
  fprintf(stderr, "%s:%d: violated: %s\n", file, line, text);
  abort();
}

#define insist(condition) insist_at((condition) != 0, #condition, __FILE__, __LINE__)

#endif
