/* CUDA's runtime over the emulated device: memory, streams and events. A call's work is queued in
 * its stream; without a seed it is done at once, with one as late as CUDA allows and in any order
 * of streams. */
#include "cuda_runtime_api.h"

#include <sched.h>
#include <sys/mman.h>
#include <unistd.h>

#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "cub/device/device_scan.cuh"
#include "grid.h"
#include "settings.h"

namespace emulated {

uint64_t seed() {
  static const uint64_t value = [] {
    const char *text = getenv("PBF_CUDA_EMULATED_SEED");
    return text ? strtoull(text, nullptr, 10) : 0;
  }();
  return value;
}

static int number_in(const char *name, int unset, int most) {
  const char *text = getenv(name);
  const int number = text ? atoi(text) : 0;
  return number < 1 ? unset : number < most ? number : most;
}

int multiprocessors() {
  static const int value = number_in("PBF_CUDA_EMULATED_MULTIPROCESSORS", 4, 1024);
  return value;
}

int devices() {
  static const int value = number_in("PBF_CUDA_EMULATED_DEVICES", 1, DEVICES_MOST);
  return value;
}

uint32_t random_below(uint32_t limit) {
  static thread_local uint64_t state = seed() * 0x9e3779b97f4a7c15ull + 1;
  state ^= state << 13;
  state ^= state >> 7;
  state ^= state << 17;
  return (uint32_t)((state >> 32) * limit >> 32);
}

}  // namespace emulated

using emulated::work;

/* ---- Streams and events ---------------------------------------------------------------------- */

struct event_state {
  uint64_t recorded = 0, done = 0; /* so many times */
  timespec time = {};
};
struct CUevent_st {
  std::shared_ptr<event_state> state;
};

namespace {

struct operation {
  std::unique_ptr<work> does;
  std::shared_ptr<event_state> records, waits_for;
  uint64_t turn = 0; /* of the event */
};

}  // namespace

struct CUstream_st {
  std::deque<operation> queue;
  std::thread::id caller; /* the last one */
  int device = 0;
  bool busy = false;
};

namespace {

std::recursive_mutex lock;
std::vector<cudaStream_t> streams;
CUstream_st default_stream;

thread_local cudaError_t last_error;

cudaError_t fails(cudaError_t error) { return last_error = error; }

cudaError_t tell() {
  return emulated::device_is_lost() ? fails(cudaErrorLaunchFailure) : cudaSuccess;
}

bool may_run(const CUstream_st &s) {
  if (s.busy || s.queue.empty()) return false;
  const operation &next = s.queue.front();
  return !next.waits_for || next.waits_for->done >= next.turn;
}

/* Does what is first in the queue, with the lock given back meanwhile. */
void run_first(CUstream_st *s, std::unique_lock<std::recursive_mutex> *held) {
  operation next = std::move(s->queue.front());
  s->queue.pop_front();
  if (next.does) {
    s->busy = true;
    held->unlock();
    next.does->run();
    next.does.reset();
    held->lock();
    s->busy = false;
  }
  if (next.records) {
    next.records->done = next.turn;
    clock_gettime(CLOCK_MONOTONIC, &next.records->time);
  }
}

/* One that can run: with a seed any of this thread's, else the wanted one or what it waits for. */
CUstream_st *choose(CUstream_st *wanted) {
  std::vector<CUstream_st *> able;
  if (may_run(*wanted)) {
    if (!emulated::seed()) return wanted;
    able.push_back(wanted);
  }
  for (CUstream_st *s : streams)
    if (s != wanted && s->caller == std::this_thread::get_id() && may_run(*s)) able.push_back(s);
  if (able.empty()) return nullptr;
  return able[emulated::random_below((uint32_t)able.size())];
}

/* Runs streams until there is nothing left in `s`, or `event` has come so far. */
void drain(CUstream_st *s, const event_state *event = nullptr, uint64_t turn = 0) {
  std::unique_lock<std::recursive_mutex> held(lock);
  for (;;) {
    if (event ? event->done >= turn : s->queue.empty() && !s->busy) return;
    CUstream_st *next = choose(s);
    if (next) {
      run_first(next, &held);
      continue;
    }
    held.unlock(); /* another thread has to go on */
    sched_yield();
    held.lock();
  }
}

CUstream_st *stream_of(cudaStream_t stream) { return stream ? stream : &default_stream; }

cudaError_t enqueue(cudaStream_t stream, operation next) {
  CUstream_st *s = stream_of(stream);
  {
    std::lock_guard<std::recursive_mutex> held(lock);
    s->caller = std::this_thread::get_id();
    s->queue.push_back(std::move(next));
  }
  if (!emulated::seed() || !stream) drain(s);
  return tell();
}

void drain_all() {
  std::vector<CUstream_st *> own;
  {
    std::lock_guard<std::recursive_mutex> held(lock);
    for (CUstream_st *s : streams)
      if (s->caller == std::this_thread::get_id()) own.push_back(s);
  }
  for (CUstream_st *s : own) drain(s);
}

}  // namespace

