/* Where the lying plugin takes its lies from: the fuzzer's bytes. */
#ifndef PBF_TESTS_FUZZ_LIAR_H
#define PBF_TESTS_FUZZ_LIAR_H

#include "input.h"

typedef struct liar_control {
  input *lies;        /* null: honest in everything */
  int lies_in_answer; /* whether negotiation lies, too */
} liar_control;

#endif
