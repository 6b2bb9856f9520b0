#include "core/npy.h"

#include <cerrno>
#include <cstring>
#include <fstream>

#include "core/error.h"

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
  const std::string header = npy_header(rows, columns, element_size);
  std::ofstream file(path, std::ios::binary);
  file.write(header.data(), static_cast<std::streamsize>(header.size()));
  file.write(static_cast<const char *>(data),
             static_cast<std::streamsize>(rows * (columns > 0 ? columns : 1) * element_size));
  file.close();
  if (!file) throw Error(exit_failure, path + " can't be written: " + std::strerror(errno));
}

}  // namespace bench