namespace emulated {

cudaError_t run_on(cudaStream_t stream, work *work) {
  operation next;
  next.does.reset(work);
  return enqueue(stream, std::move(next));
}

}  // namespace emulated

cudaError_t cudaStreamCreate(cudaStream_t *stream) {
  std::lock_guard<std::recursive_mutex> held(lock);
  *stream = new CUstream_st;
  cudaGetDevice(&(*stream)->device);
  streams.push_back(*stream);
  return tell();
}
cudaError_t cudaStreamCreateWithFlags(cudaStream_t *stream, unsigned) {
  return cudaStreamCreate(stream);
}
cudaError_t cudaStreamCreateWithPriority(cudaStream_t *stream, unsigned, int) {
  return cudaStreamCreate(stream);
}
cudaError_t cudaDeviceGetStreamPriorityRange(int *least, int *greatest) {
  *least = 0;
  *greatest = -5;
  return cudaSuccess;
}
cudaError_t cudaStreamDestroy(cudaStream_t stream) {
  drain(stream);
  std::lock_guard<std::recursive_mutex> held(lock);
  for (size_t k = 0; k < streams.size(); ++k)
    if (streams[k] == stream) {
      streams.erase(streams.begin() + (ptrdiff_t)k);
      delete stream;
      return tell();
    }
  return fails(cudaErrorInvalidResourceHandle);
}
cudaError_t cudaStreamSynchronize(cudaStream_t stream) {
  drain(stream_of(stream));
  return tell();
}
cudaError_t cudaStreamQuery(cudaStream_t stream) {
  std::unique_lock<std::recursive_mutex> held(lock);
  CUstream_st *s = stream_of(stream);
  if (may_run(*s)) run_first(s, &held);
  if (!s->queue.empty() || s->busy) return fails(cudaErrorNotReady);
  return tell();
}

cudaError_t cudaEventCreate(cudaEvent_t *event) {
  *event = new CUevent_st{std::make_shared<event_state>()};
  return tell();
}
cudaError_t cudaEventCreateWithFlags(cudaEvent_t *event, unsigned) {
  return cudaEventCreate(event);
}
cudaError_t cudaEventDestroy(cudaEvent_t event) {
  delete event;
  return tell();
}
cudaError_t cudaEventRecord(cudaEvent_t event, cudaStream_t stream) {
  operation next;
  next.records = event->state;
  {
    std::lock_guard<std::recursive_mutex> held(lock);
    next.turn = ++event->state->recorded;
  }
  return enqueue(stream, std::move(next));
}
cudaError_t cudaStreamWaitEvent(cudaStream_t stream, cudaEvent_t event, unsigned) {
  operation next;
  next.waits_for = event->state;
  {
    std::lock_guard<std::recursive_mutex> held(lock);
    next.turn = event->state->recorded;
  }
  return enqueue(stream, std::move(next));
}
cudaError_t cudaEventSynchronize(cudaEvent_t event) {
  drain(&default_stream, event->state.get(), event->state->recorded);
  return tell();
}
cudaError_t cudaEventElapsedTime(float *milliseconds, cudaEvent_t begin, cudaEvent_t end) {
  const timespec a = begin->state->time, b = end->state->time;
  *milliseconds =
      (float)((double)(b.tv_sec - a.tv_sec) * 1e3 + (double)(b.tv_nsec - a.tv_nsec) * 1e-6);
  return tell();
}

