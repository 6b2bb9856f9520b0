#include "core/scalars.h"

#include <pbf/pbf.h>

#include <algorithm>

namespace bench {

Bytes to_precision(const std::vector<double> &values, uint32_t precision) {
  Bytes bytes(values.size() * precision);
  if (precision == PBF_FLOAT64) {
    std::copy(values.begin(), values.end(), reinterpret_cast<double *>(bytes.data()));
  } else {
    std::transform(values.begin(), values.end(), reinterpret_cast<float *>(bytes.data()),
                   [](double value) { return static_cast<float>(value); });
  }
  return bytes;
}

std::vector<double> from_precision(const Bytes &bytes, uint32_t precision) {
  if (precision == PBF_FLOAT64) {
    const auto *values = reinterpret_cast<const double *>(bytes.data());
    return {values, values + bytes.size() / sizeof(double)};
  }
  const auto *values = reinterpret_cast<const float *>(bytes.data());
  return {values, values + bytes.size() / sizeof(float)};
}

}  // namespace bench
