/* NumPy's array file format, version 1.0. */
#ifndef PBF_BENCH_NPY_H
#define PBF_BENCH_NPY_H

#include <cstdint>
#include <string>

namespace bench {

// Writes a row-major array of shape (rows, columns), or (rows) when `columns` is 0, of float32 or
// float64 (`element_size` 4 or 8).
void write_npy(const std::string &path, const void *data, uint64_t rows, uint64_t columns,
               uint32_t element_size);

}  // namespace bench

#endif