/* ---- Memory -------------------------------------------------------------------------------- */

namespace {

enum : size_t { GRANULE = 256, PAGE = 4096, POISONED_MOST = 64u << 20, DEVICE_MEMORY = 4ull << 30 };
enum { GUARDED_MOST = 8192 };

/* That of the device ends before a page that nothing may touch, as far as there are such. */
struct allocation {
  char *mapping; /* null: of malloc */
  size_t mapped, bytes;
};
std::map<char *, allocation> device_memory, host_memory;
size_t device_bytes;

char *take_guarded(size_t bytes, allocation *a) {
  a->mapped = (bytes + PAGE - 1) / PAGE * PAGE + PAGE;
  void *mapping = mmap(nullptr, a->mapped, PROT_READ | PROT_WRITE,
                       MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (mapping == MAP_FAILED) return nullptr;
  a->mapping = static_cast<char *>(mapping);
  mprotect(a->mapping + a->mapped - PAGE, PAGE, PROT_NONE);
  return a->mapping + a->mapped - PAGE - bytes;
}

/* The allocation that this is in; the end: it is in none. */
typedef std::map<char *, allocation> allocations;
allocations::const_iterator allocation_around(const allocations &memory, const void *at) {
  char *place = static_cast<char *>(const_cast<void *>(at));
  auto next = memory.upper_bound(place);
  if (next == memory.begin()) return memory.end();
  --next;
  return place < next->first + next->second.bytes ? next : memory.end();
}

/* Whether a call's memory is the device's or the page-locked of the host. */
bool is_known(const void *at) {
  return allocation_around(device_memory, at) != device_memory.end() ||
         allocation_around(host_memory, at) != host_memory.end();
}

}  // namespace

cudaError_t cudaMalloc(void **memory, size_t bytes) {
  std::lock_guard<std::recursive_mutex> held(lock);
  allocation a = {};
  a.bytes = (bytes + GRANULE - 1) / GRANULE * GRANULE;
  *memory = nullptr;
  if (emulated::device_is_lost()) return fails(cudaErrorLaunchFailure);
  if (!bytes) return cudaSuccess;
  if (a.bytes > DEVICE_MEMORY || device_bytes + a.bytes > DEVICE_MEMORY)
    return fails(cudaErrorMemoryAllocation);
  char *at = device_memory.size() < GUARDED_MOST
                 ? take_guarded(a.bytes, &a)
                 : static_cast<char *>(aligned_alloc(GRANULE, a.bytes));
  if (!at) return fails(cudaErrorMemoryAllocation);
  memset(at, 0xff, a.bytes < POISONED_MOST ? a.bytes : POISONED_MOST);
  device_bytes += a.bytes;
  device_memory[at] = a;
  *memory = at;
  return cudaSuccess;
}

/* It waits for what the device has to do. */
cudaError_t cudaFree(void *memory) {
  if (!memory) return tell();
  drain_all();
  std::lock_guard<std::recursive_mutex> held(lock);
  auto found = device_memory.find(static_cast<char *>(memory));
  if (found == device_memory.end()) return fails(cudaErrorInvalidValue);
  device_bytes -= found->second.bytes;
  if (found->second.mapping)
    munmap(found->second.mapping, found->second.mapped);
  else
    free(memory);
  device_memory.erase(found);
  return tell();
}

cudaError_t cudaHostAlloc(void **memory, size_t bytes, unsigned) {
  std::lock_guard<std::recursive_mutex> held(lock);
  *memory = malloc(bytes);
  if (!*memory) return fails(cudaErrorMemoryAllocation);
  host_memory[static_cast<char *>(*memory)] = {nullptr, 0, bytes};
  return tell();
}

cudaError_t cudaFreeHost(void *memory) {
  drain_all();
  std::lock_guard<std::recursive_mutex> held(lock);
  host_memory.erase(static_cast<char *>(memory));
  free(memory);
  return tell();
}

cudaError_t cudaPointerGetAttributes(cudaPointerAttributes *attributes, const void *memory) {
  std::lock_guard<std::recursive_mutex> held(lock);
  attributes->type = cudaMemoryTypeUnregistered;
  if (allocation_around(host_memory, memory) != host_memory.end())
    attributes->type = cudaMemoryTypeHost;
  if (allocation_around(device_memory, memory) != device_memory.end())
    attributes->type = cudaMemoryTypeDevice;
  cudaGetDevice(&attributes->device);
  return tell();
}

cudaError_t cudaHostGetDevicePointer(void **device, void *host, unsigned) {
  *device = host;
  return tell();
}

namespace {

/* From memory that the system may swap out, the call takes a copy; to such, it waits. */
struct copy_work : work {
  void *to;
  const void *from;
  size_t bytes;
  std::vector<char> taken;

