/* The emulated device by itself: what barriers, warps and launches do as CUDA says, and that what
 * CUDA leaves undefined is told. Prints what is wrong; returns how much. */
#include <cooperative_groups.h>

#include <vector>

namespace {

int wrong;

void expect(bool holds, const char *what) {
  if (holds) return;
  printf("wrong: %s\n", what);
  ++wrong;
}

unsigned *device_words(size_t count) {
  unsigned *words = nullptr;
  expect(cudaMalloc(&words, count * sizeof *words) == cudaSuccess, "cudaMalloc");
  return words;
}

std::vector<unsigned> words_of(const unsigned *words, size_t count) {
  std::vector<unsigned> copy(count);
  expect(
      cudaMemcpy(copy.data(), words, count * sizeof *words, cudaMemcpyDeviceToHost) == cudaSuccess,
      "cudaMemcpy");
  return copy;
}

/* Each thread reads what another of its block has written before the barrier. */
void mirror_kernel(unsigned *out) {
  unsigned *shared = static_cast<unsigned *>(emulated::dynamic_shared());
  shared[threadIdx.x] = 1000 * blockIdx.x + threadIdx.x;
  __syncthreads();
  out[blockIdx.x * blockDim.x + threadIdx.x] = shared[blockDim.x - 1 - threadIdx.x];
}

void warp_shapes_kernel(unsigned *out) {
  const unsigned lane = threadIdx.x % 32;
  const unsigned even = __ballot_sync(~0u, lane % 2 == 0), least = __reduce_min_sync(~0u, lane + 7);
  const unsigned before = __shfl_up_sync(~0u, lane, 1);
  unsigned active = 0;
  if (lane < 4) active = __activemask();
  const unsigned alike = __match_any_sync(~0u, lane / 8);
  __syncwarp();
  if (lane != 3) return;
  unsigned *row = out + threadIdx.x / 32 * 5;
  row[0] = even;
  row[1] = least;
  row[2] = before;
  row[3] = active;
  row[4] = alike;
}

/* The first half of the threads alone comes to the barrier. */
void parted_kernel(unsigned *out) {
  if (threadIdx.x < 32)
    out[threadIdx.x] = (unsigned)__syncthreads_count(1);
  else
    __syncthreads_or(1);
}

void cluster_kernel(unsigned *out) {
  unsigned *shared = static_cast<unsigned *>(emulated::dynamic_shared());
  auto cluster = cooperative_groups::this_cluster();
  if (threadIdx.x == 0) shared[0] = 10 * blockIdx.x;
  cluster.sync();
  if (threadIdx.x == 0)
    out[blockIdx.x] = *cluster.map_shared_rank(shared, (blockIdx.x + 1) % gridDim.x);
  cluster.sync();
}

void test_blocks() {
  unsigned *out = device_words(256);
  emulated::launch("mirror_kernel", mirror_kernel, 4, 64, 64 * sizeof(unsigned))(out);
  expect(cudaGetLastError() == cudaSuccess, "a launch");
  const auto words = words_of(out, 256);
  for (unsigned k = 0; k < 256; ++k)
    expect(words[k] == 1000 * (k / 64) + 63 - k % 64, "a block reads what it wrote");
  cudaFree(out);
}

void test_warps() {
  unsigned *out = device_words(10);
  emulated::launch("warp_shapes_kernel", warp_shapes_kernel, 1, 64)(out);
  const auto words = words_of(out, 10);
  for (unsigned row = 0; row < 10; row += 5) {
    expect(words[row] == 0x55555555u, "a ballot");
    expect(words[row + 1] == 7, "the least of the lanes");
    expect(words[row + 2] == 2, "the lane before");
    expect((words[row + 3] & ~15u) == 0 && words[row + 3] >> 3 & 1, "active lanes");
    expect(words[row + 4] == 0xffu, "lanes alike");
  }
  cudaFree(out);
}

void test_ended_lanes() {
  unsigned *out = device_words(5);
  auto kernel = +[](unsigned *to) {
    if (threadIdx.x >= 16) return;
    const unsigned lanes = __ballot_sync(~0u, 1), all = (unsigned)__syncthreads_count(1);
    if (threadIdx.x == 0) to[0] = lanes, to[1] = all;
  };
  emulated::launch("kernel", kernel, 1, 40)(out);
  const auto words = words_of(out, 2);
  expect(words[0] == 0xffffu, "lanes that have ended are not asked");
  expect(words[1] == 16, "threads that have ended are not waited for");
  cudaFree(out);
}

void test_clusters() {
  unsigned *out = device_words(4);
  cudaLaunchAttribute attribute = {cudaLaunchAttributeClusterDimension, {{4, 1, 1}}};
  cudaLaunchConfig_t config = {4, 64, 64, nullptr, &attribute, 1};
  expect(cudaLaunchKernelEx(&config, cluster_kernel, out) == cudaSuccess, "a cluster");
  const auto words = words_of(out, 4);
  for (unsigned k = 0; k < 4; ++k) expect(words[k] == 10 * ((k + 1) % 4), "another block's memory");
  cudaFree(out);
}

void expect_refusal(dim3 grid, dim3 block, size_t shared, cudaError_t error, const char *what) {
  emulated::launch("mirror_kernel", mirror_kernel, grid, block, shared)(nullptr);
  expect(cudaGetLastError() == error, what);
}

void test_refusals() {
  expect_refusal(0, 64, 0, cudaErrorInvalidConfiguration, "a grid without a block is refused");
  expect_refusal(1, 1025, 0, cudaErrorInvalidConfiguration, "a block too large is refused");
  expect_refusal(1, 64, 100000, cudaErrorInvalidValue, "shared memory not asked for is refused");
  unsigned *out = nullptr;
  void *arguments[] = {&out};
  expect(cudaLaunchCooperativeKernel(mirror_kernel, dim3(100000), dim3(64), arguments, 0,
                                     nullptr) == cudaErrorCooperativeLaunchTooLarge,
         "blocks that are not resident together are refused");
  cudaGetLastError();
}

/* The device is lost after it. */
void test_undefined() {
  unsigned *out = device_words(64);
  emulated::launch("parted_kernel", parted_kernel, 1, 64)(out);
  expect(cudaStreamSynchronize(nullptr) == cudaErrorLaunchFailure, "different barriers are told");
}

/* Nor may a kernel that is launched early read anything before it has awaited. The device is lost,
 * too. */
void test_early() {
  unsigned *out = device_words(256);
  cudaLaunchAttribute attribute = {cudaLaunchAttributeProgrammaticStreamSerialization, {}};
  cudaLaunchConfig_t config = {4, 64, 64 * sizeof(unsigned), nullptr, &attribute, 1};
  attribute.val.programmaticStreamSerializationAllowed = 1;
  cudaLaunchKernelEx(&config, mirror_kernel, out);
  expect(cudaStreamSynchronize(nullptr) == cudaErrorLaunchFailure, "early kernels await others");
}

}  // namespace

int main(int count, char **) {
  if (count > 1) {
    test_early();
    return wrong;
  }
  test_blocks();
  test_warps();
  test_ended_lanes();
  test_clusters();
  test_refusals();
  test_undefined();
  return wrong;
}
