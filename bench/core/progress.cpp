#include "core/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace bench {
namespace {

std::string duration_text(double seconds) {
  char text[32];
  const int whole = static_cast<int>(std::min(seconds + 0.5, 359999.0));
  if (whole >= 3600) {
    std::snprintf(text, sizeof text, "%d:%02d h", whole / 3600, whole / 60 % 60);
  } else {
    std::snprintf(text, sizeof text, "%d:%02d min", whole / 60, whole % 60);
  }
  return text;
}

}  // namespace

Progress::Progress() : on_terminal_(isatty(STDERR_FILENO) == 1), start_(Clock::now()) {}

Progress::~Progress() {
  if (shown_) std::fputs("\r\033[K", stderr);
}

void Progress::show(double fraction, const std::string &label) {
  if (!on_terminal_) return;
  const auto now = Clock::now();
  if (shown_ && now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  shown_ = true;
  constexpr int width = 30;
  const int filled = static_cast<int>(fraction * width);
  const std::string bar = std::string(filled, '#') + std::string(width - filled, '.');
  std::string left;
  if (fraction > 0) {
    const double elapsed = std::chrono::duration<double>(now - start_).count();
    left = duration_text(elapsed * (1 - fraction) / fraction) + " left";
  }
  std::fprintf(stderr, "\r\033[K[%s] %3.0f %%  %s  %s", bar.c_str(), 100 * fraction, left.c_str(),
               label.c_str());
  std::fflush(stderr);
}

}  // namespace bench
