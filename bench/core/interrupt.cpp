#include "core/interrupt.h"

#include <csignal>

namespace bench {
namespace {

volatile std::sig_atomic_t was_interrupted = 0;

void note(int) { was_interrupted = 1; }

}  // namespace

void catch_interrupts() {
  struct sigaction action = {};
  action.sa_handler = note;
  action.sa_flags = SA_RESETHAND | SA_RESTART;  // what is being written is written
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction before = {};  // of nohup, which has it ignored
  if (sigaction(SIGHUP, nullptr, &before) == 0 && before.sa_handler != SIG_IGN)
    sigaction(SIGHUP, &action, nullptr);
}

bool interrupted() { return was_interrupted != 0; }

}  // namespace bench