  copy_work(void *to, const void *from, size_t bytes, bool takes)
      : to(to), from(from), bytes(bytes) {
    if (!takes) return;
    taken.assign(static_cast<const char *>(from), static_cast<const char *>(from) + bytes);
    this->from = taken.data();
  }
  void run() override { memmove(to, from, bytes); }
};

struct set_work : work {
  void *to;
  int value;
  size_t bytes;

  set_work(void *to, int value, size_t bytes) : to(to), value(value), bytes(bytes) {}
  void run() override { memset(to, value, bytes); }
};

}  // namespace

cudaError_t cudaMemcpyAsync(void *to, const void *from, size_t bytes, cudaMemcpyKind kind,
                            cudaStream_t stream) {
  bool from_known, to_known;
  if (!bytes) return tell();
  {
    std::lock_guard<std::recursive_mutex> held(lock);
    from_known = is_known(from);
    to_known = is_known(to);
  }
  if ((kind != cudaMemcpyHostToDevice && !from_known) ||
      (kind != cudaMemcpyDeviceToHost && !to_known))
    return fails(cudaErrorInvalidValue);
  const cudaError_t error =
      emulated::run_on(stream, new copy_work(to, from, bytes, emulated::seed() && !from_known));
  if (!to_known) drain(stream_of(stream));
  return error ? error : tell();
}

cudaError_t cudaMemcpy(void *to, const void *from, size_t bytes, cudaMemcpyKind kind) {
  const cudaError_t error = cudaMemcpyAsync(to, from, bytes, kind, nullptr);
  return error ? error : cudaStreamSynchronize(nullptr);
}

cudaError_t cudaMemsetAsync(void *to, int value, size_t bytes, cudaStream_t stream) {
  if (!bytes) return tell();
  {
    std::lock_guard<std::recursive_mutex> held(lock);
    if (!is_known(to)) return fails(cudaErrorInvalidValue);
  }
  return emulated::run_on(stream, new set_work(to, value, bytes));
}

cudaError_t cudaMemcpy2DAsync(void *to, size_t to_pitch, const void *from, size_t from_pitch,
                              size_t width, size_t height, cudaMemcpyKind kind,
                              cudaStream_t stream) {
  for (size_t row = 0; row < height; ++row)
    if (cudaError_t error = cudaMemcpyAsync(static_cast<char *>(to) + row * to_pitch,
                                            static_cast<const char *>(from) + row * from_pitch,
                                            width, kind, stream))
      return error;
  return cudaSuccess;
}

/* ---- What tests do as a caller with work of its own ---------------------------------------- */

extern "C" __attribute__((visibility("default"))) void *pbf_emulated_take(size_t bytes) {
  void *memory = nullptr;
  return cudaMalloc(&memory, bytes) == cudaSuccess ? memory : nullptr;
}
extern "C" __attribute__((visibility("default"))) void pbf_emulated_give_back(void *memory) {
  cudaFree(memory);
}
extern "C" __attribute__((visibility("default"))) void pbf_emulated_copy(void *to, const void *from,
                                                                         size_t bytes,
                                                                         cudaStream_t stream) {
  cudaMemcpyAsync(to, from, bytes, is_known(to) ? cudaMemcpyHostToDevice : cudaMemcpyDeviceToHost,
                  stream);
}
extern "C" __attribute__((visibility("default"))) cudaStream_t pbf_emulated_create_stream() {
  cudaStream_t stream = nullptr;
  cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking);
  return stream;
}
extern "C" __attribute__((visibility("default"))) void pbf_emulated_wait(cudaStream_t stream) {
  cudaStreamSynchronize(stream);
}
extern "C" __attribute__((visibility("default"))) void pbf_emulated_destroy_stream(
    cudaStream_t stream) {
  cudaStreamDestroy(stream);
}

