/* The CSV of a run: one row a step. */
#ifndef PBF_BENCH_TRACE_H
#define PBF_BENCH_TRACE_H

#include <pbf/pbf.h>

#include <memory>
#include <string>

#include "core/output_file.h"

namespace bench {

// Lines for standard formats; numbers have as many digits as tell them apart.
std::string trace_header();
std::string trace_row(const pbf_info &info, const pbf_stats &stats);

// A CSV file, which may be read while it grows; "-" is standard output.
class Trace {
 public:
  explicit Trace(const std::string &path);
  void add(const pbf_info &info, const pbf_stats &stats);
  void finish();

 private:
  void write(const std::string &line);
  void check_output() const;
  void cut_to_whole_rows();

  std::string path_;
  std::unique_ptr<OutputFile> file_;  // null: standard output
};

}  // namespace bench

#endif
