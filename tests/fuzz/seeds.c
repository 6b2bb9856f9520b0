/* Writes the seed corpora into a folder: states as pbf_save writes them, of each kind, and byte
 * strings that make the other targets do a little of everything. Scenes need none: the scenes that
 * come with the program are theirs. */
#include <string.h>
#include <sys/stat.h>

#include "kind.h"

static const char *folder;

static void put_file(const char *target, int number, const void *data, size_t size) {
  char path[4096];
  snprintf(path, sizeof path, "%s/%s", folder, target);
  mkdir(path, 0777);
  snprintf(path, sizeof path, "%s/%s/seed-%02d", folder, target, number);
  FILE *file = fopen(path, "wb");
  insist(file && fwrite(data, 1, size, file) == size);
  fclose(file);
}

static void add_particles(pbf_solver *s, kind k, uint32_t count) {
  _Alignas(8) unsigned char x[16 * 3 * 8];
  for (uint32_t i = 0; i < count; ++i)
    for (uint32_t axis = 0; axis < k.dimension; ++axis)
      put_number(x, i * k.dimension + axis, k.precision, 0.3 + 0.05 * ((i >> axis) & 3));
  insist(pbf_add_particles(s, count, x, NULL, NULL) == PBF_OK);
}

static void add_collider(pbf_solver *s) {
  pbf_collider ball;
  insist(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE) == PBF_OK);
  ball.radius = 0.1;
  ball.velocity[0] = 0.25;
  insist(pbf_set_colliders(s, 1, &ball) == PBF_OK);
}

static void put_state(unsigned bits, int rich) {
  static unsigned char state[1 << 14];
  uint64_t size = sizeof state - 1;
  kind k = kind_of(bits);
  pbf_solver *s = make_solver("serial", k, 16);
  if (rich) {
    add_particles(s, k, 12);
    add_collider(s);
    insist(pbf_remove_particles(s, 2, (const uint32_t[]){0, 7}) == PBF_OK);
    insist(pbf_step(s, 3) == PBF_OK);
  }
  state[0] = (unsigned char)(bits | 4 | 8);
  insist(pbf_save(s, state + 1, &size) == PBF_OK);
  put_file("state", (int)(2 * bits + (unsigned)rich), state, size + 1);
  pbf_destroy(s);
}

/* A generator of no quality, and the same everywhere. */
static uint8_t next_byte(uint64_t *x) {
  *x = *x * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return (uint8_t)(*x >> 56);
}

static void put_noise(const char *target, int number) {
  uint8_t bytes[600];
  uint64_t x = (uint64_t)number;
  for (size_t i = 0; i < sizeof bytes; ++i) bytes[i] = next_byte(&x);
  bytes[0] = (uint8_t)number;
  put_file(target, number, bytes, sizeof bytes);
}

int main(int argc, char **argv) {
  insist(argc == 2);
  folder = argv[1];
  for (unsigned bits = 0; bits < 4; ++bits) {
    put_state(bits, 0);
    put_state(bits, 1);
  }
  for (int i = 0; i < 24; ++i) {
    put_noise("calls", i);
    put_noise("plugin", i);
  }
  return 0;
}
