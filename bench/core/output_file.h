/* Files that a program writes: whole, or not at all. */
#ifndef PBF_BENCH_CORE_OUTPUT_FILE_H
#define PBF_BENCH_CORE_OUTPUT_FILE_H

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <utility>

#include "core/error.h"

#if __has_include(<unistd.h>)
#include <unistd.h>
#else
#include <process.h>
#endif

namespace bench {

namespace fs = std::filesystem;

// Written beside the file that has the name, which it replaces once it is whole: where the disk is
// full the old one stays. What is no file, as a pipe, has none beside it; nor has a file in a
// folder where nothing can be made. Each failure is an Error that names the path and the reason.
class OutputFile {
 public:
  enum Way { whole, as_it_goes };  // the second for what is read meanwhile

  explicit OutputFile(const std::string &path, Way way = whole)
      : path_(path), target_(target_of(path)) {
    if (way == whole && is_replaced()) open_beside();
    if (!file_) file_ = std::fopen(path_.c_str(), "wb");
    if (!file_) refuse(errno);
  }

  OutputFile(const OutputFile &) = delete;
  OutputFile &operator=(const OutputFile &) = delete;

  // What has not been kept goes.
  ~OutputFile() {
    if (file_) std::fclose(file_);
    remove_fresh();
  }

  std::FILE *stream() const { return file_; }

  // Ends a long run at once where it can't be written.
  void check() const {
    if (std::ferror(file_)) refuse(errno ? errno : EIO);
  }

  void write(const std::string &bytes) {
    errno = 0;
    std::fwrite(bytes.data(), 1, bytes.size(), file_);
    check();
  }

  // It has its name from here on.
  void keep() {
    check();
    if (std::fclose(std::exchange(file_, nullptr)) != 0) refuse(errno);
    if (fresh_.empty()) return;
    std::error_code failed;
    const fs::file_status there = fs::status(target_, failed);
    if (fs::exists(there)) fs::permissions(fresh_, there.permissions(), failed);
    fs::rename(fresh_, target_, failed);
    if (!failed) return fresh_.clear();
    // A file that is mounted by itself, or another user's in a folder of all, is written in place.
    fs::copy_file(fresh_, target_, fs::copy_options::overwrite_existing, failed);
    if (failed) throw Error(exit_failure, path_ + " can't be written: " + failed.message());
  }

 private:
  // A link stays, also one to a file that is not there yet.
  static fs::path target_of(const std::string &path) {
    enum { most_links = 40 };  // as many as Linux follows
    std::error_code failed;
    fs::path at = path;
    for (int k = 0; k < most_links && fs::is_symlink(at, failed) && !fs::exists(at, failed); ++k)
      at = at.parent_path() / fs::read_symlink(at, failed);
    const fs::path target = fs::weakly_canonical(at, failed);
    return failed ? fs::path(path) : target;
  }

  // /dev/stdout is the file that the output goes to, in which there may be more.
  bool is_replaced() const {
    std::error_code failed;
    const fs::file_status there = fs::status(path_, failed);
    if (path_.rfind("/dev/", 0) == 0 || path_.rfind("/proc/", 0) == 0) return false;
    return there.type() == fs::file_type::not_found || there.type() == fs::file_type::regular;
  }

  void open_beside() {
#if __has_include(<unistd.h>)
    const auto process = getpid();
#else
    const auto process = _getpid();
#endif
    // What has the name may be of a process of the same number, in another container.
    int error = EEXIST;
    for (unsigned number = 0; !file_ && error == EEXIST; ++number) {
      fresh_ = target_.string() + "." + std::to_string(process) + "." + std::to_string(number);
      fresh_ += ".new";
      file_ = std::fopen(fresh_.c_str(), "wbx");
      error = errno;
    }
    if (file_) return;
    fresh_.clear();
    if (error != EACCES && error != EPERM && error != EROFS && error != ENAMETOOLONG) refuse(error);
  }

  void remove_fresh() {
    if (!fresh_.empty()) std::remove(fresh_.c_str());
  }

  [[noreturn]] void refuse(int error) const {
    throw Error(exit_failure, path_ + " can't be written: " + std::strerror(error));
  }

  std::string path_;
  fs::path target_;
  std::string fresh_;  // empty: it is written in place
  std::FILE *file_ = nullptr;
};

inline void write_file(const std::string &path, const std::string &bytes) {
  OutputFile file(path);
  file.write(bytes);
  file.keep();
}

}  // namespace bench

#endif
