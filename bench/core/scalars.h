/* Scalars of a solver's precision, as the bytes that go in and come out of it. */
#ifndef PBF_BENCH_SCALARS_H
#define PBF_BENCH_SCALARS_H

#include <cstdint>
#include <vector>

namespace bench {

using Bytes = std::vector<char>;

Bytes to_precision(const std::vector<double> &values, uint32_t precision);
std::vector<double> from_precision(const Bytes &bytes, uint32_t precision);

}  // namespace bench

#endif
