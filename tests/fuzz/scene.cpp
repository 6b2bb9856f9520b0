// Scene files and what the command line may change about them. The input is the file; behind a byte
// 0, lines follow: settings for --set, and numbers for --particles and --steps. Whatever it is, the
// reader returns a scene or throws bench::Error with one line that says why.
#include "scene/scene.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cctype>
#include <cstdint>
#include <sstream>
#include <string>

#include "core/error.h"
#include "insist.h"
#include "target.h"

namespace {

constexpr uint64_t most_filled = 20000;

void write_to_memory_file(int file, const std::string &text) {
  insist(ftruncate(file, 0) == 0);
  insist(pwrite(file, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size()));
}

uint64_t number_of(const std::string &line) {
  uint64_t number = 0;
  for (size_t i = 1; i < line.size() && i < 19; ++i) {
    if (std::isdigit(static_cast<unsigned char>(line[i])) == 0) break;
    number = 10 * number + static_cast<uint64_t>(line[i] - '0');
  }
  return number;
}

void read_options(const std::string &text, bench::SceneOptions &options) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty()) continue;
    if (line[0] == 'p') {
      options.particles = number_of(line);
    } else if (line[0] == 's') {
      options.steps = number_of(line);
    } else if (options.settings.size() < 8) {
      options.settings.push_back(line.substr(1));
    }
  }
}

// A scene that has been read can be filled, and given to a solver, which may still refuse it.
void use(const bench::Scene &scene) {
  const uint64_t count = bench::count_particles(scene);
  insist(count <= PBF_MAX_CAPACITY);
  insist(scene.steps >= 1);
  if (count > most_filled) return;
  const bench::Particles particles = bench::fill_scene(scene);
  insist(particles.count == count);
  insist(particles.positions.size() == count * scene.dimension);
  insist(particles.velocities.size() == count * scene.dimension);
}

}  // namespace

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static const int file = memfd_create("scene", MFD_CLOEXEC);
  insist(file >= 0);
  const std::string input(reinterpret_cast<const char *>(data), size);
  const auto end = input.find('\0');
  write_to_memory_file(file, input.substr(0, end));
  bench::SceneOptions options;
  options.name = "/proc/self/fd/" + std::to_string(file);
  if (end != std::string::npos) read_options(input.substr(end + 1), options);
  try {
    use(bench::load_scene(options));
  } catch (const bench::Error &error) {
    insist(error.code == bench::exit_usage);
    insist(error.what()[0] != 0);
  }
  return 0;
}