/* ---- Launches ------------------------------------------------------------------------------ */

namespace {

struct allowed {
  size_t shared = emulated::SHARED_UNASKED;
  bool large_clusters = false;
};
std::map<const void *, allowed> kernels;

}  // namespace

namespace emulated {

cudaError_t set_attribute(const void *kernel, cudaFuncAttribute attribute, int value) {
  std::lock_guard<std::recursive_mutex> held(lock);
  if (attribute == cudaFuncAttributeNonPortableClusterSizeAllowed) {
    kernels[kernel].large_clusters = value != 0;
    return tell();
  }
  if (value < 0 || value > SHARED_MOST) return fails(cudaErrorInvalidValue);
  kernels[kernel].shared = (size_t)value;
  return tell();
}

cudaError_t occupancy(int *clusters, const void *, const cudaLaunchConfig_t *config) {
  *clusters =
      config->gridDim.x <= (unsigned)multiprocessors() && config->dynamicSmemBytes <= SHARED_MOST;
  return cudaSuccess;
}

/* Blocks of the grid that all multiprocessors hold together. */
static uint32_t most_blocks(const launch_shape &shape) {
  const uint32_t threads = shape.block.x * shape.block.y * shape.block.z;
  uint32_t each = 2048 / threads;
  if (shape.shared) {
    const uint32_t by_shared = (uint32_t)(SHARED_OF_MULTIPROCESSOR / (shape.shared + 1024));
    each = by_shared < each ? by_shared : each;
  }
  return each * (uint32_t)multiprocessors();
}

static cudaError_t refusal_of(const launch_shape &shape) {
  const uint64_t blocks = (uint64_t)shape.grid.x * shape.grid.y * shape.grid.z;
  const uint64_t threads = (uint64_t)shape.block.x * shape.block.y * shape.block.z;
  if (!blocks || !threads || threads > 1024) return cudaErrorInvalidConfiguration;
  std::lock_guard<std::recursive_mutex> held(lock);
  if (shape.shared > kernels[shape.kernel].shared) return cudaErrorInvalidValue;
  if (shape.together && strstr(shape.name, "cluster"))
    return blocks <= (kernels[shape.kernel].large_clusters ? 16 : 8)
               ? cudaSuccess
               : cudaErrorInvalidConfiguration;
  if (shape.together && blocks > most_blocks(shape)) return cudaErrorCooperativeLaunchTooLarge;
  return cudaSuccess;
}

cudaError_t launch_on(cudaStream_t stream, const launch_shape &shape, work *work) {
  const cudaError_t error = refusal_of(shape);
  if (!error) return run_on(stream, work);
  delete work;
  return fails(error);
}

}  // namespace emulated

/* ---- Devices ------------------------------------------------------------------------------- */

cudaError_t cudaGetLastError() {
  const cudaError_t error = last_error;
  last_error = cudaSuccess;
  return error ? error : tell();
}
cudaError_t cudaPeekAtLastError() { return last_error; }

const char *cudaGetErrorName(cudaError_t error) {
  switch (error) {
    case cudaSuccess:
      return "cudaSuccess";
    case cudaErrorInvalidValue:
      return "cudaErrorInvalidValue";
    case cudaErrorMemoryAllocation:
      return "cudaErrorMemoryAllocation";
    case cudaErrorInvalidConfiguration:
      return "cudaErrorInvalidConfiguration";
    case cudaErrorInvalidDevice:
      return "cudaErrorInvalidDevice";
    case cudaErrorInvalidResourceHandle:
      return "cudaErrorInvalidResourceHandle";
    case cudaErrorNotReady:
      return "cudaErrorNotReady";
    case cudaErrorLaunchFailure:
      return "cudaErrorLaunchFailure";
    case cudaErrorCooperativeLaunchTooLarge:
      return "cudaErrorCooperativeLaunchTooLarge";
    case cudaErrorNotSupported:
      return "cudaErrorNotSupported";
    default:
      return "another error";
  }
}
const char *cudaGetErrorString(cudaError_t error) { return cudaGetErrorName(error); }

