#include "snapshot.h"

static uint64_t padded(uint64_t size) { return (size + 7) / 8 * 8; }

uint64_t pbf_snapshot_field_bytes(const pbf_snapshot_header *header) {
  return (uint64_t)header->count * header->dimension * header->precision;
}

uint64_t pbf_snapshot_sleep_bytes(const pbf_snapshot_header *header) {
  uint64_t numbers = (uint64_t)header->count * PBF_BACKEND_REST_COMPONENTS;
  return header->has_sleep_state ? numbers * header->precision : 0;
}

/* All factors are 32-bit: nothing here can overflow. */
pbf_snapshot_layout pbf_snapshot_layout_of(const pbf_snapshot_header *header) {
  pbf_snapshot_layout layout;
  uint64_t field = padded(pbf_snapshot_field_bytes(header));
  layout.params = padded(header->header_size);
  layout.colliders = layout.params + padded(header->params_size);
  layout.ids = layout.colliders + padded((uint64_t)header->collider_size * header->collider_count);
  layout.positions = layout.ids + (header->has_ids ? padded((uint64_t)header->count * 4) : 0);
  layout.velocities = layout.positions + field;
  layout.sleep_state = layout.velocities + field;
  layout.checksum = layout.sleep_state + padded(pbf_snapshot_sleep_bytes(header));
  layout.size = layout.checksum + 8;
  return layout;
}
