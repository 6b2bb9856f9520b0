/* pbf for C++17: the calls of pbf.h, which says what each does, with lifetimes and results as C++
 * has them. Header only; works with -fno-exceptions and -fno-rtti.
 *
 *   pbf::desc desc;                                  // the defaults of pbf_desc_init
 *   pbf::params params;                              // those of pbf_params_init
 *   auto fluid = pbf::solver::create(desc, params);  // pbf::result<pbf::solver>
 *   if (!fluid) return puts(fluid.message()), 1;
 *   if (auto done = fluid->step(10); !done) puts(done.message());
 *
 * A result holds a value, or a status and the library's sentence. Where exceptions are on, value()
 * gives the value or throws pbf::exception, which has both; nothing else here throws, but for what
 * std::vector and std::function throw when memory is short.
 *
 * A solver, as in C, belongs to one thread at a time. It, views, snapshots, cancellers, a batch and
 * its worlds may go in any order: what they need stays until the last of them is gone. A call on a
 * solver that has been moved from is refused like a null pointer in C.
 *
 * No exception crosses the library: what the log throws is kept (take_log_exception), and the
 * functions of allocators and task systems are noexcept. */
#if __cplusplus < 201703L && !(defined(_MSVC_LANG) && _MSVC_LANG >= 201703L)
#error "pbf.hpp is C++17: compile by -std=c++17 or /std:c++17, or a later standard"
#define PBF_PBF_HPP /* so that nothing else is wrong */
#endif

#ifndef PBF_PBF_HPP
#define PBF_PBF_HPP

#include <atomic>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include <pbf/all.h>

#if defined(__cpp_exceptions) || defined(_CPPUNWIND)
#define PBF_HAS_EXCEPTIONS 1
#else
#define PBF_HAS_EXCEPTIONS 0
#endif

namespace pbf {

/* A pointer and a size, from an array or anything with data() and size(). */
template <class T>
class span {
 public:
  constexpr span() noexcept = default;
  constexpr span(T *data, std::size_t size) noexcept : data_(data), size_(size) {}
  template <std::size_t N>
  constexpr span(T (&array)[N]) noexcept : data_(array), size_(N) {}
  template <
      class Container, class Data = decltype(std::declval<Container &>().data()),
      class = decltype(std::declval<Container &>().size()),
      class = std::enable_if_t<std::is_convertible_v<std::remove_pointer_t<Data> (*)[], T (*)[]>>>
  constexpr span(Container &&from) noexcept : data_(from.data()), size_(from.size()) {}

  constexpr T *data() const noexcept { return data_; }
  constexpr std::size_t size() const noexcept { return size_; }
  constexpr bool empty() const noexcept { return size_ == 0; }
  constexpr T *begin() const noexcept { return data_; }
  constexpr T *end() const noexcept { return data_ + size_; }
  constexpr T &operator[](std::size_t i) const noexcept { return data_[i]; }

 private:
  T *data_ = nullptr;
  std::size_t size_ = 0;
};

/* ---- Results ------------------------------------------------------------------------------- */

/* A status and a sentence of its own: it stays as it is when later calls fail. */
class error {
 public:
  explicit error(pbf_status status, const char *sentence = pbf_last_error()) noexcept
      : status_(status), sentence_(copy(sentence)) {}
  error(const error &other) noexcept : error(other.status_, other.message()) {}
  error(error &&) noexcept = default;
  error &operator=(error other) noexcept {
    status_ = other.status_;
    sentence_ = std::move(other.sentence_);
    return *this;
  }

  pbf_status status() const noexcept { return status_; }
  const char *message() const noexcept {
    return sentence_ ? sentence_.get() : pbf_status_string(status_);
  }

 private:
  static std::unique_ptr<char[]> copy(const char *text) noexcept {
    const std::size_t size = std::strlen(text) + 1;
    std::unique_ptr<char[]> made(new (std::nothrow) char[size]);
    if (made) std::memcpy(made.get(), text, size);
    return made;
  }
  pbf_status status_;
  std::unique_ptr<char[]> sentence_;
};

#if PBF_HAS_EXCEPTIONS
class exception : public std::exception {
 public:
  explicit exception(error cause) noexcept : cause_(std::move(cause)) {}
  const char *what() const noexcept override { return cause_.message(); }
  pbf_status status() const noexcept { return cause_.status(); }

 private:
  error cause_;
};
#endif

namespace detail {

/* What results with and without a value have in common. */
class outcome {
 public:
  explicit operator bool() const noexcept { return !error_; }
  bool ok() const noexcept { return !error_; }
  pbf_status status() const noexcept { return error_ ? error_->status() : PBF_OK; }
  const char *message() const noexcept { return error_ ? error_->message() : ""; }
  /* Only of a result that is not ok. */
  const pbf::error &failure() const noexcept {
    assert(error_);
    return *error_;
  }

 protected:
  outcome() noexcept = default;
  outcome(pbf::error why) noexcept : error_(std::move(why)) {}
  void throw_failure() const {
#if PBF_HAS_EXCEPTIONS
    if (error_) throw pbf::exception(*error_);
#endif
  }

 private:
  std::optional<pbf::error> error_;
};

}  // namespace detail

template <class T>
class [[nodiscard]] result : public detail::outcome {
 public:
  result(T value) noexcept : value_(std::move(value)) {}
  result(pbf::error why) noexcept : outcome(std::move(why)) {}

  /* Only of a result that is ok. */
  T &operator*() &noexcept { return got(); }
  const T &operator*() const &noexcept { return const_cast<result *>(this)->got(); }
  T &&operator*() &&noexcept { return std::move(got()); }
  T *operator->() noexcept { return &got(); }
  const T *operator->() const noexcept { return &**this; }
#if PBF_HAS_EXCEPTIONS
  T &value() & {
    throw_failure();
    return *value_;
  }
  T value() && {
    throw_failure();
    return std::move(*value_);
  }
#endif

 private:
  T &got() noexcept {
    assert(value_);
    return *value_;
  }
  std::optional<T> value_;
};

template <>
class [[nodiscard]] result<void> : public detail::outcome {
 public:
  result() noexcept = default;
  result(pbf::error why) noexcept : outcome(std::move(why)) {}
#if PBF_HAS_EXCEPTIONS
  void value() const { throw_failure(); }
#endif
};

namespace detail {

inline result<void> checked(pbf_status status) noexcept {
  if (status == PBF_OK) return {};
  return pbf::error(status);
}

template <class T>
result<T> checked(pbf_status status, T value) noexcept {
  if (status == PBF_OK) return value;
  return pbf::error(status);
}

template <class T>
T sized() noexcept {
  T made;
  std::memset(&made, 0, sizeof made);
  made.struct_size = sizeof(T);
  return made;
}

inline std::uint32_t clamped(std::size_t size) noexcept {
  return size > UINT32_MAX ? UINT32_MAX : static_cast<std::uint32_t>(size);
}

inline error wrong_size(const char *name, std::size_t has, const char *wanted) noexcept {
  char sentence[160];
  std::snprintf(sentence, sizeof sentence, "%s has %zu elements; %s", name, has, wanted);
  return error(PBF_ERROR_INVALID_ARGUMENT, sentence);
}

}  // namespace detail

/* Of the library at run time, as MAJOR * 1000000 + MINOR * 1000 + PATCH. */
inline std::uint32_t version() noexcept { return pbf_version(); }

/* ---- What a solver is made of -------------------------------------------------------------- */

/* Host memory of a solver. It must outlive the solver, and the views and snapshots of it. */
class allocator {
 public:
  virtual void *allocate(std::uint64_t size, std::uint64_t alignment) noexcept = 0;
  virtual void release(void *memory, std::uint64_t size, std::uint64_t alignment) noexcept = 0;

 protected:
  ~allocator() = default;
};

/* Workers of the caller's for the backend `threads`; see pbf_enqueue_task_fn. Must outlive the
 * solver. */
class task_system {
 public:
  virtual void *enqueue(pbf_task_fn run, void *task, std::uint32_t items,
                        std::uint32_t min_range) noexcept = 0;
  virtual void finish(void *handle) noexcept = 0;

