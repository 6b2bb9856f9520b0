/* How much a test does. */
#ifndef PBF_TESTS_AMOUNT_H
#define PBF_TESTS_AMOUNT_H

#include <stdlib.h>

/* Whether all is asked for, as `./run test long` does: the environment's PBF_TEST_LONG. Otherwise
 * fewer of what repeats are enough. */
static inline int test_is_long(void) {
  const char *asked = getenv("PBF_TEST_LONG");
  return asked && asked[0] && asked[0] != '0';
}

#endif
