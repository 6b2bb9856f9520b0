/* Ranges by which profilers name what the host does (NVTX): a call of steps, and in it the stages.
 * Where no profiler has asked for them they cost a look at a number. */
#ifndef PBF_CUDA_RANGES_H
#define PBF_CUDA_RANGES_H

/* Begins with its life, and ends with it, in one thread. The name is copied. */
class pbf_cuda_range {
 public:
  explicit pbf_cuda_range(const char *name);
  ~pbf_cuda_range();
  pbf_cuda_range(const pbf_cuda_range &) = delete;
  pbf_cuda_range &operator=(const pbf_cuda_range &) = delete;

 private:
  bool begun_;
};

#endif