 protected:
  ~task_system() = default;
};

/* level is PBF_LOG_…; called from whichever thread is in the library. */
using log_function = std::function<void(int level, const char *sentence)>;

/* pbf_desc with its defaults. The pointers of C (allocator, log, enqueue_task, …) may be set as
 * well; those below go before them. */
struct desc : pbf_desc {
  desc() noexcept : pbf_desc(detail::sized<pbf_desc>()) { pbf_desc_init(this, sizeof(pbf_desc)); }

  pbf::allocator *memory = nullptr;
  pbf::task_system *tasks = nullptr;
  log_function log_to;
};

/* pbf_params with its defaults. */
struct params : pbf_params {
  params() noexcept : pbf_params(detail::sized<pbf_params>()) {
    pbf_params_init(this, sizeof(pbf_params));
  }
  params(const pbf_params &from) noexcept : pbf_params(from) {}
};

/* pbf_volume at the origin, sizes 1: a PBF_VOLUME_…, what queries ask about. */
struct volume : pbf_volume {
  explicit volume(std::uint32_t of_shape) noexcept : pbf_volume(detail::sized<pbf_volume>()) {
    pbf_volume_init(this, sizeof(pbf_volume), of_shape);
  }
  volume(const pbf_volume &from) noexcept : pbf_volume(from) {}

  static volume box(double x, double y, double z, double half_x, double half_y,
                    double half_z) noexcept {
    volume made(PBF_VOLUME_BOX);
    made.half_extents[0] = half_x, made.half_extents[1] = half_y, made.half_extents[2] = half_z;
    return made.place(x, y, z);
  }
  static volume sphere(double x, double y, double z, double r) noexcept {
    volume made(PBF_VOLUME_SPHERE);
    made.radius = r;
    return made.place(x, y, z);
  }
  /* Around a segment of that direction, half_length to each side of its middle. */
  static volume capsule(double x, double y, double z, double axis_x, double axis_y, double axis_z,
                        double half_length, double r) noexcept {
    volume made(PBF_VOLUME_CAPSULE);
    made.axis[0] = axis_x, made.axis[1] = axis_y, made.axis[2] = axis_z;
    made.half_length = half_length, made.radius = r;
    return made.place(x, y, z);
  }
  volume &place(double x, double y, double z) noexcept {
    position[0] = x, position[1] = y, position[2] = z;
    return *this;
  }
};

/* pbf_emitter at the origin, sizes 1: a PBF_EMITTER_…. */
struct emitter : pbf_emitter {
  explicit emitter(std::uint32_t of_shape) noexcept : pbf_emitter(detail::sized<pbf_emitter>()) {
    pbf_emitter_init(this, sizeof(pbf_emitter), of_shape);
  }
  emitter(const pbf_emitter &from) noexcept : pbf_emitter(from) {}

  /* Both across a stream that goes downwards at 1, until `velocity` is set. */
  static emitter disc(double x, double y, double z, double r) noexcept {
    emitter made(PBF_EMITTER_DISC);
    made.radius = r;
    return made.place(x, y, z);
  }
  static emitter rectangle(double x, double y, double z, double half_width,
                           double half_height) noexcept {
    emitter made(PBF_EMITTER_RECTANGLE);
    made.half_width = half_width, made.half_height = half_height;
    return made.place(x, y, z);
  }
  emitter &place(double x, double y, double z) noexcept {
    position[0] = x, position[1] = y, position[2] = z;
    return *this;
  }
};

/* A box in which fluid always stands equally deep, see emit.h. */
struct reservoir : pbf_reservoir {
  reservoir() noexcept : pbf_reservoir(detail::sized<pbf_reservoir>()) {
    pbf_reservoir_init(this, sizeof(pbf_reservoir));
  }
  reservoir(const pbf_reservoir &from) noexcept : pbf_reservoir(from) {}

