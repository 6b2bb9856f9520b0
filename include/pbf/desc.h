/* pbf/desc.h: what a solver is made by and keeps for life: dimension, precision, capacity, backend
 * and device, and what the program lends it: memory, a log, a task system.
 *
 * The rules of pbf.h hold here, too.
 */
#ifndef PBF_DESC_H
#define PBF_DESC_H

#include <pbf/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Solver description ---------------------------------------------------------------------- */

/* Precisions: bytes of a number. */
enum { PBF_FLOAT32 = 4, PBF_FLOAT64 = 8 };

/* Between which runs the CPU backends' bits are the same. */
enum {
  PBF_DETERMINISM_ACROSS_MACHINES = 0, /* all: with any instruction set and processor, too */
  PBF_DETERMINISM_PER_MACHINE = 1      /* those on this machine, with this `isa`: with any number of
                                          threads and capacity, again and again. In float32 sets with
                                          fused multiply-add ("neon", "avx2", "avx512") then use it,
                                          which is faster; pbf_info.device_name says so */
};

/* Levels of what is logged. */
enum { PBF_LOG_INFO = 1, PBF_LOG_WARNING = 2 };

/* Called with a complete sentence, without a newline, from whichever thread is in the library. */
typedef void (*pbf_log_fn)(void *user, int32_t level, const char *message);

/* Every allocation of host memory that a solver makes goes through these two. `allocate` returns
 * memory aligned to `alignment` (a power of two) or null; `release` gets the same size back, at
 * once where the memory is not aligned, which is as none.
 * Both may be called from any thread that calls into the solver. */
typedef struct pbf_allocator {
  uint32_t struct_size;
  uint32_t reserved; /* 0 */
  void *user;
  void *(*allocate)(void *user, uint64_t size, uint64_t alignment);
  void (*release)(void *user, void *memory, uint64_t size, uint64_t alignment);
} pbf_allocator;

/* A task system of the caller's, as engines have one. A solver of `threads` that has it starts no
 * threads but that of pbf_begin_step: each of its steps, or of some of them at once, is one task of
 * `items` items.
 *
 * `enqueue_task` has run(task, first, last) called such that each item 0 … items - 1 is in one of
 * the ranges first … last - 1: in any threads, at once or one after another, as late as it likes,
 * or all before it returns. A range has at least `min_range` items, but for the last one. It
 * returns a handle for `finish_task`, or null when all items have been run.
 * `finish_task` returns when all items have been run, and may run some itself. It is called once
 * for each handle, by the thread that enqueued the task, before that thread's call into pbf ends.
 *
 * The calling thread works, too, and no item waits for one that has not begun: what others have not
 * begun, it does itself. So nothing hangs where all workers are busy, or the caller is the only
 * one. An item that has begun may be waited for, and must not be suspended (by a fiber) for other
 * work: it calls nothing of the caller's. One that runs after its task's end does nothing, and
 * where `finish_task` returns too soon, the call into pbf waits for those that have begun. Neither
 * function may call into the same solver, be left by an exception or a longjmp, or end its thread:
 * items may be in what the call has on its stack, and the solver then stays busy. Bits do not
 * depend on which thread runs what, nor on its floating-point environment. */
typedef void (*pbf_task_fn)(void *task, uint32_t first, uint32_t last);
typedef void *(*pbf_enqueue_task_fn)(void *user, pbf_task_fn run, void *task, uint32_t items,
                                     uint32_t min_range);
typedef void (*pbf_finish_task_fn)(void *user, void *handle);

/* What a solver is made by; pbf_desc_init fills it with defaults. */
typedef struct pbf_desc {
  uint32_t struct_size;
  uint32_t api_version; /* PBF_API_VERSION */
  uint32_t dimension;   /* 2 or 3 */
  uint32_t precision;   /* PBF_FLOAT32 or PBF_FLOAT64 */
  uint32_t capacity;    /* maximum of particles held at once, 1 … PBF_MAX_CAPACITY */
  uint32_t strict;      /* 1: `backend` or failure; 0: fall back and say so in pbf_info */
  const char *backend;  /* "auto" (also null), "reference", "serial", "threads", "openmp", … */
  int32_t device;       /* which device of that backend; 0 is the first, and a CPU's only one. A
                           backend that serves instead of that one has its first */
  uint32_t threads;     /* CPU threads, the caller's included; 0: as many as there are CPUs, of
                           which "threads" uses those that pay for the particles that there are.
                           A process that can't start so many gets fewer, see pbf_info, and the
                           same bits */
  void *stream;         /* cudaStream_t to work on; null: one of the solver's own; on a CPU null.
                           A backend that serves instead of that one does not get it */
  const pbf_allocator *allocator; /* null: malloc; copied by pbf_create */
  pbf_log_fn log;                 /* null: silence */
  void *log_user;
  const char *isa; /* instruction set of the CPU backends' loops over pairs: "scalar", "simd128"
                      (WebAssembly), "sse2", "neon", "avx2", "avx512"; null: the best one that the
                      processor and the build have. All give the same bits; pbf_info.device_name
                      names the one in use. What the processor, the build or the backend lacks is
                      refused, with "auto", too; copied by pbf_create */
  /* The task system: both functions, or neither. `threads` is then how many of its workers may take
   * part, the caller included; `openmp`, which has threads of its own, refuses. */
  pbf_enqueue_task_fn enqueue_task;
  pbf_finish_task_fn finish_task;
  void *task_user;
  uint32_t determinism; /* PBF_DETERMINISM_… */
  uint32_t reserved;    /* 0 */
} pbf_desc;

/* Particles of a solver. */
#define PBF_MAX_CAPACITY 0x3fffffffu

/* Fills *desc with the defaults: 3D, float32, capacity 100,000, backend "auto". `struct_size` is
 * sizeof(pbf_desc). */
PBF_API pbf_status pbf_desc_init(pbf_desc *desc, uint32_t struct_size);

#ifdef __cplusplus
}
#endif

#endif
