#include "fiber.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>

#include <atomic>

#if !defined(__x86_64__)
#include <ucontext.h>
#endif

namespace emulated {

namespace {
enum : size_t { STACK_BYTES = 128 * 1024, GUARD_BYTES = 4096 };
}

#if defined(__x86_64__)

struct fiber {
  void *stack_pointer;
  char *memory;
  void (*run)(void *);
  void *argument;
  fiber *next_free;
};

extern "C" __attribute__((visibility("hidden"))) void emulated_switch_stacks(void **from, void *to);

/* What a called function has to preserve goes onto the stack that is left. */
__asm__(
    ".text\n"
    ".type emulated_switch_stacks, @function\n"
    ".hidden emulated_switch_stacks\n"
    ".globl emulated_switch_stacks\n"
    "emulated_switch_stacks:\n"
    "  pushq %rbp\n  pushq %rbx\n  pushq %r12\n  pushq %r13\n  pushq %r14\n  pushq %r15\n"
    "  movq %rsp, (%rdi)\n"
    "  movq %rsi, %rsp\n"
    "  popq %r15\n  popq %r14\n  popq %r13\n  popq %r12\n  popq %rbx\n  popq %rbp\n"
    "  ret\n"
    ".size emulated_switch_stacks, .-emulated_switch_stacks\n");

namespace {

thread_local fiber own, *present = &own;

void begin() {
  present->run(present->argument);
  abort();
}

}  // namespace

static void prepare(fiber *f) {
  uintptr_t *top = reinterpret_cast<uintptr_t *>(f->memory + GUARD_BYTES + STACK_BYTES) - 2;
  top[0] = reinterpret_cast<uintptr_t>(begin);
  top[1] = 0;
  for (int k = 1; k <= 6; ++k) top[-k] = 0;
  f->stack_pointer = top - 6;
}

void switch_to(fiber *f) {
  fiber *from = present;
  present = f ? f : &own;
  if (from != present) emulated_switch_stacks(&from->stack_pointer, present->stack_pointer);
}

#else

struct fiber {
  ucontext_t context;
  char *memory;
  void (*run)(void *);
  void *argument;
  fiber *next_free;
};

namespace {

thread_local fiber own, *present = &own;

void begin() {
  present->run(present->argument);
  abort();
}

}  // namespace

static void prepare(fiber *f) {
  getcontext(&f->context);
  f->context.uc_stack.ss_sp = f->memory + GUARD_BYTES;
  f->context.uc_stack.ss_size = STACK_BYTES;
  makecontext(&f->context, begin, 0);
}

void switch_to(fiber *f) {
  fiber *from = present;
  present = f ? f : &own;
  if (from != present) swapcontext(&from->context, &present->context);
}

#endif

namespace {

struct fiber_pool {
  fiber *first = nullptr;
  ~fiber_pool() {
    while (fiber *f = first) {
      first = f->next_free;
      munmap(f->memory, GUARD_BYTES + STACK_BYTES);
      delete f;
    }
  }
};
thread_local fiber_pool pool;
std::atomic<int> stacks;
enum { GUARDED_MOST = 8192 };

}  // namespace

fiber *new_fiber(void (*run)(void *), void *argument) {
  fiber *f = pool.first;
  if (f) {
    pool.first = f->next_free;
  } else {
    f = new fiber();
    void *memory = mmap(nullptr, GUARD_BYTES + STACK_BYTES, PROT_READ | PROT_WRITE,
                        MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    const bool guarded = stacks++ < GUARDED_MOST; /* the system has so many mappings, and no more */
    if (memory == MAP_FAILED || (guarded && mprotect(memory, GUARD_BYTES, PROT_NONE) != 0)) {
      fprintf(stderr, "cuda on a CPU: no memory for the stack of a thread\n");
      abort();
    }
    f->memory = static_cast<char *>(memory);
  }
  f->run = run;
  f->argument = argument;
  prepare(f);
  return f;
}

fiber *present_fiber() { return present; }

void free_fiber(fiber *f) {
  f->next_free = pool.first;
  pool.first = f;
}

}  // namespace emulated
