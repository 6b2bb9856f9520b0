/* Bytes of a fuzzer, taken one value at a time; past the end every value is 0. */
#ifndef PBF_TESTS_FUZZ_INPUT_H
#define PBF_TESTS_FUZZ_INPUT_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

typedef struct input {
  const uint8_t *data;
  size_t size, at;
} input;

static inline int input_ended(const input *in) { return in->at >= in->size; }

static inline void take_bytes(input *in, void *out, size_t size) {
  size_t left = in->size - in->at, taken = size < left ? size : left;
  memset(out, 0, size);
  if (taken) memcpy(out, in->data + in->at, taken);
  in->at += taken;
}

static inline uint8_t take_u8(input *in) {
  uint8_t value;
  take_bytes(in, &value, sizeof value);
  return value;
}

static inline uint32_t take_u32(input *in) {
  uint32_t value;
  take_bytes(in, &value, sizeof value);
  return value;
}

static inline double take_f64(input *in) {
  double value;
  take_bytes(in, &value, sizeof value);
  return value;
}

/* 0 … 1 in 255 parts: two bytes' worth of different values are seldom of use. */
static inline double take_share(input *in) { return take_u8(in) / 255.0; }

static inline double take_from(input *in, double low, double high) {
  return low + (high - low) * take_share(in);
}

#endif
