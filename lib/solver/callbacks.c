#include "callbacks.h"

#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

#include "compiler.h"
#include "common/fp_environment.h"
#include "memory.h"
#include "os.h"

/* ---- Blocks of memory that are out --------------------------------------------------------- */

/* A fork may find any part of a change done: no place of those counted names a block twice, or one
 * with another one's size. */
static void put_block(pbf_block *place, pbf_block block) {
  place->memory = NULL;
  atomic_signal_fence(memory_order_release);
  place->size = block.size;
  place->alignment = block.alignment;
  atomic_signal_fence(memory_order_release);
  place->memory = block.memory;
  atomic_signal_fence(memory_order_release);
}

static void note_taken(pbf_callbacks *own, void *memory, uint64_t size, uint64_t alignment) {
  if (!memory || own->block_count == PBF_MAX_BLOCKS) return;
  put_block(&own->blocks[own->block_count], (pbf_block){memory, size, alignment});
  ++own->block_count;
}

/* Before it is released: a release that is left is not to be done again. */
static void note_released(pbf_callbacks *own, const void *memory) {
  for (uint32_t i = own->block_count; i-- > 0;) {
    if (own->blocks[i].memory != memory) continue;
    const pbf_block last = own->blocks[own->block_count - 1];
    --own->block_count;
    atomic_signal_fence(memory_order_release);
    if (i < own->block_count) put_block(&own->blocks[i], last);
    return;
  }
}

void pbf_callbacks_forget(pbf_solver *solver, const void *memory) {
  note_released(&solver->callbacks, memory);
}

void pbf_callbacks_release_rest(pbf_solver *solver) {
  pbf_callbacks *own = &solver->callbacks;
  while (own->block_count > 0) {
    pbf_block block = own->blocks[--own->block_count];
    if (!block.memory) continue;
    own->allocator.release(own->allocator.user, block.memory, block.size, block.alignment);
  }
}

/* ---- Places on the stack ------------------------------------------------------------------- */

/* A frame that is there still has all of its mark. One that is not lies where other frames are now,
 * if any, and in so many words these have at least a return address or a register. */
enum { MARK_WORDS = 64 };

typedef struct mark {
  volatile uint64_t words[MARK_WORDS];
} mark;

static uint64_t word_of(const pbf_callbacks *own, int k) {
  return (own->calls + (uint64_t)k) * UINT64_C(0x9e3779b97f4a7c15);
}

/* A stack may have been given other borders by what looks after memory: PBF_UNSANITIZED. */

PBF_UNSANITIZED static int is_changed(const pbf_callbacks *own, const mark *there) {
  for (int k = 0; k < MARK_WORDS; ++k)
    if (there->words[k] != word_of(own, k)) return 1;
  return 0;
}

/* Stacks grow downwards. */
PBF_UNSANITIZED int pbf_callbacks_were_left(const pbf_solver *solver) {
  const pbf_callbacks *own = &solver->callbacks;
  const mark *there = own->frame;
  const void *here = PBF_FRAME_ADDRESS();
  if (!there || own->thread != pbf_this_thread()) return 0;
  if (pbf_os_on_signal_stack() || !pbf_os_is_on_stack(here) || !pbf_os_is_on_stack(there)) return 0;
  return (uintptr_t)here > (uintptr_t)there || is_changed(own, there);
}

/* ---- Calling ------------------------------------------------------------------------------- */

PBF_UNSANITIZED static void begin(pbf_callbacks *own, mark *here) {
  pbf_os_find_stack();
  ++own->calls;
  for (int k = 0; k < MARK_WORDS; ++k) here->words[k] = word_of(own, k);
  own->frame = here;
}

/* The caller's function may have left another environment than that which it was called in. */
static void end(pbf_callbacks *own, pbf_fp_environment ours) {
  pbf_fp_end(ours);
  own->frame = NULL;
}

PBF_UNSANITIZED static void *allocate(void *user, uint64_t size, uint64_t alignment) {
  pbf_callbacks *own = &((pbf_solver *)user)->callbacks;
  const pbf_fp_environment ours = pbf_fp_now();
  mark here;
  begin(own, &here);
  void *memory = pbf_memory_ask(&own->allocator, size, alignment);
  end(own, ours);
  note_taken(own, memory, size, alignment);
  return memory;
}

PBF_UNSANITIZED static void release(void *user, void *memory, uint64_t size, uint64_t alignment) {
  pbf_callbacks *own = &((pbf_solver *)user)->callbacks;
  const pbf_fp_environment ours = pbf_fp_now();
  mark here;
  note_released(own, memory);
  begin(own, &here);
  own->allocator.release(own->allocator.user, memory, size, alignment);
  end(own, ours);
}

PBF_UNSANITIZED static void write_log(void *user, int32_t level, const char *message) {
  pbf_callbacks *own = &((pbf_solver *)user)->callbacks;
  const pbf_fp_environment ours = pbf_fp_now();
  mark here;
  if (!own->log || atomic_load_explicit(&((pbf_solver *)user)->destroyed, memory_order_relaxed))
    return;
  begin(own, &here);
  own->log(own->log_user, level, message);
  end(own, ours);
}

void pbf_callbacks_wrap(pbf_solver *solver, const pbf_allocator *allocator, pbf_log_fn log,
                        void *log_user) {
  solver->callbacks.allocator = *allocator;
  solver->callbacks.log = log;
  solver->callbacks.log_user = log_user;
  solver->allocator = (pbf_allocator){sizeof solver->allocator, 0, solver, allocate, release};
  solver->log = write_log;
  solver->log_user = solver;
}