  static reservoir box(double x, double y, double z, double half_x, double half_y, double half_z,
                       double depth) noexcept {
    reservoir made;
    made.position[0] = x, made.position[1] = y, made.position[2] = z;
    made.half_extents[0] = half_x, made.half_extents[1] = half_y, made.half_extents[2] = half_z;
    made.depth = depth;
    return made;
  }
};

/* pbf_phase of this rest density, and viscosity 1. */
struct phase : pbf_phase {
  explicit phase(double density) noexcept : pbf_phase(detail::sized<pbf_phase>()) {
    pbf_phase_init(this, sizeof(pbf_phase));
    rest_density = density;
  }
  phase(const pbf_phase &from) noexcept : pbf_phase(from) {}
};

/* Where answers at points go: a number a point, of velocities `dimension`; empty: not asked for. */
struct samples {
  span<double> densities;
  span<double> velocities;
  span<double> pressures;
  span<std::uint8_t> wet;
};

/* A shape, by a reference of its own: what has been copied from it is the same one. Each array has
 * as many dimensions as `dimension`, or another array of the same call, says. */
class shape {
 public:
  /* As many dimensions as there are numbers of nodes. */
  static result<shape> from_grid(span<const std::uint32_t> nodes, span<const double> origin,
                                 double cell, span<const float> values) noexcept {
    pbf_grid_desc desc = detail::sized<pbf_grid_desc>();
    if (nodes.size() != 2 && nodes.size() != 3)
      return detail::wrong_size("nodes", nodes.size(), "there must be 2 or 3");
    if (origin.size() != nodes.size())
      return detail::wrong_size("origin", origin.size(), "it must have as many as nodes");
    double product = 1;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      desc.nodes[k] = nodes[k], desc.origin[k] = origin[k];
      product *= nodes[k];
    }
    if (product != static_cast<double>(values.size()))
      return detail::wrong_size("values", values.size(), "it must have one for each node");
    desc.dimension = static_cast<std::uint32_t>(nodes.size());
    desc.cell = cell;
    desc.values = values.data();
    return made(pbf_shape_from_grid, desc);
  }
  static result<shape> from_mesh(std::uint32_t dimension, span<const double> vertices,
                                 span<const std::uint32_t> faces, double cell,
                                 double thickness = 0) noexcept {
    pbf_mesh_desc desc = detail::sized<pbf_mesh_desc>();
    if (!rows(vertices.size(), dimension, &desc.vertex_count))
      return detail::wrong_size("vertices", vertices.size(), "it must have dimension a vertex");
    if (!rows(faces.size(), dimension, &desc.face_count))
      return detail::wrong_size("faces", faces.size(), "it must have dimension a face");
    desc.dimension = dimension;
    desc.vertices = vertices.data();
    desc.faces = faces.data();
    desc.cell = cell;
    desc.thickness = thickness;
    return made(pbf_shape_from_mesh, desc);
  }
  /* `count` has the numbers along x and, in 3D, z. */
  static result<shape> from_heights(span<const std::uint32_t> count, span<const double> heights,
                                    double spacing, double base, double cell) noexcept {
    pbf_heights_desc desc = detail::sized<pbf_heights_desc>();
    if (count.size() != 1 && count.size() != 2)
      return detail::wrong_size("count", count.size(), "there must be 1 or, in 3D, 2");
    double product = 1;
    for (std::size_t k = 0; k < count.size(); ++k) product *= desc.count[k] = count[k];
    if (product != static_cast<double>(heights.size()))
      return detail::wrong_size("heights", heights.size(), "it must have as many as count says");
    desc.dimension = static_cast<std::uint32_t>(count.size()) + 1;
    desc.heights = heights.data();
    desc.spacing = spacing;
    desc.base = base;
    desc.cell = cell;
    return made(pbf_shape_from_heights, desc);
  }
  static result<shape> from_points(std::uint32_t dimension, span<const double> points,
                                   double cell) noexcept {
    pbf_hull_desc desc = detail::sized<pbf_hull_desc>();
    if (!rows(points.size(), dimension, &desc.point_count))
      return detail::wrong_size("points", points.size(), "it must have dimension a point");
    desc.dimension = dimension;
    desc.points = points.data();
    desc.cell = cell;
    return made(pbf_shape_from_points, desc);
  }
  shape(const shape &other) noexcept : handle_(other.handle_) {
    if (handle_) pbf_hold_shape(handle_);
  }
  shape(shape &&other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  shape &operator=(shape other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~shape() { pbf_release_shape(handle_); }

  pbf_shape *handle() const noexcept { return handle_; }
  result<pbf_shape_info> info() const noexcept {
    pbf_shape_info got = detail::sized<pbf_shape_info>();
    const pbf_status status = pbf_get_shape_info(handle_, &got);
    return detail::checked(status, got);
  }
  /* Of a point in the shape's own space; `normal`, where it is given, gets the direction in which
   * it grows. In 2D the third number is not looked at. */
  result<double> distance(const double (&point)[3], double (*normal)[3] = nullptr) const noexcept {
    double found = 0, towards[3] = {0, 0, 0};
    const pbf_status status = pbf_get_shape_distance(handle_, point, &found, towards);
    if (status == PBF_OK && normal) std::memcpy(*normal, towards, sizeof towards);
    return detail::checked(status, found);
  }

  /* The distances at its nodes, as from_grid takes them: one for each. */
  result<void> values(span<float> out) const noexcept {
    return detail::checked(pbf_get_shape_values(handle_, out.size(), out.data()));
  }
  /* As bytes, for a file. */
  result<std::vector<unsigned char>> save() const {
    std::uint64_t size = 0;
    pbf_status status = pbf_save_shape(handle_, nullptr, &size);
    if (status != PBF_OK) return error(status);
    std::vector<unsigned char> saved(size);
    status = pbf_save_shape(handle_, saved.data(), &size);
    if (status != PBF_OK) return error(status);
    return saved;
  }
  /* Of what save or pbf-bake wrote. */
  static result<shape> load(span<const unsigned char> saved) noexcept {
    pbf_shape *handle = nullptr;
    const pbf_status status = pbf_load_shape(saved.data(), saved.size(), &handle);
    return detail::checked(status, shape(handle));
  }

 private:
  explicit shape(pbf_shape *handle) noexcept : handle_(handle) {}
  static bool rows(std::size_t numbers, std::uint32_t dimension, std::uint32_t *count) noexcept {
    if (dimension != 2 && dimension != 3) return true; /* the library refuses it */
    *count = static_cast<std::uint32_t>(numbers / dimension);
    return numbers % dimension == 0 && numbers / dimension <= UINT32_MAX;
  }
  template <class Desc>
  static result<shape> made(pbf_status (*make)(const Desc *, pbf_shape **),
                            const Desc &desc) noexcept {
    pbf_shape *handle = nullptr;
    const pbf_status status = make(&desc, &handle);
    return detail::checked(status, shape(handle));
  }
  pbf_shape *handle_;
};

/* pbf_collider at rest at the origin, sizes 1. */
struct collider : pbf_collider {
  explicit collider(std::uint32_t of_shape) noexcept : pbf_collider(detail::sized<pbf_collider>()) {
    pbf_collider_init(this, sizeof(pbf_collider), of_shape);
  }
  collider(const pbf_collider &from) noexcept : pbf_collider(from) {}

  static collider sphere(double x, double y, double z, double r) noexcept {
    collider made(PBF_COLLIDER_SPHERE);
    made.place(x, y, z).radius = r;
    return made;
  }
  /* Around a segment of that direction, half_length to each side of its middle. */
  static collider capsule(double x, double y, double z, double axis_x, double axis_y, double axis_z,
                          double half_length, double r) noexcept {
    collider made(PBF_COLLIDER_CAPSULE);
    made.axis[0] = axis_x, made.axis[1] = axis_y, made.axis[2] = axis_z;
    made.half_length = half_length, made.radius = r;
    return made.place(x, y, z);
  }
  static collider box(double x, double y, double z, double half_x, double half_y,
                      double half_z) noexcept {
    collider made(PBF_COLLIDER_BOX);
    made.place(x, y, z);
    made.half_extents[0] = half_x, made.half_extents[1] = half_y, made.half_extents[2] = half_z;
    return made;
  }
  /* As large as the shape is, which has to live until a solver has the collider; from then on that
   * keeps it. */
  static collider solid(const pbf::shape &of, double x, double y, double z) noexcept {
    collider made(PBF_COLLIDER_SHAPE);
    made.geometry = of.handle();
    return made.place(x, y, z);
  }
  static collider solid(pbf::shape &&of, double x, double y, double z) = delete;
  /* Through a point, fluid on the side of the normal. */
  static collider plane(double x, double y, double z, double normal_x, double normal_y,
                        double normal_z) noexcept {
    collider made(PBF_COLLIDER_PLANE);
    made.place(x, y, z);
    made.axis[0] = normal_x, made.axis[1] = normal_y, made.axis[2] = normal_z;
    return made;
  }

  collider &place(double x, double y, double z) noexcept {
    position[0] = x, position[1] = y, position[2] = z;
    return *this;
  }
};
static_assert(sizeof(collider) == sizeof(pbf_collider), "an array of one is an array of the other");

namespace detail {

/* What the log calls, and what it threw. */
struct log_state {
  log_function call;
  std::mutex lock;
  std::exception_ptr thrown;
};

struct log_target {
  std::shared_ptr<log_state> state;

  /* What is called may destroy the solver, and with it the target. */
  static void write(void *user, std::int32_t level, const char *sentence) noexcept {
    const std::shared_ptr<log_state> self = static_cast<log_target *>(user)->state;
#if PBF_HAS_EXCEPTIONS
    try {
      self->call(level, sentence);
    } catch (...) {
      const std::lock_guard<std::mutex> hold(self->lock);
      if (!self->thrown) self->thrown = std::current_exception();
    }
#else
    self->call(level, sentence);
#endif
  }
};

inline void *allocate(void *user, std::uint64_t size, std::uint64_t alignment) noexcept {
  return static_cast<allocator *>(user)->allocate(size, alignment);
}
inline void release(void *user, void *memory, std::uint64_t size,
                    std::uint64_t alignment) noexcept {
  static_cast<allocator *>(user)->release(memory, size, alignment);
}
inline void *enqueue(void *user, pbf_task_fn run, void *task, std::uint32_t items,
                     std::uint32_t min_range) noexcept {
  return static_cast<task_system *>(user)->enqueue(run, task, items, min_range);
}
inline void finish(void *user, void *handle) noexcept {
  static_cast<task_system *>(user)->finish(handle);
}

/* A pbf_desc as the library takes it, for the time of a call. */
struct c_desc : pbf_desc {
  c_desc(const pbf::desc &wanted, log_target &target)
      : pbf_desc(wanted), memory(sized<pbf_allocator>()) {
    struct_size = sizeof(pbf_desc);
    if (wanted.memory) {
      memory.user = wanted.memory;
      memory.allocate = detail::allocate;
      memory.release = detail::release;
      allocator = &memory;
    }
    if (wanted.tasks) {
      enqueue_task = detail::enqueue;
      finish_task = detail::finish;
      task_user = wanted.tasks;
    }
    if (wanted.log_to) {
      target.state = std::make_shared<log_state>();
      target.state->call = wanted.log_to;
      log = log_target::write;
      log_user = &target;
    }
  }
  c_desc(const c_desc &) = delete;
  c_desc &operator=(const c_desc &) = delete;

 private:
  pbf_allocator memory;
};

/* Shared: `owners`, and `handle`, of C, which its destructor destroys. */
template <class Shared>
class owner_of {
 public:
  owner_of() noexcept = default;
  explicit owner_of(Shared *made) noexcept : shared_(made) {}
  owner_of(const owner_of &other) noexcept : shared_(other.shared_) {
    if (shared_) shared_->owners.fetch_add(1, std::memory_order_relaxed);
  }
  owner_of(owner_of &&other) noexcept : shared_(std::exchange(other.shared_, nullptr)) {}
  owner_of &operator=(owner_of other) noexcept {
    std::swap(shared_, other.shared_);
    return *this;
  }
  ~owner_of() {
    if (shared_ && shared_->owners.fetch_sub(1, std::memory_order_acq_rel) == 1) delete shared_;
  }

  Shared *operator->() const noexcept { return shared_; }
  explicit operator bool() const noexcept { return shared_ != nullptr; }
  auto handle() const noexcept { return shared_ ? shared_->handle : nullptr; }
  bool alone() const noexcept { return shared_->owners.load(std::memory_order_acquire) == 1; }

 private:
  Shared *shared_ = nullptr;
};

/* The batch of C, for all that need it. */
struct shared_batch {
  std::atomic<unsigned> owners{1};
  pbf_batch *handle = nullptr;
  std::uint32_t worlds = 0;
  std::uint32_t dimension = 0;
  std::uint32_t precision = 0;
  log_target log;

  shared_batch() = default;
  shared_batch(const shared_batch &) = delete;
  shared_batch &operator=(const shared_batch &) = delete;
  ~shared_batch() { pbf_batch_destroy(handle); }
};

/* The solver of C, for all that need it. */
struct shared_solver {
  owner_of<shared_batch> batch; /* that it is a world of, and ends with */
  std::atomic<unsigned> owners{1};
  pbf_solver *handle = nullptr;
  std::uint32_t dimension = 0;
  std::uint32_t precision = 0;
  log_target log;

  shared_solver() = default;
  shared_solver(const shared_solver &) = delete;
  shared_solver &operator=(const shared_solver &) = delete;
  ~shared_solver() { pbf_destroy(handle); } /* of a world nothing */
};

using owner = owner_of<shared_solver>;

inline std::exception_ptr taken(log_target &log) noexcept {
  if (!log.state) return nullptr;
  const std::lock_guard<std::mutex> hold(log.state->lock);
  return std::exchange(log.state->thrown, nullptr);
}

}  // namespace detail

/* ---- What a solver gives away -------------------------------------------------------------- */

/* A mapped field; unmapped when it goes. Calls that change the particles are refused until then. */
class view {
 public:
  view(view &&other) noexcept
      : owner_(std::move(other.owner_)),
        raw_(std::exchange(other.raw_, detail::sized<pbf_view>())) {}
  view &operator=(view other) noexcept {
    std::swap(owner_, other.owner_);
    std::swap(raw_, other.raw_);
    return *this;
  }
  ~view() {
    if (owner_) pbf_unmap(owner_.handle(), raw_.field);
  }

  const pbf_view &raw() const noexcept { return raw_; }
  std::size_t size() const noexcept { return raw_.count; }
  std::uint32_t components() const noexcept { return raw_.components; }
  bool on_host() const noexcept { return raw_.device_type == PBF_DEVICE_CPU; }
  /* Component c of the element in place i, which is particle ids()[i]; in host memory only. */
  template <class T>
  const T &at(std::size_t i, std::size_t c = 0) const noexcept {
    assert(on_host() && i < raw_.count && c < raw_.components);
    return *reinterpret_cast<const T *>(static_cast<const char *>(raw_.data) +
                                        static_cast<std::int64_t>(i) * raw_.particle_stride +
                                        static_cast<std::int64_t>(c) * raw_.component_stride);
  }
  span<const std::uint32_t> ids() const noexcept { return {raw_.ids, raw_.count}; }

 private:
  friend class solver;
  view(detail::owner owner, const pbf_view &raw) noexcept : owner_(std::move(owner)), raw_(raw) {}
  detail::owner owner_;
  pbf_view raw_;
};

/* The state after a step, which does not change while it is held; outlives the solver. */
class snapshot {
 public:
  snapshot(snapshot &&other) noexcept
      : raw_(std::exchange(other.raw_, detail::sized<pbf_snapshot>())) {}
  snapshot &operator=(snapshot &&other) noexcept {
    std::swap(raw_, other.raw_);
    return *this;
  }
  ~snapshot() {
    if (raw_.owner) pbf_release_snapshot(&raw_);
  }

  const pbf_snapshot &raw() const noexcept { return raw_; }
  std::uint32_t size() const noexcept { return raw_.count; }
  std::uint64_t step() const noexcept { return raw_.step; }
  double time() const noexcept { return raw_.time; }
  /* Empty where the solver has the other precision. */
  template <class T>
  span<const T> positions() const noexcept {
    return rows<T>(raw_.positions);
  }
  template <class T>
  span<const T> velocities() const noexcept {
    return rows<T>(raw_.velocities);
  }
  span<const std::uint32_t> ids() const noexcept { return {raw_.ids, raw_.count}; }

 private:
  friend class solver;
  friend class reader;
  explicit snapshot(const pbf_snapshot &raw) noexcept : raw_(raw) {}
  static result<snapshot> of(pbf_solver *solver) noexcept {
    pbf_snapshot raw = detail::sized<pbf_snapshot>();
    const pbf_status status = pbf_acquire_snapshot(solver, &raw);
    if (status != PBF_OK) return error(status);
    return snapshot(raw);
  }
  template <class T>
  span<const T> rows(const void *data) const noexcept {
    static_assert(std::is_same_v<T, float> || std::is_same_v<T, double>, "float or double");
    if (raw_.element_type != sizeof(T)) return {};
    return {static_cast<const T *>(data), std::size_t{raw_.count} * raw_.dimension};
  }
  pbf_snapshot raw_;
};

/* What other threads may do while one is inside the solver. Copies may be in any thread. */
class reader {
 public:
  result<void> cancel() const noexcept { return detail::checked(pbf_cancel(owner_.handle())); }
  result<snapshot> acquire_snapshot() const noexcept { return snapshot::of(owner_.handle()); }

 private:
  friend class solver;
  explicit reader(detail::owner owner) noexcept : owner_(std::move(owner)) {}
  detail::owner owner_;
};

/* ---- The solver ---------------------------------------------------------------------------- */

class solver {
 public:
  static result<solver> create(const desc &wanted = desc(), const params &start = params());

  solver(solver &&) noexcept = default;
  solver &operator=(solver other) noexcept {
    std::swap(owner_, other.owner_);
    return *this;
  }
  ~solver() {
    // Steps that have begun end with the solver, which a world of a batch outlives.
    if (owner_ && (!owner_.alone() || owner_->batch)) {
      pbf_cancel(handle());
      pbf_end_step(handle());
    }
  }

  /* For calls of pbf.h that are not here. Not to be destroyed. */
  pbf_solver *handle() const noexcept { return owner_.handle(); }
  std::uint32_t dimension() const noexcept { return owner_ ? owner_->dimension : 0; }
  pbf::reader reader() const noexcept { return pbf::reader(owner_); }

  /* The first exception that the log threw since this was last asked; null: none. */
  std::exception_ptr take_log_exception() noexcept {
    if (!owner_) return nullptr;
    return detail::taken(owner_->batch ? owner_->batch->log : owner_->log);
  }

  result<void> step(std::uint32_t steps = 1) noexcept {
    return detail::checked(pbf_step(handle(), steps));
  }
  result<void> begin_step(std::uint32_t steps = 1) noexcept {
    return detail::checked(pbf_begin_step(handle(), steps));
  }
  result<void> end_step() noexcept { return detail::checked(pbf_end_step(handle())); }
  result<void> synchronize() noexcept { return detail::checked(pbf_synchronize(handle())); }

  result<void> set_params(const pbf::params &wanted) noexcept {
    pbf_params sized = wanted;
    sized.struct_size = sizeof sized;
    return detail::checked(pbf_set_params(handle(), &sized));
  }
  result<pbf::params> get_params() noexcept {
    return filled<pbf_params, pbf::params>(pbf_get_params);
  }

  /* Coordinates one after the other, `dimension` of them a particle; gives the first new id.
   * Without velocities the particles are at rest. */
  result<std::uint32_t> add_particles(span<const float> positions,
                                      span<const float> velocities = {}) noexcept {
    return add(positions, velocities);
  }
  result<std::uint32_t> add_particles(span<const double> positions,
                                      span<const double> velocities = {}) noexcept {
    return add(positions, velocities);
  }
  result<void> remove_particles(span<const std::uint32_t> ids) noexcept {
    if (ids.size() > UINT32_MAX) return too_many();
    return detail::checked(
        pbf_remove_particles(handle(), static_cast<std::uint32_t>(ids.size()), ids.data()));
  }
  /* Gives how many they were. */
  result<std::uint32_t> remove_in_box(const double (&lower)[3], const double (&upper)[3]) noexcept {
    std::uint32_t count = 0;
    const pbf_status status = pbf_remove_in_box(handle(), lower, upper, &count);
    return detail::checked(status, count);
  }
  /* Gives how many there are, be it more than `ids` has room for. */
  result<std::uint32_t> find_in_box(const double (&lower)[3], const double (&upper)[3],
                                    span<std::uint32_t> ids) noexcept {
    std::uint32_t count = 0;
    const std::size_t room = ids.size() > UINT32_MAX ? UINT32_MAX : ids.size();
    const pbf_status status = pbf_find_in_box(handle(), lower, upper,
                                              static_cast<std::uint32_t>(room), ids.data(), &count);
    return detail::checked(status, count);
  }

  result<std::uint32_t> count() noexcept { return number<std::uint32_t>(pbf_get_count); }

  /* Into `out`, as many particles as it has room for, from row `first` on. */
  result<void> get_positions(span<float> out, std::uint32_t first = 0) noexcept {
    return rows(pbf_get_positions, "positions", out, first, dimension());
  }
  result<void> get_positions(span<double> out, std::uint32_t first = 0) noexcept {
    return rows(pbf_get_positions, "positions", out, first, dimension());
  }
  result<void> get_velocities(span<float> out, std::uint32_t first = 0) noexcept {
    return rows(pbf_get_velocities, "velocities", out, first, dimension());
  }
  result<void> get_velocities(span<double> out, std::uint32_t first = 0) noexcept {
    return rows(pbf_get_velocities, "velocities", out, first, dimension());
  }
  result<void> get_densities(span<float> out, std::uint32_t first = 0) noexcept {
    return rows(pbf_get_densities, "densities", out, first, 1);
  }
  result<void> get_densities(span<double> out, std::uint32_t first = 0) noexcept {
    return rows(pbf_get_densities, "densities", out, first, 1);
  }
  result<void> get_pressures(span<float> out, std::uint32_t first = 0) noexcept {
    return rows(pbf_get_pressures, "pressures", out, first, 1);
  }
  result<void> get_pressures(span<double> out, std::uint32_t first = 0) noexcept {
    return rows(pbf_get_pressures, "pressures", out, first, 1);
  }
  result<void> get_ids(span<std::uint32_t> out, std::uint32_t first = 0) noexcept {
    if (out.size() > UINT32_MAX) return too_many();
    return detail::checked(
        pbf_get_ids(handle(), first, static_cast<std::uint32_t>(out.size()), out.data()));
  }
  result<void> set_positions(span<const float> from, std::uint32_t first = 0) noexcept {
    return rows(pbf_set_positions, "positions", from, first, dimension());
  }
  result<void> set_positions(span<const double> from, std::uint32_t first = 0) noexcept {
    return rows(pbf_set_positions, "positions", from, first, dimension());
  }
  result<void> set_velocities(span<const float> from, std::uint32_t first = 0) noexcept {
    return rows(pbf_set_velocities, "velocities", from, first, dimension());
  }
  result<void> set_velocities(span<const double> from, std::uint32_t first = 0) noexcept {
    return rows(pbf_set_velocities, "velocities", from, first, dimension());
  }
  result<void> set_accelerations(span<const float> from, std::uint32_t first = 0) noexcept {
    return rows(pbf_set_accelerations, "accelerations", from, first, dimension());
  }
  result<void> set_accelerations(span<const double> from, std::uint32_t first = 0) noexcept {
    return rows(pbf_set_accelerations, "accelerations", from, first, dimension());
  }
  result<void> clear_accelerations() noexcept {
    return detail::checked(pbf_set_accelerations(handle(), 0, 0, nullptr));
  }
  /* All of them, in a new array. */
  template <class T>
  result<std::vector<T>> positions() {
    return all<T>(&solver::get_positions, dimension());
  }
  template <class T>
  result<std::vector<T>> velocities() {
    return all<T>(&solver::get_velocities, dimension());
  }

  /* struct_size is set here. */
  result<void> read(pbf_read_desc wanted) noexcept {
    wanted.struct_size = sizeof wanted;
    return detail::checked(pbf_read(handle(), &wanted));
  }
  result<void> write(pbf_write_desc given) noexcept {
    given.struct_size = sizeof given;
    return detail::checked(pbf_write(handle(), &given));
  }
  result<void> anisotropies(pbf_anisotropy_desc wanted) noexcept {
    wanted.struct_size = sizeof wanted;
    return detail::checked(pbf_get_anisotropies(handle(), &wanted));
  }

  /* Questions by place, see query.h. Gives how many there are, be it more than `ids` holds.
   */
  result<std::uint32_t> find_in(const volume &where, span<std::uint32_t> ids) noexcept {
    std::uint32_t count = 0;
    const pbf_status status =
        pbf_find_in_volume(handle(), &where, detail::clamped(ids.size()), ids.data(), &count);
    return detail::checked(status, count);
  }
  result<pbf_volume_flow> measure(const volume &where) noexcept {
    pbf_volume_flow flow = detail::sized<pbf_volume_flow>();
    const pbf_status status = pbf_measure_volumes(handle(), 1, &where, &flow);
    return detail::checked(status, flow);
  }
  /* As many as there are volumes. */
  result<void> measure(span<const volume> volumes, span<pbf_volume_flow> flows) noexcept {
    if (flows.size() != volumes.size())
      return detail::wrong_size("flows", flows.size(), "it must have as many as volumes");
    for (pbf_volume_flow &flow : flows) flow = detail::sized<pbf_volume_flow>();
    return detail::checked(pbf_measure_volumes(handle(), detail::clamped(volumes.size()),
                                               volumes.data(), flows.data()));
  }
  result<void> sample(span<const double> points, const samples &into) noexcept {
    if (!owner_) return moved_from();
    if (points.size() % dimension() != 0) return odd_size("points", points.size(), dimension());
    auto wanted = sampled(static_cast<double>(points.size() / dimension()), into);
    if (!wanted) return wanted.failure();
    wanted->points = points.data();
    return detail::checked(pbf_sample(handle(), &*wanted));
  }
  /* struct_size is set here. */
  result<void> sample_on_grid(pbf_sample_grid grid, const samples &into) noexcept {
    if (!owner_) return moved_from();
    grid.struct_size = sizeof grid;
    double count = 1;
    for (std::uint32_t k = 0; k < dimension(); ++k) count *= grid.counts[k];
    const auto wanted = sampled(count, into);
    if (!wanted) return wanted.failure();
    return detail::checked(pbf_sample_on_grid(handle(), &grid, &*wanted));
  }
  /* As many rays as `distances` has numbers. `normals` may be empty. */
  result<void> cast_rays(span<const double> origins, span<const double> directions, double length,
                         span<double> distances, span<double> normals = {}) noexcept {
    const std::size_t numbers = distances.size() * dimension();
    if (origins.size() != numbers || directions.size() != numbers ||
        (!normals.empty() && normals.size() != numbers))
      return odd_arrays();
    return detail::checked(pbf_cast_rays(handle(), detail::clamped(distances.size()),
                                         origins.data(), directions.data(), length,
                                         distances.data(), normals.data()));
  }
  result<void> get_levels(span<const double> points, span<double> levels) noexcept {
    if (points.size() != levels.size() * dimension()) return odd_arrays();
    return detail::checked(
        pbf_get_levels(handle(), detail::clamped(levels.size()), points.data(), levels.data()));
  }
  /* What comes and goes in steps, see emit.h. */
  result<void> set_emitters(span<const emitter> emitters) noexcept {
    return detail::checked(
        pbf_set_emitters(handle(), detail::clamped(emitters.size()), emitters.data()));
  }
  result<void> set_drains(span<const volume> drains) noexcept {
    return detail::checked(pbf_set_drains(handle(), detail::clamped(drains.size()), drains.data()));
  }
  result<emitter> get_emitter(std::uint32_t index) noexcept {
    return numbered<emitter>(pbf_get_emitter, index);
  }
  result<volume> get_drain(std::uint32_t index) noexcept {
    return numbered<volume>(pbf_get_drain, index);
  }
  /* Open boundaries of given level or pressure. */
  result<void> set_reservoirs(span<const reservoir> reservoirs) noexcept {
    return detail::checked(
        pbf_set_reservoirs(handle(), detail::clamped(reservoirs.size()), reservoirs.data()));
  }
  result<std::uint32_t> reservoir_count() noexcept {
    return number<std::uint32_t>(pbf_get_reservoir_count);
  }
  result<reservoir> get_reservoir(std::uint32_t index) noexcept {
    return numbered<reservoir>(pbf_get_reservoir, index);
  }
  /* It has the numbers of emitters and drains, too. */
  result<pbf_in_out> in_out() noexcept { return filled(pbf_get_in_out); }

  /* Several fluids, see phases.h. */
  result<void> set_phases(span<const phase> phases) noexcept {
    return detail::checked(pbf_set_phases(handle(), detail::clamped(phases.size()), phases.data()));
  }
  result<std::uint32_t> phase_count() noexcept {
    return number<std::uint32_t>(pbf_get_phase_count);
  }
  result<phase> get_phase(std::uint32_t index) noexcept {
    return numbered<phase>(pbf_get_phase, index);
  }
  result<void> set_particle_phases(span<const std::uint32_t> phases,
                                   std::uint32_t first = 0) noexcept {
    if (phases.size() > UINT32_MAX) return too_many();
    return detail::checked(pbf_set_particle_phases(
        handle(), first, static_cast<std::uint32_t>(phases.size()), phases.data()));
  }
  result<void> get_particle_phases(span<std::uint32_t> out, std::uint32_t first = 0) noexcept {
    if (out.size() > UINT32_MAX) return too_many();
    return detail::checked(pbf_get_particle_phases(
        handle(), first, static_cast<std::uint32_t>(out.size()), out.data()));
  }

  /* Spray, foam and bubbles, see diffuse.h. */
  result<pbf_diffuse_desc> default_diffuse() noexcept {
    pbf_diffuse_desc wanted = detail::sized<pbf_diffuse_desc>();
    const pbf_status status = pbf_diffuse_init(handle(), &wanted, sizeof wanted);
    return detail::checked(status, wanted);
  }
  /* struct_size is set here. */
  result<void> set_diffuse(pbf_diffuse_desc wanted) noexcept {
    wanted.struct_size = sizeof wanted;
    return detail::checked(pbf_set_diffuse(handle(), &wanted));
  }
  result<void> end_diffuse() noexcept {
    return detail::checked(pbf_set_diffuse(handle(), nullptr));
  }
  result<pbf_diffuse_desc> get_diffuse() noexcept {
    return filled<pbf_diffuse_desc>(pbf_get_diffuse);
  }
  result<pbf_diffuse_info> diffuse_info() noexcept {
    return filled<pbf_diffuse_info>(pbf_get_diffuse_info);
  }
  /* struct_size is set here. */
  result<void> read_diffuse(pbf_diffuse_read wanted) noexcept {
    wanted.struct_size = sizeof wanted;
    return detail::checked(pbf_read_diffuse(handle(), &wanted));
  }
  /* As many as `lives` has numbers. `velocities` may be empty. */
  result<void> add_diffuse(span<const float> positions, span<const float> velocities,
                           span<const float> lives) noexcept {
    return add_diffuse_of(positions, velocities, lives);
  }
  result<void> add_diffuse(span<const double> positions, span<const double> velocities,
                           span<const double> lives) noexcept {
    return add_diffuse_of(positions, velocities, lives);
  }
  result<void> shift_diffuse(span<const double> way) noexcept {
    if (way.size() != dimension()) return odd_arrays();
    return detail::checked(pbf_shift_diffuse(handle(), way.data()));
  }
  result<void> end_queries() noexcept { return detail::checked(pbf_end_queries(handle())); }
  result<void> keep_previous(bool enabled) noexcept {
    return detail::checked(pbf_keep_previous(handle(), enabled));
  }

  result<void> set_colliders(span<const collider> colliders) noexcept {
    return detail::checked(
        pbf_set_colliders(handle(), detail::clamped(colliders.size()), colliders.data()));
  }
  result<void> move_colliders(span<const collider> targets, double duration) noexcept {
    return detail::checked(
        pbf_move_colliders(handle(), detail::clamped(targets.size()), targets.data(), duration));
  }
  result<std::uint32_t> collider_count() noexcept {
    return number<std::uint32_t>(pbf_get_collider_count);
  }
  result<collider> get_collider(std::uint32_t index) noexcept {
    return numbered<collider>(pbf_get_collider, index);
  }
  /* As many as there are colliders, or walls: 2 * dimension. */
  result<void> get_collider_loads(span<pbf_collider_load> loads) noexcept {
    for (pbf_collider_load &load : loads) load = detail::sized<pbf_collider_load>();
    return detail::checked(
        pbf_get_collider_loads(handle(), detail::clamped(loads.size()), loads.data()));
  }
  result<void> get_wall_loads(span<pbf_collider_load> loads) noexcept {
    for (pbf_collider_load &load : loads) load = detail::sized<pbf_collider_load>();
    return detail::checked(
        pbf_get_wall_loads(handle(), detail::clamped(loads.size()), loads.data()));
  }

  result<view> map(std::uint32_t field) noexcept {
    pbf_view raw = detail::sized<pbf_view>();
    const pbf_status status = pbf_map(handle(), field, &raw);
    if (status != PBF_OK) return error(status);
    return view(owner_, raw);
  }
  /* Ends when its deleter is called, also after the solver. */
  result<DLManagedTensor *> export_dlpack(std::uint32_t field) noexcept {
    DLManagedTensor *tensor = nullptr;
    const pbf_status status = pbf_export_dlpack(handle(), field, &tensor);
    return detail::checked(status, tensor);
  }
  result<void> set_snapshots(std::uint32_t snapshots) noexcept {
    return detail::checked(pbf_set_snapshots(handle(), snapshots));
  }
  result<snapshot> acquire_snapshot() noexcept { return snapshot::of(handle()); }

  result<pbf_stats> stats() noexcept { return filled<pbf_stats>(pbf_get_stats); }
  result<pbf_info> info() noexcept { return filled<pbf_info>(pbf_get_info); }
  result<pbf_plan> plan() noexcept { return filled<pbf_plan>(pbf_get_plan); }
  result<pbf_timings> timings() noexcept { return filled<pbf_timings>(pbf_get_timings); }
  result<void> set_timing(bool enabled) noexcept {
    return detail::checked(pbf_set_timing(handle(), enabled));
  }
  result<double> step_limit() noexcept { return number<double>(pbf_get_step_limit); }
  result<std::uint64_t> hash() noexcept { return number<std::uint64_t>(pbf_hash); }

  result<std::vector<unsigned char>> save() {
    std::uint64_t size = 0;
    pbf_status status = pbf_save(handle(), nullptr, &size);
    if (status != PBF_OK) return error(status);
    std::vector<unsigned char> state(size);
    status = pbf_save(handle(), state.data(), &size);
    if (status != PBF_OK) return error(status);
    state.resize(size);
    return state;
  }
  result<void> load(span<const unsigned char> state) noexcept {
    return detail::checked(pbf_load(handle(), state.data(), state.size()));
  }

 private:
  friend class batch;
  explicit solver(detail::owner owner) noexcept : owner_(std::move(owner)) {}

  static error odd_arrays() noexcept {
    return error(PBF_ERROR_INVALID_ARGUMENT,
                 "arrays of points have not as many as that of answers");
  }
  static error moved_from() noexcept {
    return error(PBF_ERROR_INVALID_ARGUMENT, "the solver has been moved from");
  }
  result<pbf_samples> sampled(double points, const samples &into) const noexcept {
    pbf_samples raw = detail::sized<pbf_samples>();
    if (points > UINT32_MAX) return too_many();
    const auto fits = [points](std::size_t size, double each) {
      return size == 0 || static_cast<double>(size) == points * each;
    };
    if (!fits(into.densities.size(), 1))
      return detail::wrong_size("densities", into.densities.size(), "it must have one a point");
    if (!fits(into.velocities.size(), dimension()))
      return detail::wrong_size("velocities", into.velocities.size(),
                                "it must have dimension a point");
    if (!fits(into.pressures.size(), 1))
      return detail::wrong_size("pressures", into.pressures.size(), "it must have one a point");
    if (!fits(into.wet.size(), 1))
      return detail::wrong_size("wet", into.wet.size(), "it must have one a point");
    raw.count = static_cast<std::uint32_t>(points);
    raw.densities = place(into.densities);
    raw.velocities = place(into.velocities);
    raw.pressures = place(into.pressures);
    raw.wet = place(into.wet);
    return raw;
  }
  template <class T>
  static T *place(span<T> array) noexcept {
    return array.empty() ? nullptr : array.data();
  }

  template <class Given, class C>
  result<Given> numbered(pbf_status (*get)(pbf_solver *, std::uint32_t, C *),
                         std::uint32_t index) noexcept {
    C got = detail::sized<C>();
    const pbf_status status = get(handle(), index, &got);
    return detail::checked(status, Given(got));
  }
  static error too_many() noexcept {
    return error(PBF_ERROR_INVALID_ARGUMENT, "an array has more elements than 32 bits count");
  }

  template <class C, class Given = C>
  result<Given> filled(pbf_status (*get)(pbf_solver *, C *)) noexcept {
    C got = detail::sized<C>();
    const pbf_status status = get(handle(), &got);
    return detail::checked(status, Given(got));
  }
  template <class N>
  result<N> number(pbf_status (*get)(pbf_solver *, N *)) noexcept {
    N got{};
    const pbf_status status = get(handle(), &got);
    return detail::checked(status, got);
  }

  /* The particles of an array, if its type and size are those of this solver. */
  template <class T>
  result<std::uint32_t> particles_of(const char *name, span<T> array,
                                     std::uint32_t components) noexcept {
    if (!owner_) return std::uint32_t{0};  // the library refuses it
    if (owner_->precision != sizeof(T)) {
      return error(PBF_ERROR_INVALID_ARGUMENT,
                   sizeof(T) == sizeof(float)
                       ? "an array of float for a solver of precision PBF_FLOAT64"
                       : "an array of double for a solver of precision PBF_FLOAT32");
    }
    if (array.size() % components != 0) return odd_size(name, array.size(), components);
    if (array.size() / components > UINT32_MAX) return too_many();
    return static_cast<std::uint32_t>(array.size() / components);
  }
  static error odd_size(const char *name, std::size_t size, std::uint32_t components) noexcept {
    char sentence[128];
    std::snprintf(sentence, sizeof sentence, "%s has %zu numbers, no multiple of %u", name, size,
                  components);
    return error(PBF_ERROR_INVALID_ARGUMENT, sentence);
  }

  template <class T>
  result<std::uint32_t> add(span<const T> positions, span<const T> velocities) noexcept {
    auto counted = particles_of("positions", positions, dimension());
    if (!counted) return counted;
    if (!velocities.empty() && velocities.size() != positions.size()) {
      return error(PBF_ERROR_INVALID_ARGUMENT, "velocities has not as many numbers as positions");
    }
    std::uint32_t first = 0;
    const pbf_status status =
        pbf_add_particles(handle(), *counted, positions.data(), velocities.data(), &first);
    return detail::checked(status, first);
  }
  template <class T>
  result<void> add_diffuse_of(span<const T> positions, span<const T> velocities,
                              span<const T> lives) noexcept {
    auto counted = particles_of("lives", lives, 1);
    if (!counted) return counted.failure();
    const std::size_t numbers = lives.size() * dimension();
    if (positions.size() != numbers || (!velocities.empty() && velocities.size() != numbers))
      return odd_arrays();
    return detail::checked(pbf_add_diffuse(handle(), *counted, positions.data(),
                                           velocities.empty() ? nullptr : velocities.data(),
                                           lives.data()));
  }
  template <class Call, class T>
  result<void> rows(Call call, const char *name, span<T> array, std::uint32_t first,
                    std::uint32_t components) noexcept {
    auto counted = particles_of(name, array, components);
    if (!counted) return counted.failure();
    return detail::checked(call(handle(), first, *counted, array.data()));
  }
  template <class T>
  result<std::vector<T>> all(result<void> (solver::*get)(span<T>, std::uint32_t) noexcept,
                             std::uint32_t components) {
    auto counted = count();
    if (!counted) return counted.failure();
    std::vector<T> out(std::size_t{*counted} * components);
    auto done = (this->*get)(out, 0);
    if (!done) return done.failure();
    return out;
  }

  detail::owner owner_;
};

inline result<solver> solver::create(const desc &wanted, const params &start) {
  detail::owner owner(new (std::nothrow) detail::shared_solver);
  if (!owner) return error(PBF_ERROR_OUT_OF_MEMORY, "no memory for a solver's owner");
  const detail::c_desc desc(wanted, owner->log);
  pbf_params first = start;
  first.struct_size = sizeof first;
  owner->dimension = desc.dimension;
  owner->precision = desc.precision;
  const pbf_status status = pbf_create(&desc, &first, &owner->handle);
  if (status != PBF_OK) {
    owner->handle = nullptr;
    return error(status);
  }
  return solver(std::move(owner));
}

/* ---- Many worlds --------------------------------------------------------------------------- */

/* See batch.h. A mask has a byte a world, those that are not 0 are meant; an empty one: all. The
 * log is called from all of a batch's threads at once. */
class batch {
 public:
  using mask = span<const std::uint8_t>;

  static result<batch> create(const desc &wanted, const params &start, std::uint32_t worlds) {
    detail::owner_of<detail::shared_batch> owner(new (std::nothrow) detail::shared_batch);
    if (!owner) return error(PBF_ERROR_OUT_OF_MEMORY, "no memory for a batch's owner");
    const detail::c_desc desc(wanted, owner->log);
    pbf_params first = start;
    first.struct_size = sizeof first;
    owner->dimension = desc.dimension;
    owner->precision = desc.precision;
    owner->worlds = worlds;
    const pbf_status status = pbf_batch_create(&desc, &first, worlds, &owner->handle);
    if (status != PBF_OK) {
      owner->handle = nullptr;
      return error(status);
    }
    return batch(std::move(owner));
  }

  batch(batch &&) noexcept = default;
  batch &operator=(batch &&) noexcept = default;

  /* For calls of batch.h that are not here. Not to be destroyed. */
  pbf_batch *handle() const noexcept { return owner_.handle(); }
  std::uint32_t size() const noexcept { return owner_ ? owner_->worlds : 0; }
  std::exception_ptr take_log_exception() noexcept {
    return owner_ ? detail::taken(owner_->log) : nullptr;
  }
  result<pbf_batch_info> info() noexcept {
    pbf_batch_info got = detail::sized<pbf_batch_info>();
    const pbf_status status = pbf_batch_get_info(handle(), &got);
    return detail::checked(status, got);
  }
  /* A world as a solver, between calls of the batch, which stays for it. */
  result<solver> world(std::uint32_t index) noexcept {
    detail::owner owner(new (std::nothrow) detail::shared_solver);
    if (!owner) return error(PBF_ERROR_OUT_OF_MEMORY, "no memory for a world's owner");
    const pbf_status status = pbf_batch_get_world(handle(), index, &owner->handle);
    if (status != PBF_OK) return error(status);
    owner->batch = owner_;
    owner->dimension = owner_->dimension;
    owner->precision = owner_->precision;
    return solver(std::move(owner));
  }
  /* What became of each world in the last call that went through worlds. */
  result<std::vector<result<void>>> results() {
    std::vector<pbf_status> statuses(size());
    pbf_status status = pbf_batch_get_statuses(handle(), statuses.data());
    if (status != PBF_OK) return error(status);
    std::vector<result<void>> found(size());
    for (std::uint32_t k = 0; k < size(); ++k) {
      const char *sentence = "";
      if (statuses[k] == PBF_OK) continue;
      status = pbf_batch_get_sentence(handle(), k, &sentence);
      if (status != PBF_OK) return error(status);
      found[k] = error(statuses[k], sentence);
    }
    return found;
  }

  result<void> step(std::uint32_t steps = 1, mask worlds = {}) noexcept {
    return masked(worlds, [&](auto *bytes) { return pbf_batch_step(handle(), bytes, steps); });
  }
  /* What reset goes back to: a state of solver::save, or, without one, each one's present state. */
  result<void> set_start(span<const unsigned char> state = {}, mask worlds = {}) noexcept {
    return masked(worlds, [&](auto *bytes) {
      return pbf_batch_set_start(handle(), bytes, state.empty() ? nullptr : state.data(),
                                 state.size());
    });
  }
  result<void> reset(mask worlds = {}) noexcept {
    return masked(worlds, [&](auto *bytes) { return pbf_batch_reset(handle(), bytes); });
  }
  /* Three numbers a world. */
  result<void> set_gravity(span<const double> gravity, mask worlds = {}) noexcept {
    if (gravity.size() != std::size_t{3} * size())
      return detail::wrong_size("gravity", gravity.size(), "it must have three a world");
    return masked(worlds, [&](auto *bytes) {
      return pbf_batch_set_gravity(handle(), bytes, gravity.data());
    });
  }
  /* The same ones for all. */
  result<void> set_colliders(span<const collider> colliders, mask worlds = {}) noexcept {
    return masked(worlds, [&](auto *bytes) {
      return pbf_batch_set_colliders(handle(), bytes, detail::clamped(colliders.size()),
                                     colliders.data());
    });
  }
  /* All that each world has, three numbers each, and four of an orientation; without these they
   * keep theirs. */
  result<void> move_colliders(span<const double> positions, double duration,
                              span<const double> orientations = {}, mask worlds = {}) noexcept {
    const std::size_t count = size() ? positions.size() / 3 / size() : 0;
    if (positions.size() != 3 * count * size())
      return detail::wrong_size("positions", positions.size(), "it must have as many a world");
    if (!orientations.empty() && orientations.size() != 4 * count * size())
      return detail::wrong_size("orientations", orientations.size(),
                                "it must have four a collider");
    return masked(worlds, [&](auto *bytes) {
      return pbf_batch_move_colliders(handle(), bytes, detail::clamped(count), positions.data(),
                                      orientations.empty() ? nullptr : orientations.data(),
                                      duration);
    });
  }
  /* So many to each world; without velocities they are at rest. */
  result<void> add_particles(span<const std::uint32_t> counts, span<const float> positions,
                             span<const float> velocities = {}) noexcept {
    return add(counts, positions, velocities);
  }
  result<void> add_particles(span<const std::uint32_t> counts, span<const double> positions,
                             span<const double> velocities = {}) noexcept {
    return add(counts, positions, velocities);
  }
  /* Particles of each world. */
  result<void> get_counts(span<std::uint32_t> counts) noexcept {
    if (counts.size() != size())
      return detail::wrong_size("counts", counts.size(), "it must have one a world");
    return detail::checked(pbf_batch_get_counts(handle(), counts.data()));
  }
  /* A PBF_FIELD_… of each world, in as many rows as `out` has room for; what a world lacks is 0. */
  result<void> read(std::uint32_t field, span<float> out, mask worlds = {}) noexcept {
    return read_as(PBF_TYPE_FLOAT32, field, out, worlds);
  }
  result<void> read(std::uint32_t field, span<double> out, mask worlds = {}) noexcept {
    return read_as(PBF_TYPE_FLOAT64, field, out, worlds);
  }
  result<void> read(std::uint32_t field, span<std::uint32_t> out, mask worlds = {}) noexcept {
    return read_as(PBF_TYPE_UINT32, field, out, worlds);
  }
  /* Ends when its deleter is called, also after the batch. */
  result<DLManagedTensor *> export_dlpack(std::uint32_t field, std::uint32_t rows = 0) noexcept {
    DLManagedTensor *tensor = nullptr;
    const pbf_status status = pbf_batch_export_dlpack(handle(), field, rows, &tensor);
    return detail::checked(status, tensor);
  }

 private:
  explicit batch(detail::owner_of<detail::shared_batch> owner) noexcept
      : owner_(std::move(owner)) {}

  template <class Call>
  result<void> masked(mask worlds, Call call) noexcept {
    if (!worlds.empty() && worlds.size() != size())
      return detail::wrong_size("the mask", worlds.size(), "it must have one a world");
    return detail::checked(call(worlds.empty() ? nullptr : worlds.data()));
  }
  template <class T>
  result<void> add(span<const std::uint32_t> counts, span<const T> positions,
                   span<const T> velocities) noexcept {
    if (counts.size() != size())
      return detail::wrong_size("counts", counts.size(), "it must have one a world");
    if (owner_ && owner_->precision != sizeof(T))
      return error(PBF_ERROR_INVALID_ARGUMENT, "the arrays are not of the batch's precision");
    std::size_t numbers = 0;
    for (const std::uint32_t count : counts) numbers += std::size_t{count} * owner_->dimension;
    if (positions.size() != numbers)
      return detail::wrong_size("positions", positions.size(), "counts says another number");
    if (!velocities.empty() && velocities.size() != numbers)
      return detail::wrong_size("velocities", velocities.size(), "counts says another number");
    return detail::checked(
        pbf_batch_add_particles(handle(), counts.data(), positions.data(), velocities.data()));
  }
  template <class T>
  result<void> read_as(std::uint32_t type, std::uint32_t field, span<T> out, mask worlds) noexcept {
    const bool vector = field == PBF_FIELD_POSITION || field == PBF_FIELD_VELOCITY;
    const std::size_t width = std::size_t{size()} * (vector && owner_ ? owner_->dimension : 1);
    if (width && out.size() % width != 0)
      return detail::wrong_size("the array", out.size(), "it must have as many a world");
    pbf_read_desc wanted = detail::sized<pbf_read_desc>();
    wanted.field = field;
    wanted.element_type = type;
    wanted.count = detail::clamped(width ? out.size() / width : 0);
    wanted.data = out.data();
    return masked(worlds, [&](auto *bytes) { return pbf_batch_read(handle(), bytes, &wanted, 0); });
  }

  detail::owner_of<detail::shared_batch> owner_;
};

/* ---- Backends ------------------------------------------------------------------------------ */

/* Every backend found, judged for a solver like `wanted`, and every candidate that failed. */
inline result<std::vector<pbf_backend_info>> backends(const desc &wanted = desc()) {
  std::uint32_t count = 0;
  pbf_status status = pbf_get_backend_count(&count);
  if (status != PBF_OK) return error(status);
  std::vector<pbf_backend_info> found(count, detail::sized<pbf_backend_info>());
  for (std::uint32_t i = 0; i < count; ++i) {
    status = pbf_get_backend_info(&wanted, i, &found[i]);
    if (status != PBF_OK) return error(status);
  }
  return found;
}

inline result<void> load_backend(const char *path) noexcept {
  return detail::checked(pbf_load_backend(path));
}

}  // namespace pbf

#endif
