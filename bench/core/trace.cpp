#include "core/trace.h"

#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <iostream>

#include "core/content.h"
#include "core/error.h"

namespace bench {
namespace {

std::string shortest(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return std::string(text, end);
}

}  // namespace

std::string trace_header() {
  return "step,time,com_x,com_y,com_z,kinetic_energy,max_x,max_y,max_z,density_error_mean,"
         "density_error_max,iterations\n";
}

std::string trace_row(const pbf_info &info, const pbf_stats &stats) {
  std::string row = std::to_string(info.step) + "," + shortest(info.time);
  const bool flat = info.dimension == 2;
  const double com_z = flat ? 0 : stats.center_of_mass[2];
  const double max_z = flat ? 0 : stats.position_max[2];
  for (const double value : {stats.center_of_mass[0], stats.center_of_mass[1], com_z,
                             stats.kinetic_energy, stats.position_max[0], stats.position_max[1],
                             max_z, stats.density_error_mean, stats.density_error_max}) {
    row += "," + shortest(value);
  }
  return row + "," + std::to_string(stats.iterations) + "\n";
}

Trace::Trace(const std::string &path) : path_(path) {
  if (path_ != "-") file_ = std::make_unique<OutputFile>(path_, OutputFile::as_it_goes);
  write(trace_header());
}

void Trace::add(const pbf_info &info, const pbf_stats &stats) { write(trace_row(info, stats)); }

void Trace::write(const std::string &line) {
  if (!file_) {
    std::cout << line;
    return check_output();
  }
  try {
    file_->write(line);
  } catch (const Error &) {
    cut_to_whole_rows();
    throw;
  }
}

void Trace::finish() {
  if (!file_) {
    std::cout.flush();
    return check_output();
  }
  try {
    file_->keep();
  } catch (const Error &) {
    cut_to_whole_rows();
    throw;
  }
}

void Trace::check_output() const {
  if (!std::cout) throw Error(exit_failure, path_ + " can't be written: " + std::strerror(errno));
}

// Where the disk is full, the last row ends anywhere.
void Trace::cut_to_whole_rows() {
  std::error_code failed;
  file_.reset();
  if (!std::filesystem::is_regular_file(path_, failed)) return;
  const size_t end = content_of(path_, UINTMAX_MAX).rfind('\n');
  std::filesystem::resize_file(path_, end == std::string::npos ? 0 : end + 1, failed);
}

}  // namespace bench
