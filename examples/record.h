/* Records what a program does with a solver, in a file that `pbf-bench replay` runs again: a report
 * of an error in one file. Copy it. Call each after the call of the library that it records:
 *
 *   record_begin(file, solver)                     once
 *   record_params(file, solver, &params)           pbf_set_params
 *   record_colliders(file, solver, count, parts)   pbf_set_colliders
 *   record_move(file, solver, count, parts, time)  pbf_move_colliders
 *   record_state(file, solver)                     anything that changes particles; pbf_load
 *   record_hash(file, solver)                      pbf_step, as often as is wanted
 *
 * A program that is stopped leaves a file that is good up to there, if it is flushed. */
#ifndef PBF_RECORD_H
#define PBF_RECORD_H

#include <inttypes.h>
#include <pbf/pbf.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static inline void record_line(FILE *file, pbf_solver *solver, const char *kind, const char *more,
                               const void *bytes, uint64_t size) {
  pbf_info info = {.struct_size = sizeof info};
  if (pbf_get_info(solver, &info) != PBF_OK) return;
  fprintf(file, "%s %" PRIu64 " %s%s", kind, info.step, more, size > 0 ? "" : "-");
  for (uint64_t i = 0; i < size; ++i) fprintf(file, "%02x", ((const unsigned char *)bytes)[i]);
  fputc('\n', file);
}

static inline void record_state(FILE *file, pbf_solver *solver) {
  uint64_t size = 0;
  if (pbf_save(solver, NULL, &size) != PBF_OK) return;
  void *state = malloc(size);
  if (state && pbf_save(solver, state, &size) == PBF_OK)
    record_line(file, solver, "state", "", state, size);
  free(state);
}

static inline void record_begin(FILE *file, pbf_solver *solver) {
  pbf_info info = {.struct_size = sizeof info};
  if (pbf_get_info(solver, &info) != PBF_OK) return;
  fprintf(file, "pbf-record 1 %u %u %u %u %s\nbuild %s\ndevice %s\n", info.dimension,
          info.precision, info.capacity, info.threads, info.backend, info.build_id,
          info.device_name);
  record_state(file, solver);
}

static inline void record_params(FILE *file, pbf_solver *solver, const pbf_params *params) {
  record_line(file, solver, "params", "", params, sizeof *params);
}

static inline void record_colliders(FILE *file, pbf_solver *solver, uint32_t count,
                                    const pbf_collider *colliders) {
  record_line(file, solver, "colliders", "", colliders, count * sizeof *colliders);
}

/* With a point, whatever the program's locale writes, which may have several bytes. */
static inline void record_number(char text[40], double number) {
  snprintf(text, 40, "%.17g ", number);
  char *point = text + strspn(text, "-0123456789"), *rest = point + strcspn(point, "0123456789 e");
  if (point > text && rest > point) memmove(point + 1, rest, strlen(rest) + 1), *point = '.';
}

static inline void record_move(FILE *file, pbf_solver *solver, uint32_t count,
                               const pbf_collider *targets, double duration) {
  char more[40];
  record_number(more, duration);
  record_line(file, solver, "move", more, targets, count * sizeof *targets);
}

static inline void record_hash(FILE *file, pbf_solver *solver) {
  pbf_info info = {.struct_size = sizeof info};
  uint64_t hash = 0;
  if (pbf_get_info(solver, &info) == PBF_OK && pbf_hash(solver, &hash) == PBF_OK)
    fprintf(file, "hash %" PRIu64 " %016" PRIx64 "\n", info.step, hash);
}

#endif
