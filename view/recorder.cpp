#include "recorder.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>

#include "core/error.h"
#include "core/output_file.h"
#include "report/png.h"

extern char **environ;

namespace view {
namespace {

using bench::Error;

pid_t start_ffmpeg(const std::string &path, int width, int height, double rate, int &to) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw Error(bench::exit_failure, std::strerror(errno));
  std::string size = std::to_string(width) + "x" + std::to_string(height);
  std::string pictures = std::to_string(rate);
  // Players want sides of an even number of pixels.
  const char *const words[] = {
      "ffmpeg",   "-y",         "-loglevel",  "error",
      "-f",       "rawvideo",   "-pix_fmt",   "rgb24",
      "-s",       size.c_str(), "-r",         pictures.c_str(),
      "-i",       "-",          "-vf",        "pad=ceil(iw/2)*2:ceil(ih/2)*2",
      "-pix_fmt", "yuv420p",    path.c_str(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
  pid_t child = -1;
  const int failed =
      posix_spawnp(&child, "ffmpeg", &actions, nullptr, const_cast<char *const *>(words), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[0]);
  to = ends[1];
  if (!failed) return child;
  close(ends[1]);
  throw Error(bench::exit_unavailable,
              "a video wants the program ffmpeg, which can't be started (" +
                  std::string(std::strerror(failed)) +
                  "); a folder gets a PNG file for each picture");
}

}  // namespace

Recorder::Recorder(const std::string &path, int width, int height, double rate)
    : path_(path), width_(width), height_(height) {
  if (std::filesystem::path(path).has_extension()) {
    signal(SIGPIPE, SIG_IGN);  // where ffmpeg ends, writing to it fails instead
    child_ = start_ffmpeg(path, width, height, rate, pipe_);
    return;
  }
  std::error_code failed;
  std::filesystem::create_directories(path, failed);
  if (failed) throw Error(bench::exit_failure, path + ": " + failed.message());
}

Recorder::~Recorder() {
  try {
    finish();
  } catch (const Error &) {
  }
}

void Recorder::add(const std::vector<unsigned char> &rgb) {
  if (child_ > 0) {
    for (size_t done = 0; done < rgb.size();) {
      const ssize_t now = write(pipe_, rgb.data() + done, rgb.size() - done);
      if (now < 0 && errno == EINTR) continue;
      if (now < 0) throw Error(bench::exit_failure, path_ + ": ffmpeg takes no more pictures");
      done += static_cast<size_t>(now);
    }
    return;
  }
  char name[32];
  std::snprintf(name, sizeof name, "/%06u.png", pictures_++);
  bench::write_file(path_ + name, bench::encode_png(width_, height_, rgb.data()));
}

void Recorder::finish() {
  if (child_ <= 0) return;
  close(pipe_);
  int status = 0;
  while (waitpid(child_, &status, 0) < 0 && errno == EINTR) {
  }
  child_ = -1;
  if (status != 0) throw Error(bench::exit_failure, path_ + ": ffmpeg has failed");
}

}  // namespace view
