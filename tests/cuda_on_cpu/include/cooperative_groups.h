/* Of cooperative groups: a cluster, which is a whole grid here. */
#ifndef EMULATED_COOPERATIVE_GROUPS_H
#define EMULATED_COOPERATIVE_GROUPS_H

#include "device.h"

namespace cooperative_groups {

struct cluster_group {
  void sync() const { emulated::cluster_barrier(); }
  template <class T>
  T *map_shared_rank(T *at, unsigned rank) const {
    return static_cast<T *>(emulated::shared_of_block(at, rank));
  }
};

inline cluster_group this_cluster() { return {}; }

}  // namespace cooperative_groups

#endif
