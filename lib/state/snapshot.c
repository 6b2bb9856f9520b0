#include "snapshot.h"

#include "solver/colliders.h"

static uint64_t padded(uint64_t size) { return (size + 7) / 8 * 8; }

uint64_t pbf_snapshot_field_bytes(const pbf_snapshot_header *header) {
  return (uint64_t)header->count * header->dimension * header->precision;
}

uint64_t pbf_snapshot_acceleration_bytes(const pbf_snapshot_header *header) {
  return (uint64_t)header->acceleration_count * header->dimension * header->precision;
}

uint64_t pbf_snapshot_kept_bytes(const pbf_snapshot_header *header, pbf_kept kept) {
  return pbf_kept_bytes(kept, header->kept, header->count, header->precision);
}

/* All factors are 32-bit: nothing here can overflow. */
pbf_snapshot_layout pbf_snapshot_layout_of(const pbf_snapshot_header *header) {
  pbf_snapshot_layout layout;
  uint64_t field = padded(pbf_snapshot_field_bytes(header));
  layout.params = padded(header->header_size);
  layout.colliders = layout.params + padded(header->params_size);
  layout.marks =
      layout.colliders + padded((uint64_t)header->collider_size * header->collider_count);
  layout.ids = layout.marks + 2 * sizeof(uint64_t) * pbf_collider_words(header->collider_count);
  layout.positions = layout.ids + (header->has_ids ? padded((uint64_t)header->count * 4) : 0);
  layout.velocities = layout.positions + field;
  uint64_t next = layout.velocities + field;
  for (int k = 0; k < PBF_KEPT_COUNT; ++k) {
    layout.kept[k] = next;
    next += padded(pbf_snapshot_kept_bytes(header, (pbf_kept)k));
  }
  layout.emission = next;
  layout.phases = next + padded(header->emission);
  layout.diffuse = layout.phases + padded(header->phases);
  layout.accelerations = layout.diffuse + padded(header->diffuse);
  layout.checksum = layout.accelerations + padded(pbf_snapshot_acceleration_bytes(header));
  layout.size = layout.checksum + 8;
  return layout;
}
