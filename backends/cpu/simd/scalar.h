/* Part of lanes.h: one lane: the scalar twin that the vector kernels are tested against. */
enum { WIDTH = 1 };
typedef pbf_real lane;
typedef uint32_t u32_lanes;
enum { PARTS = 8 };
typedef struct window {
  const pbf_real *array;
  pbf_real sentinel;
} window;
typedef struct lane_indices {
  uint32_t index;
  int known;
} lane_indices;

PBF_FN lane lane_load(const pbf_real *p) { return *p; }
PBF_FN void lane_store(pbf_real *p, lane a) { *p = a; }
PBF_FN int lane_any_below(lane a, lane b) { return a < b; }
PBF_FN int lane_all_below(lane a, lane b) { return a < b; }

PBF_FN u32_lanes u32_set(uint32_t a) { return a; }
PBF_FN u32_lanes u32_iota(void) { return 0; }
PBF_FN u32_lanes u32_load(const uint32_t *p) { return *p; }
PBF_FN void u32_store(uint32_t *p, u32_lanes a) { *p = a; }
PBF_FN u32_lanes u32_shift_right(u32_lanes a, int count) { return a >> count; }
PBF_FN u32_lanes u32_bit(u32_lanes s) { return s < SLOTS ? 1u << s : 0; }
PBF_FN uint32_t u32_max(u32_lanes a) { return a; }
PBF_FN uint32_t u32_any(u32_lanes a) { return a; }
PBF_FN u32_lanes u32_mark(u32_lanes m, lane a, lane b, u32_lanes bit) {
  return a < b ? m | bit : m;
}
PBF_FN u32_lanes u32_below(u32_lanes a, uint32_t limit) { return a < limit ? ~0u : 0; }
PBF_FN u32_lanes u32_shift_left(u32_lanes a, int count) { return a << count; }
PBF_FN u32_lanes u32_of_bytes(const uint8_t *p) { return *p; }

PBF_FN lane_indices lane_indices_of(const uint32_t first[PARTS], u32_lanes s) {
  return (lane_indices){first[s / SLOTS] + s % SLOTS - 1, s != 0};
}
PBF_FN window window_of(const pbf_real *array, const uint32_t first[PARTS], pbf_real sentinel) {
  (void)first;
  return (window){array, sentinel};
}
PBF_FN lane window_at(const window *t, lane_indices p) {
  return p.known ? t->array[p.index] : t->sentinel;
}
