#include "heap.h"

#include <stdlib.h>
#include <string.h>

#include "record.h"

typedef struct block {
  uint64_t size, alignment;
  void *start;
} block;

static int comes_down(atomic_int *count) {
  return atomic_load(count) > 0 && atomic_fetch_sub(count, 1) == 1;
}

static void maybe_leave(heap *h) {
  if (!pthread_equal(h->thread, pthread_self()) || !comes_down(&h->leaving_in)) return;
  atomic_fetch_add(&h->left, 1);
  longjmp(h->jump, 1);
}

static void *allocate(void *user, uint64_t size, uint64_t alignment) {
  heap *h = user;
  if (size == 0 || alignment == 0 || (alignment & (alignment - 1)))
    found(h->actor, "an allocation of %llu bytes at %llu", (unsigned long long)size,
          (unsigned long long)alignment);
  maybe_leave(h);
  if (comes_down(&h->failing_in) || size > h->most ||
      (uint64_t)atomic_load(&h->bytes) > h->most - size) {
    atomic_fetch_add(&h->failed, 1);
    return NULL;
  }
  unsigned char *start = malloc(size + alignment + sizeof(block));
  if (!start) return NULL;
  const uintptr_t address = (uintptr_t)start + sizeof(block) + alignment - 1;
  unsigned char *memory = start + (address / alignment * alignment - (uintptr_t)start);
  const block head = {size, alignment, start};
  memcpy(memory - sizeof head, &head, sizeof head);
  memset(memory, 0xa5, size);
  atomic_fetch_add(&h->bytes, (int64_t)size);
  atomic_fetch_add(&h->blocks, 1);
  return memory;
}

static void release(void *user, void *memory, uint64_t size, uint64_t alignment) {
  heap *h = user;
  block head;
  memcpy(&head, (unsigned char *)memory - sizeof head, sizeof head);
  if (head.size != size || head.alignment != alignment)
    found(h->actor, "release of %llu bytes at %llu, which were %llu at %llu",
          (unsigned long long)size, (unsigned long long)alignment, (unsigned long long)head.size,
          (unsigned long long)head.alignment);
  atomic_fetch_sub(&h->bytes, (int64_t)size);
  atomic_fetch_sub(&h->blocks, 1);
  memset(memory, 0x5a, size);
  free(head.start);
}

pbf_allocator heap_allocator(heap *h) {
  return (pbf_allocator){sizeof(pbf_allocator), 0, h, allocate, release};
}