cudaError_t cudaDriverGetVersion(int *version) {
  *version = CUDART_VERSION;
  return cudaSuccess;
}
cudaError_t cudaGetDeviceCount(int *count) {
  *count = emulated::devices();
  return cudaSuccess;
}

namespace {

/* A device has one context, which the driver's functions hand out. */
char contexts[emulated::DEVICES_MOST];
thread_local void *current_context;

}  // namespace

cudaError_t cudaGetDevice(int *device) {
  *device = current_context ? (int)(static_cast<char *>(current_context) - contexts) : 0;
  return tell();
}
cudaError_t cudaSetDevice(int device) {
  if (device < 0 || device >= emulated::devices()) return fails(cudaErrorInvalidDevice);
  current_context = contexts + device;
  return tell();
}

cudaError_t cudaGetDeviceProperties(cudaDeviceProp *properties, int device) {
  if (device < 0 || device >= emulated::devices()) return fails(cudaErrorInvalidDevice);
  memset(properties, 0, sizeof *properties);
  snprintf(properties->name, sizeof properties->name, "emulated on a CPU");
  memcpy(properties->uuid.bytes, "emulated on CPU", sizeof properties->uuid.bytes);
  properties->uuid.bytes[15] = (char)device;
  properties->major = 9;
  properties->multiProcessorCount = emulated::multiprocessors();
  properties->sharedMemPerBlock = emulated::SHARED_UNASKED;
  properties->sharedMemPerBlockOptin = emulated::SHARED_MOST;
  return cudaSuccess;
}
cudaError_t cudaDeviceGetAttribute(int *value, cudaDeviceAttr attribute, int) {
  *value = attribute == cudaDevAttrClusterLaunch;
  return cudaSuccess;
}
cudaError_t cudaDeviceCanAccessPeer(int *can, int, int) {
  *can = 1;
  return cudaSuccess;
}
cudaError_t cudaDeviceEnablePeerAccess(int, unsigned) { return tell(); }

cudaError_t cudaIpcGetMemHandle(cudaIpcMemHandle_t *, void *) {
  return fails(cudaErrorNotSupported);
}
cudaError_t cudaIpcOpenMemHandle(void **, cudaIpcMemHandle_t, unsigned) {
  return fails(cudaErrorNotSupported);
}
cudaError_t cudaIpcCloseMemHandle(void *) { return fails(cudaErrorNotSupported); }

/* Of the driver, what the backend keeps a caller's context by. */
namespace {

int get_current(void **context) {
  *context = current_context;
  return 0;
}
int set_current(void *context) {
  current_context = context;
  return 0;
}
int stream_context(void *stream, void **context) {
  *context = contexts + static_cast<CUstream_st *>(stream)->device;
  return 0;
}
int address_range(unsigned long long *base, size_t *bytes, unsigned long long address) {
  std::lock_guard<std::recursive_mutex> held(lock);
  const auto found = allocation_around(device_memory, reinterpret_cast<const void *>(address));
  if (found == device_memory.end()) return 1;
  *base = reinterpret_cast<uintptr_t>(found->first);
  *bytes = found->second.bytes;
  return 0;
}

}  // namespace

cudaError_t cudaGetDriverEntryPointByVersion(const char *name, void **function, unsigned,
                                             unsigned long long,
                                             cudaDriverEntryPointQueryResult *result) {
  const struct {
    const char *name;
    void *function;
  } functions[] = {{"cuCtxGetCurrent", reinterpret_cast<void *>(get_current)},
                   {"cuCtxSetCurrent", reinterpret_cast<void *>(set_current)},
                   {"cuStreamGetCtx", reinterpret_cast<void *>(stream_context)},
                   {"cuMemGetAddressRange", reinterpret_cast<void *>(address_range)}};
  *function = nullptr;
  *result = cudaDriverEntryPointSuccess;
  for (const auto &f : functions)
    if (strcmp(f.name, name) == 0) *function = f.function;
  return *function ? cudaSuccess : fails(cudaErrorSymbolNotFound);
}
