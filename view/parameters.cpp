#include "parameters.h"

#include <cstddef>

namespace view {

// The column `type` of params.def.
#define VIEW_NUMBER \
  Parameter::Kind::number, {}
#define VIEW_ONE_OF(...) \
  Parameter::Kind::one_of, { __VA_ARGS__ }
#define VIEW_SOME_OF(...) \
  Parameter::Kind::some_of, { __VA_ARGS__ }

namespace {

using Kind = Parameter::Kind;

Parameter whole(const char *name, size_t offset, uint32_t least, uint32_t most, Kind kind,
                std::vector<const char *> names, const char *doc) {
  return {kind, name, offset, 1, least, most, 0, 0, std::move(names), "", doc};
}

Parameter real(const char *name, size_t offset, unsigned count, double low, double high,
               const char *unit, const char *doc) {
  return {
      count > 1 ? Kind::reals : Kind::real, name, offset, count, 0, 0, low, high, {}, unit, doc};
}

}  // namespace

const std::vector<Parameter> &parameters() {
  static const std::vector<Parameter> all = {
#define PBF_PARAM_INTEGER(at, name, initial, type, min, max, hint, when, feature, doc) \
  whole(#name, offsetof(pbf_params, name), min, max, VIEW_##type, doc),
#define PBF_PARAM_REAL(at, name, initial, range, when, min_solver, low, high, usual, feature, \
                       projected, unit, doc)                                                  \
  real(#name, offsetof(pbf_params, name), 1, low, high, unit, doc),
#define PBF_PARAM_REALS(at, name, count, initial, low, high, projected, unit, doc) \
  real(#name, offsetof(pbf_params, name), count, low, high, unit, doc),
#include "physics/params.def"
  };
  return all;
}

}  // namespace view
