/* Part of lanes.h: one lane: the scalar twin that the vector kernels are tested against. */
#define LANES_SCALAR
enum { WIDTH = 1 };
typedef pbf_real lane;
typedef uint32_t slots;
enum { PARTS = 8 };
typedef struct table {
  const pbf_real *array;
  pbf_real sentinel;
} table;
typedef struct place {
  uint32_t index;
  int known;
} place;

PBF_FN lane lane_load(const pbf_real *p) { return *p; }
PBF_FN void lane_store(pbf_real *p, lane a) { *p = a; }
PBF_FN int lane_any_below(lane a, lane b) { return a < b; }

PBF_FN slots slots_set(uint32_t a) { return a; }
PBF_FN slots slots_iota(void) { return 0; }
PBF_FN slots slots_load(const uint32_t *p) { return *p; }
PBF_FN void slots_store(uint32_t *p, slots a) { *p = a; }
PBF_FN slots slots_shift_right(slots a, int count) { return a >> count; }
PBF_FN slots slots_bit(slots s) { return s < SLOTS ? 0x80000000u >> s : 0; }
PBF_FN uint32_t slots_max(slots a) { return a; }
PBF_FN uint32_t slots_any(slots a) { return a; }
PBF_FN slots slots_mark(slots m, lane a, lane b, uint32_t bit) { return a < b ? m | bit : m; }
PBF_FN slots slots_below(slots a, uint32_t limit) { return a < limit ? ~0u : 0; }
PBF_FN slots slots_shift_left(slots a, int count) { return a << count; }
PBF_FN slots slots_of_bytes(const uint8_t *p) { return *p; }

PBF_FN place place_of(const uint32_t first[PARTS], slots s) {
  return (place){first[s / SLOTS] + s % SLOTS - 1, s != 0};
}
PBF_FN table table_of(const pbf_real *array, const uint32_t first[PARTS], pbf_real sentinel) {
  (void)first;
  return (table){array, sentinel};
}
PBF_FN lane table_at(const table *t, place p) { return p.known ? t->array[p.index] : t->sentinel; }
