#include "allocator.h"

#include <stdlib.h>
#include <string.h>

counting test_count;

/* In front of each block, to check that release gets what allocate got. */
typedef struct block {
  uint64_t size;
  uint64_t alignment;
  void *start;
} block;

static void *allocate(void *user, uint64_t size, uint64_t alignment) {
  counting *count = user;
  if (++count->calls == count->failing_call) return NULL;
  if (size == 0 || alignment == 0 || (alignment & (alignment - 1))) abort();
  unsigned char *start = malloc(size + alignment + sizeof(block));
  if (!start) return NULL;
  uintptr_t address = (uintptr_t)start + sizeof(block) + alignment - 1;
  unsigned char *memory = start + (address / alignment * alignment - (uintptr_t)start);
  block head = {size, alignment, start};
  memcpy(memory - sizeof head, &head, sizeof head);
  memset(memory, 0xa5, size);
  count->live_bytes += size;
  ++count->live_blocks;
  return memory;
}

static void release(void *user, void *memory, uint64_t size, uint64_t alignment) {
  counting *count = user;
  block head;
  memcpy(&head, (unsigned char *)memory - sizeof head, sizeof head);
  if (head.size != size || head.alignment != alignment) abort();
  count->live_bytes -= size;
  --count->live_blocks;
  free(head.start);
}

const pbf_allocator test_allocator = {sizeof(pbf_allocator), 0, &test_count, allocate, release};
