/* What a slider for a parameter needs to know, by physics/params.def. */
#ifndef PBF_VIEW_PARAMETERS_H
#define PBF_VIEW_PARAMETERS_H

#include <pbf/pbf.h>

#include <cstddef>
#include <vector>

namespace view {

struct Parameter {
  enum class Kind { number, one_of, some_of, real, reals } kind;
  const char *name;
  size_t offset;
  unsigned count;                   // of reals: 3, one an axis, or 6, one a wall
  uint32_t least, most;             // of numbers
  double low, high;                 // of reals: between which fluids are made
  std::vector<const char *> names;  // one_of: of 0, 1, …; some_of: of the bits
  const char *unit, *doc;
};

const std::vector<Parameter> &parameters();

template <typename T>
T &value_of(pbf_params &params, const Parameter &parameter) {
  return *reinterpret_cast<T *>(reinterpret_cast<char *>(&params) + parameter.offset);
}

}  // namespace view

#endif
