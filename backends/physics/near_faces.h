/* Part of near_planes.h: the faces near a place, and what they leave of edges and of each other.
 *
 * Beside the end of a box its nearest point is on an edge, and the plane through that is askew to
 * both faces. Of a wall made of flush boxes those beside the one before a particle would each
 * contribute such a plane, and none of them is there. But the edge lies in the wall's plane. So an
 * edge counts as far as it rises from the faces nearer than itself, in parts of what it would rise
 * were its plane at right angles to theirs.
 *
 * So it is with round solids that reach into each other, as a bank made of balls: each is nearest
 * to a particle somewhere, mostly inside of others. Curved faces count as far as they rise from
 * those nearer than themselves, and flat ones as far as they rise from curved ones. */
#ifndef PBF_PHYSICS_NEAR_FACES_H
#define PBF_PHYSICS_NEAR_FACES_H

#include "physics/constants.h"

/* More than the inside of a box has; of more the nearest ones. */
enum { PBF_NEAR_FACES = 8 };

typedef struct pbf_near_face {
  pbf_vec normal;
  pbf_real distance;
  int is_unbounded; /* all behind it is solid */
  int solid;        /* the number that visitors have for it */
  int is_curved;
  pbf_real part; /* that nearer ones leave of it */
} pbf_near_face;

typedef struct pbf_near_faces {
  int count;
  pbf_near_face of[PBF_NEAR_FACES];
} pbf_near_faces;

/* The planes through edges of solids that are near, which count once all faces are known. GPUs,
 * where each thread would have to hold them, keep their number alone, and find them anew. */
enum { PBF_KEEPS_EDGES = !PBF_ON_GPU, PBF_NEAR_EDGES = 8 };

typedef struct pbf_near_edges {
  int count; /* of all */
  pbf_near_face of[PBF_NEAR_EDGES];
} pbf_near_edges;

PBF_FN void pbf_note_edge(const pbf_near_face *edge, pbf_near_edges *edges) {
  if (PBF_KEEPS_EDGES && edges->count < PBF_NEAR_EDGES) edges->of[edges->count] = *edge;
  edges->count += 1;
}

/* The part of an edge's plane that a face leaves, from 0 where the edge is on the face or behind
 * it, to 1 where both planes are at right angles. From places on the face, or behind it, little can
 * be told of that: distances are taken as from some way before it. What rises by rounding alone is
 * on it. Straight before an edge that rises it counts as the face that ends there. */
PBF_FN pbf_real pbf_part_before_face(const pbf_constants *c, const pbf_near_face *face,
                                     pbf_real distance, pbf_vec normal) {
  const pbf_real least = c->h / 32, rounding = (pbf_real)0x1p-9;
  const pbf_real cosine = pbf_dot(face->normal, normal);
  if (!(cosine > 0)) return 1;
  const pbf_real shift = pbf_real_max(least - face->distance, 0);
  const pbf_real before = face->distance + shift, from_edge = pbf_real_max(distance + shift, 0);
  const pbf_real rise = pbf_real_max(before * (1 - rounding) - cosine * from_edge, 0);
  const pbf_real aside2 = pbf_real_max(1 - cosine * cosine, 0) * from_edge * from_edge;
  const pbf_real part = pbf_real_min(rise / (before * (1 - rounding)), 1);
  if (!(aside2 < least * least)) return part;
  const pbf_real straight = 1 - pbf_real_sqrt(aside2) / least;
  return part + (1 - part) * straight * pbf_real_min(rise / least, 1);
}

PBF_FN_HOST_NOINLINE pbf_real pbf_part_before_faces(const pbf_constants *c,
                                                    const pbf_near_faces *faces, pbf_real distance,
                                                    pbf_vec normal) {
  pbf_real part = 1;
  for (int k = 0; k < faces->count; ++k)
    if (!faces->of[k].is_curved)
      part = pbf_real_min(part, pbf_part_before_face(c, &faces->of[k], distance, normal));
  return part;
}

/* The part of a face that the first of the others leave, where one of both is curved. What does not
 * rise from a nearer one counts as far as they face other ways, as at right angles each has all
 * behind it to itself; and what is hidden hides nothing. */
PBF_FN_HOST_NOINLINE pbf_real pbf_part_before_nearer(const pbf_constants *c,
                                                     const pbf_near_faces *faces, int first,
                                                     const pbf_near_face *face) {
  pbf_real part = 1;
  for (int k = 0; k < first; ++k) {
    const pbf_near_face *nearer = &faces->of[k];
    if (!face->is_curved && !nearer->is_curved) continue;
    const pbf_real cosine = pbf_real_max(pbf_dot(nearer->normal, face->normal), 0);
    const pbf_real rises = pbf_part_before_face(c, nearer, face->distance, face->normal);
    part = pbf_real_min(part, 1 - nearer->part * cosine * (1 - rises));
  }
  return part;
}

/* Of all faces the part that nearer ones leave. */
PBF_FN_HOST_NOINLINE void pbf_find_parts(const pbf_constants *c, pbf_near_faces *faces) {
  for (int k = 1; k < faces->count; ++k)
    faces->of[k].part = pbf_part_before_nearer(c, faces, k, &faces->of[k]);
}

/* Whether all that is behind one of two faces is behind the other, which is nearer: that of a round
 * solid as far as it is near. */
PBF_FN int pbf_is_behind_face(const pbf_near_face *face, const pbf_near_face *nearer) {
  const pbf_real cosine = pbf_dot(face->normal, nearer->normal);
  if (cosine > (pbf_real)0.999) return 1;
  return (face->is_curved || nearer->is_curved) && cosine > (pbf_real)0.9 &&
         nearer->distance < cosine * face->distance;
}

/* Puts a face among the others, nearest first, without those that lie behind others: of solids of
 * several boxes those within. */
PBF_FN_HOST_NOINLINE void pbf_put_face(const pbf_near_face *face, pbf_near_faces *faces) {
  int at = 0;
  for (; at < faces->count && faces->of[at].distance <= face->distance; ++at)
    if (pbf_is_behind_face(face, &faces->of[at])) return;
  if (at == PBF_NEAR_FACES) return;
  int kept = at;
  for (int k = at; k < faces->count; ++k)
    if (!pbf_is_behind_face(&faces->of[k], face)) faces->of[kept++] = faces->of[k];
  if (kept == PBF_NEAR_FACES) --kept;
  for (int k = kept; k > at; --k) faces->of[k] = faces->of[k - 1];
  faces->of[at] = *face;
  faces->count = kept + 1;
}

#endif
