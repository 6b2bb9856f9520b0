/* A plane's part in the sums of its solid (loads.h). */
#ifndef PBF_PHYSICS_LOAD_PARTS_H
#define PBF_PHYSICS_LOAD_PARTS_H

#include "physics/load_shares.h"

/* What the sums of a solid are told in: their units, and from where places are. */
typedef struct pbf_load_measure {
  double units[PBF_LOAD_SUMS], origin[PBF_DIM];
} pbf_load_measure;

/* Of a depth, which is not negative. */
PBF_FN uint64_t pbf_depth_bits(double depth) {
  uint64_t bits;
  memcpy(&bits, &depth, sizeof bits);
  return bits;
}

PBF_FN void pbf_deepen(pbf_load_sums *to, uint64_t depth) {
  to->depth = to->depth > depth ? to->depth : depth;
}

namespace {

/* A plane's part, in units, as it is added to the sums of its solid. */
struct load_part {
  pbf_wide_sum of[PBF_LOAD_SUMS];
  uint64_t depth;
  bool touches;
};

/* How much of a layer a particle is, such that layers a spacing apart, wherever they are, are one
 * together. */
PBF_FN double wet_part(const pbf_load_scales *s, pbf_real distance) {
  return pbf_max(1 - pbf_max((double)distance, 0) / (2 * s->spacing), 0);
}

template <class Obstacles>
PBF_FN pbf_load_measure load_measure_of(const pbf_load_scales *s, const Obstacles &o, int solid) {
  pbf_load_measure m;
  for (int k = 0; k < PBF_DIM; ++k)
    m.origin[k] = solid < PBF_WALLS ? 0 : (double)o.surfaces[solid - PBF_WALLS].center.c[k];
  pbf_load_units(s->velocity, pbf_lever(o, s->periods, solid), m.units);
  return m;
}

/* A plane's part in these sums. */
struct load_numbers {
  double of[PBF_LOAD_SUMS], depth;
  bool touches;
};

PBF_FN load_numbers load_numbers_of(const pbf_load_scales *s, const pbf_load_measure &m, pbf_vec x,
                                    const pbf_load_plane &p, const load_share &share) {
  load_numbers number = {{0}, pbf_max(-(double)p.distance, 0), (double)p.distance < s->spacing};
  double r[3] = {0}, u[3] = {0};
  for (int k = 0; k < PBF_DIM; ++k) {
    u[k] = share.change[k];
    number.of[PBF_LOAD_ALONG + k] = share.along[k];
    number.of[PBF_LOAD_OPEN + k] = share.open[k];
    r[k] = (double)x.c[k] - m.origin[k];
  }
  number.of[PBF_LOAD_WET] = wet_part(s, p.distance);
  for (int k = 0; k < 3; ++k) {
    const int a = (k + 1) % 3, b = (k + 2) % 3;
    number.of[PBF_LOAD_CHANGE + k] = u[k];
    number.of[PBF_LOAD_TURN + k] = r[a] * u[b] - r[b] * u[a];
    number.of[PBF_LOAD_PLACE + k] = number.of[PBF_LOAD_WET] * r[k];
  }
  return number;
}

/* Of a force beside pushes: what is wet is counted with these. */
PBF_FN load_numbers without_wet(load_numbers number) {
  for (int k = PBF_LOAD_WET; k < PBF_LOAD_ALONG; ++k) number.of[k] = 0;
  number.depth = 0;
  return number;
}

PBF_FN bool is_none(double number) { return !(number > 0 || number < 0); }

PBF_FN load_part load_part_in(const pbf_load_measure &m, const load_numbers &number) {
  load_part part;
  for (int k = 0; k < PBF_LOAD_SUMS; ++k)
    part.of[k] =
        is_none(number.of[k]) ? pbf_wide_sum{0, 0} : pbf_wide_of(number.of[k] * m.units[k]);
  part.depth = pbf_depth_bits(number.depth);
  part.touches = number.touches;
  return part;
}

template <class Obstacles>
PBF_FN load_part load_part_of(const pbf_load_scales *s, const Obstacles &o, pbf_vec x,
                              const pbf_load_plane &p, const load_share &share) {
  const pbf_load_measure m = load_measure_of(s, o, p.solid);
  return load_part_in(m, load_numbers_of(s, m, x, p, share));
}

template <class Obstacles>
PBF_FN load_part load_part_beside(const pbf_load_scales *s, const Obstacles &o, pbf_vec x,
                                  const pbf_load_plane &p, const load_share &share) {
  const pbf_load_measure m = load_measure_of(s, o, p.solid);
  return load_part_in(m, without_wet(load_numbers_of(s, m, x, p, share)));
}

/* Most of a part is nothing. */
PBF_FN void add_numbers(pbf_load_sums *to, const pbf_load_measure &m, const load_numbers &number,
                        bool counts) {
  for (int k = 0; k < PBF_LOAD_SUMS; ++k)
    if (!is_none(number.of[k])) pbf_wide_add(&to->of[k], pbf_wide_of(number.of[k] * m.units[k]));
  to->contacts += counts;
  pbf_deepen(to, pbf_depth_bits(number.depth));
}

PBF_FN void add_part(pbf_load_sums *to, const load_part &part, bool counts) {
  for (int k = 0; k < PBF_LOAD_SUMS; ++k) pbf_wide_add(&to->of[k], part.of[k]);
  to->contacts += counts;
  pbf_deepen(to, part.depth);
}

}  // namespace

#endif
