/* Part of collide.h: the planes that a particle is held behind, none of which it may leave for
 * another: at most as many at once as there are dimensions, the corner of so many. */
#ifndef PBF_PHYSICS_CONTACTS_H
#define PBF_PHYSICS_CONTACTS_H

#include "physics/real.h"

/* The half-space dot(normal, x) >= offset. */
typedef struct pbf_contact {
  pbf_vec normal;
  pbf_real offset;
} pbf_contact;

typedef struct pbf_contacts {
  int count;
  pbf_contact of[PBF_DIM];
} pbf_contacts;

/* Of a plane through `at`. */
PBF_FN pbf_contact pbf_contact_at(pbf_vec at, pbf_vec normal) {
  pbf_contact contact = {normal, pbf_dot(normal, at)};
  return contact;
}

/* Negative behind the plane. */
PBF_FN pbf_real pbf_contact_gap(const pbf_contact *contact, pbf_vec x) {
  return pbf_dot(contact->normal, x) - contact->offset;
}

/* Directions at right angles to each other (Gram & Schmidt) that span the normals so far. */
typedef struct pbf_contact_span {
  int count;
  pbf_vec direction[PBF_DIM];
} pbf_contact_span;

/* Moves x to the plane along what is at right angles to all before: on these it stays. Returns 0
 * where nothing is, to a part of a thousand. */
PBF_FN int pbf_move_to_contact(const pbf_contact *contact, pbf_contact_span *span, pbf_vec *x) {
  pbf_vec across = contact->normal;
  for (int k = 0; k < span->count; ++k)
    across =
        pbf_add_scaled(across, -pbf_dot(contact->normal, span->direction[k]), span->direction[k]);
  const pbf_real across2 = pbf_dot(across, across);
  if (!(across2 > (pbf_real)1e-6)) return 0;
  *x = pbf_add_scaled(*x, -pbf_contact_gap(contact, *x) / across2, across);
  for (int k = 0; k < PBF_DIM; ++k) across.c[k] /= pbf_real_sqrt(across2);
  span->direction[span->count++] = across;
  return 1;
}

PBF_FN int pbf_bits_set(int set) {
  int count = 0;
  for (; set; set &= set - 1) ++count;
  return count;
}

/* The point nearest to x on the next plane and these of the planes held; 0 where there is none, or
 * where it is behind another one of them. */
PBF_FN int pbf_meet_contacts(const pbf_contacts *held, int these, const pbf_contact *next,
                             pbf_real rounding, pbf_vec *x) {
  pbf_contact_span span = {0, {{{0}}}};
  if (!pbf_move_to_contact(next, &span, x)) return 0;
  for (int k = 0; k < held->count; ++k)
    if (these >> k & 1 && !pbf_move_to_contact(&held->of[k], &span, x)) return 0;
  for (int k = 0; k < held->count; ++k)
    if (!(these >> k & 1) && pbf_contact_gap(&held->of[k], *x) < -rounding) return 0;
  return 1;
}

PBF_FN void pbf_keep_contacts(pbf_contacts *held, int these, const pbf_contact *next) {
  int kept = 0;
  for (int k = 0; k < held->count; ++k)
    if (these >> k & 1) held->of[kept++] = held->of[k];
  held->of[kept++] = *next;
  held->count = kept;
}

/* Moves x, which is behind one more plane, to where it is behind none: onto that plane, or to where
 * it meets those that x has been held by. So acute corners are reached at once, which one plane
 * after another come ever slower to. Where planes leave no room, the next one alone is held. */
PBF_FN void pbf_hold_by_contact(pbf_contacts *held, const pbf_contact *next, pbf_real rounding,
                                pbf_vec *x) {
  for (int size = 0; size < PBF_DIM; ++size)
    for (int these = 0; these < 1 << held->count; ++these) {
      pbf_vec y = *x;
      if (pbf_bits_set(these) != size || !pbf_meet_contacts(held, these, next, rounding, &y))
        continue;
      pbf_keep_contacts(held, these, next);
      *x = y;
      return;
    }
  pbf_keep_contacts(held, 0, next);
  *x = pbf_add_scaled(*x, -pbf_contact_gap(next, *x), next->normal);
}

#endif
