#include "desc.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "check.h"
#include "common/instruction_sets.h"
#include "error.h"
#include "memory.h"
#include "os.h"
#include "structs.h"

/* More threads than any machine has: a larger number is a negative one, or garbage. */
enum { MAX_THREADS = 65536 };

#define RULE(member, min, max, hint) \
  { #member, offsetof(pbf_desc, member), min, max, hint, 0 }

static const pbf_count_rule rules[] = {
    RULE(api_version, PBF_API_VERSION, PBF_API_VERSION, ", the PBF_API_VERSION of pbf.h"),
    RULE(dimension, 2, 3, ""),
    RULE(capacity, 1, PBF_MAX_CAPACITY, ""),
    RULE(strict, 0, 1, ""),
    RULE(threads, 0, MAX_THREADS, "; 0 takes as many as the machine offers"),
    RULE(determinism, PBF_DETERMINISM_ACROSS_MACHINES, PBF_DETERMINISM_PER_MACHINE,
         ", PBF_DETERMINISM_ACROSS_MACHINES or PBF_DETERMINISM_PER_MACHINE"),
    RULE(reserved, 0, 0, ""),
};

static pbf_status check_numbers(const pbf_desc *desc) {
  pbf_status status = pbf_check_counts(rules, sizeof rules / sizeof rules[0], "desc", desc);
  if (status != PBF_OK) return status;
  if (desc->precision != PBF_FLOAT32 && desc->precision != PBF_FLOAT64) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "desc.precision is %u; it must be %d (PBF_FLOAT32) or %d (PBF_FLOAT64)",
                    desc->precision, PBF_FLOAT32, PBF_FLOAT64);
  }
  if (desc->device < 0) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "desc.device is %d; it must be at least 0",
                    desc->device);
  }
  return PBF_OK;
}

static pbf_status check_allocator(const pbf_allocator *theirs, pbf_allocator *allocator) {
  if (!theirs) {
    *allocator = pbf_default_allocator;
    return PBF_OK;
  }
  pbf_status status = pbf_struct_in(&pbf_kind_allocator, theirs, allocator);
  if (status != PBF_OK) return status;
  if (allocator->reserved) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "desc.allocator->reserved is %u; it must be 0",
                    allocator->reserved);
  }
  if (!allocator->allocate || !allocator->release) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "desc.allocator->%s is null; both functions must be set",
                    allocator->allocate ? "release" : "allocate");
  }
  return PBF_OK;
}

static pbf_status check_tasks(const pbf_desc *desc) {
  if (!desc->enqueue_task == !desc->finish_task) return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "desc.%s is null; both functions of a task system must be set, or neither",
                  desc->enqueue_task ? "finish_task" : "enqueue_task");
}

static pbf_status copy_backend_name(const char *name, char copy[PBF_NAME_SIZE]) {
  if (!name) name = "auto";
  size_t length = strnlen(name, PBF_NAME_SIZE);
  if (length == 0 || length == PBF_NAME_SIZE) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "desc.backend is \"%.*s\"; it must be a name of 1 … %d characters",
                    PBF_NAME_SIZE, name, PBF_NAME_SIZE - 1);
  }
  memcpy(copy, name, length + 1);
  return PBF_OK;
}

static pbf_status copy_isa(const char *theirs, pbf_checked_desc *checked) {
  const char *name = theirs ? theirs : pbf_environment("PBF_ISA");
  checked->isa[0] = 0;
  checked->isa_by_environment = !theirs;
  if (!name || (!theirs && !name[0])) return PBF_OK;
  int known = pbf_instruction_set_of(name);
  if (known == PBF_INSTRUCTION_SET_COUNT) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "%s is \"%.*s\"; it must be \"scalar\", \"simd128\", \"sse2\", \"neon\", "
                    "\"avx2\" or \"avx512\", or %s",
                    theirs ? "desc.isa" : "PBF_ISA in the environment", PBF_NAME_SIZE, name,
                    theirs ? "null for the best one" : "unset");
  }
  snprintf(checked->isa, sizeof checked->isa, "%s", pbf_instruction_sets[known]);
  return PBF_OK;
}

const char *pbf_desc_isa(const pbf_checked_desc *checked, const char *backend) {
  int is_named = strcmp(backend, checked->backend) == 0;
  if (!checked->isa[0] || (checked->isa_by_environment && is_named)) return NULL;
  return checked->isa;
}

pbf_status pbf_desc_check(const pbf_desc *theirs, pbf_checked_desc *checked) {
  pbf_status status = theirs ? pbf_struct_in(&pbf_kind_desc, theirs, &checked->desc)
                             : pbf_desc_init(&checked->desc, sizeof checked->desc);
  if (status == PBF_OK) status = check_numbers(&checked->desc);
  if (status == PBF_OK) status = check_tasks(&checked->desc);
  if (status == PBF_OK) status = check_allocator(checked->desc.allocator, &checked->allocator);
  if (status == PBF_OK) status = copy_backend_name(checked->desc.backend, checked->backend);
  if (status == PBF_OK) status = copy_isa(checked->desc.isa, checked);
  return status;
}
