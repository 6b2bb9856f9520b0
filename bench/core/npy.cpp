#include "core/npy.h"

#include <cstdio>

#include "core/output_file.h"

namespace bench {
namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the header below says little-endian");

std::string npy_header(uint64_t rows, uint64_t columns, uint32_t element_size) {
  std::string dictionary = "{'descr': '<f" + std::to_string(element_size) +
                           "', 'fortran_order': False, 'shape': (" + std::to_string(rows) + "," +
                           (columns > 0 ? " " + std::to_string(columns) : "") + "), }";
  // Magic, version and length take 10 bytes; the format wants the data to start at a multiple
  // of 64.
  while ((10 + dictionary.size() + 1) % 64 != 0) dictionary += ' ';
  dictionary += '\n';
  std::string header("\x93NUMPY\x01\x00", 8);
  header += static_cast<char>(dictionary.size() & 0xff);
  header += static_cast<char>(dictionary.size() >> 8);
  return header + dictionary;
}

}  // namespace

void write_npy(const std::string &path, const void *data, uint64_t rows, uint64_t columns,
               uint32_t element_size) {
  const size_t size = rows * (columns > 0 ? columns : 1) * element_size;
  OutputFile file(path);
  file.write(npy_header(rows, columns, element_size));
  std::fwrite(data, 1, size, file.stream());
  file.keep();
}

}  // namespace bench
